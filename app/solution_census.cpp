#include "solution_census.hpp"

#include "base/log.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace amontons {

namespace {

/// Contact tractions that differ by less, relative to the largest of the run, are the same solution: solvers stop at
/// 1e-10 of the forces, the outer loop of `uzawa` at 1e-6 of the tractions.
constexpr double distinct = 1e-3;

/// Tractions tell solutions apart: where they and the loads are the same, bodies can differ by a rigid motion that
/// nothing resists, and a body that has come free is no second solution wherever it floats.
double in_tractions(const PathDifference& difference) { return std::max(difference.pressure, difference.shear); }

PathState view(const Scene& scene, const SolvedState& state) {
  return {.dim = scene.mesh.dim, .displacement = state.displacement, .samples = state.samples};
}

} // namespace

std::string SolutionCensus::look(const Scene& scene, IncrementSolver& solver, const SolveOutcome& outcome,
                                 SolveOutcome& effort) {
  const MPI_Comm comm = scene.mesh.comm;
  std::vector<SolvedState> solutions;
  solutions.push_back(solver.put_aside(outcome));
  const double time = solutions.front().time;
  PathDifference largest;
  scales_.include(path_scales(comm, view(scene, solutions.front())));
  const auto difference = [&](const SolvedState& one, const SolvedState& other) {
    return path_difference(comm, view(scene, one), view(scene, other), scales_);
  };
  for (const auto& start : other_starts()) {
    const auto found = solver.solve_from(start, time);
    effort.add_effort(found);
    if (!found.converged) continue;
    auto state = solver.put_aside(found);
    scales_.include(path_scales(comm, view(scene, state)));
    const auto from_first = difference(solutions.front(), state);
    const bool is_new = std::all_of(solutions.begin(), solutions.end(), [&](const auto& known) {
      return in_tractions(difference(known, state)) > distinct;
    });
    if (!is_new) continue;
    solutions.push_back(std::move(state));
    if (in_tractions(from_first) > in_tractions(largest)) largest = from_first;
  }
  solver.roll_back();
  solver.revisit(solutions.front());
  ++increments_;
  const int count = static_cast<int>(solutions.size());
  if (count == 1) return {};
  if (not_unique_++ == 0) first_time_ = time;
  most_ = std::max(most_, count);
  if (in_tractions(largest) > in_tractions(largest_)) largest_ = largest;
  return formatted(
      "t = %g has several solutions: %d found, which differ by up to %.2g in displacement, %.2g in pressure "
      "and %.2g in shear; the one that the last state leads to is kept",
      time, count, largest.displacement, largest.pressure, largest.shear);
}

nlohmann::ordered_json SolutionCensus::to_json() const {
  nlohmann::ordered_json json = {{"increments_looked_at", increments_},
                                 {"increments_with_several_solutions", not_unique_},
                                 {"most_solutions_found", most_}};
  if (not_unique_ > 0) {
    json["first_time"] = first_time_;
    json["largest_difference"] = {
        {"displacement", largest_.displacement}, {"pressure", largest_.pressure}, {"shear", largest_.shear}};
  }
  json["meaning"] = "solutions of the same increment from other starts (all points open; without friction), with other "
                    "contact tractions, solved to the same tolerance, since the start or restart; differences relative "
                    "to the largest of the run. "
                    "None found does not mean that there is none";
  return json;
}

} // namespace amontons
