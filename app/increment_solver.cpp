#include "increment_solver.hpp"

#include "solve/solver_choice.hpp"

#include <algorithm>

namespace amontons {

namespace {

/// One loop updates the multipliers of all pairs: the strictest of their settings hold.
std::unique_ptr<UzawaLoop> make_uzawa(Scene& scene, Newton& newton) {
  if (!scene.multipliers) return nullptr;
  double tolerance = 1.0;
  int iterations = 0;
  for (const auto& pair : scene.deck.contact)
    if (const auto* uzawa = std::get_if<UzawaDeck>(&pair.enforce)) {
      tolerance = std::min(tolerance, uzawa->tolerance);
      iterations = std::max(iterations, uzawa->max_iterations);
    }
  return std::make_unique<UzawaLoop>(*scene.problem, newton, *scene.multipliers, tolerance, iterations);
}

VecHandle copy_of(Vec vec) {
  VecHandle copy;
  AMT_PETSC(VecDuplicate(vec, copy.put()));
  AMT_PETSC(VecCopy(vec, copy));
  return copy;
}

} // namespace

IncrementSolver::IncrementSolver(Scene& scene, std::function<bool()> interrupted)
    : scene_(scene), unknowns_(scene.layout->new_vector()), accepted_(scene.layout->new_vector()) {
  if (scene.bounds) {
    linear_solver_ = choose_bounded_solver(*scene.problem);
    bounded_ = std::make_unique<BoundedNewton>(*scene.problem, *scene.bounds, std::move(interrupted));
    return;
  }
  linear_solver_ = choose_newton_solver(*scene.problem);
  newton_ = std::make_unique<Newton>(*scene.problem, std::move(interrupted));
  uzawa_ = make_uzawa(scene, *newton_);
}

SolveOutcome IncrementSolver::solve(double target) {
  AMT_PETSC(VecCopy(accepted_, unknowns_));
  scene_.problem->begin_increment(target, unknowns_);
  if (bounded_) return bounded_->solve(unknowns_);
  return uzawa_ ? uzawa_->solve(unknowns_) : newton_->solve(unknowns_);
}

void IncrementSolver::commit() {
  scene_.problem->commit(unknowns_);
  resume();
}

void IncrementSolver::roll_back() {
  AMT_PETSC(VecCopy(accepted_, unknowns_));
  scene_.problem->roll_back();
}

void IncrementSolver::resume() { AMT_PETSC(VecCopy(unknowns_, accepted_)); }

SolvedState IncrementSolver::put_aside(const SolveOutcome& outcome) {
  const auto state = scene_.problem->state_at(unknowns_);
  SolvedState solved{.time = state.time,
                     .outcome = outcome,
                     .unknowns = copy_of(unknowns_),
                     .multipliers = {},
                     .forces_on_bounds = {},
                     .displacement = {state.displacement.begin(), state.displacement.end()},
                     .samples = {}};
  if (scene_.multipliers) {
    solved.multipliers = scene_.multipliers->new_vector();
    scene_.multipliers->get(solved.multipliers);
  }
  for (auto* contact : scene_.contacts) {
    if (bounded_) solved.forces_on_bounds.push_back(contact->multipliers());
    solved.samples.push_back(contact->samples(state));
  }
  return solved;
}

std::vector<SolvedState> IncrementSolver::solve_halves(double target, SolveOutcome& outcome) {
  const auto start = scene_.problem->snapshot();
  const auto before = copy_of(accepted_);
  std::vector<SolvedState> halves;
  outcome = {};
  for (const double end : {0.5 * (start.time + target), target}) {
    const auto half = solve(end);
    outcome.newton += half.newton;
    outcome.linear += half.linear;
    outcome.outer += half.outer;
    outcome.factorizations += half.factorizations;
    outcome.reason = half.reason;
    outcome.converged = half.converged;
    if (!half.converged) break;
    halves.push_back(put_aside(half));
    commit();
  }
  scene_.problem->restore(start);
  AMT_PETSC(VecCopy(before, accepted_));
  roll_back();
  return halves;
}

void IncrementSolver::revisit(const SolvedState& state) {
  AMT_PETSC(VecCopy(state.unknowns, unknowns_));
  if (scene_.multipliers) scene_.multipliers->set(state.multipliers);
  for (std::size_t i = 0; i < state.forces_on_bounds.size(); ++i)
    scene_.contacts[i]->hold_multipliers(state.forces_on_bounds[i]);
  scene_.problem->revisit(state.time, unknowns_);
}

} // namespace amontons
