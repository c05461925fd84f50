#include "solve/iteration_record.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

namespace {

constexpr std::size_t rounds_of_a_cycle = 3, iterates_at_rest = 8;
constexpr double same_residual = 1e-3; // relative

bool is_same(const Iterate& a, const Iterate& b) {
  return a.pattern == b.pattern && std::abs(a.residual - b.residual) <= same_residual * std::abs(a.residual);
}

} // namespace

/// Are the last `rounds` x `length` iterates equal with the period `length`?
bool IterationRecord::repeats(std::size_t length, std::size_t rounds) const {
  const std::size_t count = rounds * length;
  if (count > iterates_.size()) return false;
  const std::size_t first = iterates_.size() - count;
  for (std::size_t i = first + length; i < iterates_.size(); ++i)
    if (!is_same(iterates_[i], iterates_[first + (i - first) % length])) return false;
  return true;
}

int IterationRecord::cycle() const {
  for (std::size_t length = 1; length <= longest_cycle; ++length)
    if (repeats(length, rounds_of_a_cycle)) return length == 1 ? 0 : static_cast<int>(length);
  return 0;
}

bool IterationRecord::rests() const { return repeats(1, iterates_at_rest); }

double IterationRecord::largest_change() const {
  double largest = 0.0;
  const std::size_t first = std::max<std::size_t>(2, iterates_.size() - std::min(longest_cycle, iterates_.size()));
  for (std::size_t i = first; i < iterates_.size(); ++i)
    largest = std::max(largest, iterates_[i].changed);
  return largest;
}

} // namespace amontons
