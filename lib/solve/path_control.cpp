#include "solve/path_control.hpp"

#include <algorithm>

namespace amontons {

namespace {

constexpr double safety = 0.8;
constexpr double smallest_factor = 0.25, largest_factor = 2.0, rejected_factor = 0.5;
constexpr double reserve_share = 0.25; // of what is left, for one increment

} // namespace

double PathControl::reserve() const { return std::max(0.0, 0.5 * tolerance_ - taken_); }

PathControl::Verdict PathControl::judge(double difference, double status, double dt) const {
  const double allowed = proportional(dt) + reserve_share * reserve();
  Verdict verdict{.accepted = difference <= allowed && status <= tolerance_, .factor = largest_factor};
  if (difference > 0.0) verdict.factor = safety * proportional(dt) / difference;
  if (status > tolerance_) verdict.factor = std::min(verdict.factor, safety * tolerance_ / status);
  verdict.factor = std::clamp(verdict.factor, smallest_factor, verdict.accepted ? largest_factor : rejected_factor);
  return verdict;
}

void PathControl::spend(double difference, double dt) { taken_ += std::max(0.0, difference - proportional(dt)); }

} // namespace amontons
