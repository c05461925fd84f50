// Solving increments of a scene from its last accepted state: whole, in halves for comparison, and coming back to one
// that was solved before. Owns the solver and the unknowns.
#pragma once

#include "output/checkpoint.hpp"
#include "scene.hpp"
#include "solve/bounded_newton.hpp"
#include "solve/condensed_newton.hpp"
#include "solve/ladder.hpp"
#include "solve/other_starts.hpp"
#include "solve/uzawa.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace amontons {

/// A solved state put aside: what it takes to come back to it, and what is compared of it.
struct SolvedState {
  double time = 0.0;
  SolveOutcome outcome;
  VecHandle unknowns, multipliers;                   // multipliers: only of `uzawa` pairs
  std::vector<std::vector<double>> forces_on_bounds; // multipliers of the pairs in a problem with bounds (`vi`)
  std::vector<double> displacement;
  std::vector<ContactSamples> samples;
};

class IncrementSolver {
 public:
  /// `interrupted`: see Newton; `tell`: see Ladder::Hooks. Collective.
  IncrementSolver(Scene& scene, std::function<bool()> interrupted, std::function<void(const std::string&)> tell);

  /// Which linear solver was chosen, in words.
  const std::string& linear_solver() const { return linear_solver_; }
  Vec unknowns() const { return unknowns_; }
  Vec accepted() const { return accepted_; }

  /// From the last accepted state to equilibrium at `target`, with the remedies of lib/solve when plain iterations do
  /// not get there. A solid that is not linear and has supports that move starts where the last accepted increment
  /// points to, unless an increment has failed since. Collective.
  SolveOutcome solve(double target);
  /// The same from another start and without remedies. Not with bounds or conditions. Collective.
  SolveOutcome solve_from(const OtherStart& start, double target);
  /// What went on in the last solve that plain iterations did not get through; absent if there was none.
  const std::optional<Trouble>& trouble() const { return trouble_; }
  /// How often each of remedies() was tried and helped; empty if none ever was.
  std::vector<Ladder::Use> remedy_uses() const { return ladder_ ? ladder_->uses() : std::vector<Ladder::Use>{}; }
  /// Newton::solve_linearized at the last accepted state; false also where the pairs' formulation has no such system
  /// at hand (bounds, eliminated multipliers). Collective.
  bool solve_linearized(Vec load, double accuracy, Vec result);
  /// Accepts the unknowns, or goes back to the last accepted ones. Collective.
  void commit();
  void roll_back();
  /// Takes what a restart has put into the unknowns for the last accepted state.
  void resume();
  /// What the next increment begins from besides the state, into a checkpoint and back (after resume()). Collective.
  void save(Checkpoint& checkpoint) const;
  void restore(const Checkpoint& checkpoint);

  /// A copy of what solve() has found. Collective.
  SolvedState put_aside(const SolveOutcome& outcome);
  /// Solves the increment to `target` in two halves and comes back to the last accepted state. Two states, or those
  /// that converged before one did not; `outcome`: sums over both, with the reason of a failure. Collective.
  std::vector<SolvedState> solve_halves(double target, SolveOutcome& outcome);
  /// Puts a state in place that was solved from the last accepted one, ready to be accepted. Collective.
  void revisit(const SolvedState& state);

  /// No increment follows: gives back the memory of matrices, factors and multigrid. What was accepted stays;
  /// remedy_uses() does not. Collective.
  void end();

 private:
  void start(double target);
  SolveOutcome solve_plainly();
  std::unique_ptr<Ladder> make_ladder();
  SolveOutcome loop_on_multipliers();
  void extrapolate(double target);

  Scene& scene_;
  std::function<void(const std::string&)> tell_;
  std::string linear_solver_;
  std::unique_ptr<BoundedNewton> bounded_;     // with bounds, or
  std::unique_ptr<CondensedNewton> condensed_; // with conditions on relative motions, else newton_
  std::unique_ptr<Newton> newton_;
  std::unique_ptr<UzawaLoop> uzawa_;
  std::unique_ptr<Ladder> ladder_; // from the first trouble on
  std::optional<Trouble> trouble_;
  double target_ = 0.0; // of the increment being solved
  VecHandle unknowns_, accepted_;
  VecHandle rate_; // of the displacements in the last accepted increment; absent: not to be extrapolated
};

} // namespace amontons
