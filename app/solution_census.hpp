// Is the solution of an increment the only one? Solves it again from other starts and counts what comes out. To find
// none proves nothing; one that is found proves that the increment has several.
#pragma once

#include "accuracy/path_difference.hpp"
#include "increment_solver.hpp"

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace amontons {

class SolutionCensus {
 public:
  /// Solves the increment, whose solution is in the solver's unknowns with this outcome, from other starts, and comes
  /// back to the solution. Words on others that there are, empty for none; `effort` gets what that took. Collective.
  std::string look(const Scene& scene, IncrementSolver& solver, const SolveOutcome& outcome, SolveOutcome& effort);

  /// For the summary.
  nlohmann::ordered_json to_json() const;

 private:
  int increments_ = 0, not_unique_ = 0, most_ = 1;
  double first_time_ = 0.0;
  PathDifference largest_;
  PathScales scales_; // of all states that have been compared: forces of a body that is free are rounding
};

} // namespace amontons
