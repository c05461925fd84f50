// The course of Newton's iterations of one solve, and what it says: going round in circles, standing still, too much
// changing at once. Knows numbers only: no solver, no contact.
#pragma once

#include <cstdint>
#include <vector>

namespace amontons {

/// An iterate.
struct Iterate {
  std::uint64_t pattern = 0; // fingerprint of the branches of all points: the same number for the same branches
  double changed = 0.0;      // part of the points on another branch than at the iterate before
  double residual = 0.0;     // out-of-balance force relative to the forces in play
};

class IterationRecord {
 public:
  static constexpr std::size_t longest_cycle = 12;

  void clear() { iterates_.clear(); }
  void add(const Iterate& iterate) { iterates_.push_back(iterate); }

  /// Length of the cycle of branches and residuals that the last iterates have gone through three times, the residuals
  /// equal to a thousandth: Newton's method would go round for ever. 0 when there is none; branches that rest are none.
  int cycle() const;
  /// Has the residual stayed within a thousandth over the last eight iterates, the branches at rest?
  bool rests() const;
  /// Largest part of the points that changed their branch in one of the last iterates, as many as the longest cycle;
  /// the first iterate of a solve does not count, which starts from a guess.
  double largest_change() const;

 private:
  bool repeats(std::size_t length, std::size_t rounds) const;

  std::vector<Iterate> iterates_;
};

} // namespace amontons
