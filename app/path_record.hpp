// The estimate of a run's path error: what halving the increments changes, added up, and what it cost to know.
#pragma once

#include "accuracy/path_difference.hpp"
#include "output/checkpoint.hpp"

#include <nlohmann/json_fwd.hpp>

namespace amontons {

/// The solution of an increment that was kept, of the two that were compared: the halves have the error that their
/// difference to the whole shows, the whole twice that (solve/path_control.hpp).
enum class KeptSolution { Whole, Halves };

class PathRecord {
 public:
  /// The largest of all states computed so far.
  PathScales scales;

  /// Takes the difference of an accepted increment; returns the error of the kept solution.
  double add(const PathDifference& difference, KeptSolution kept);
  /// An increment that was accepted without a comparison, for a half of it did not converge.
  void add_unmeasured() { ++unmeasured_; }
  void add_rejected() { ++rejected_; }
  void add_beyond_tolerance() { ++beyond_; }
  /// Work that was done for the comparison alone.
  void add_cost(int newton_iterations, double seconds);

  nlohmann::ordered_json to_json() const;
  void save(Checkpoint& checkpoint) const;
  void restore(const Checkpoint& checkpoint);

 private:
  PathDifference sum_; // status: the largest
  int measured_ = 0, unmeasured_ = 0, rejected_ = 0, beyond_ = 0, newton_ = 0;
  double seconds_ = 0.0;
};

} // namespace amontons
