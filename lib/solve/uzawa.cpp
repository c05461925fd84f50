#include "solve/uzawa.hpp"

#include <cmath>

namespace amontons {

namespace {

/// How far an equilibrium need be found for multipliers that are about to change. An update changes the residual by
/// about a tenth of what the one before did; more accurate equilibria cost iterations and save no update (README.md).
constexpr double inner_reduction = 1e-2;

} // namespace

UzawaLoop::UzawaLoop(Problem& problem, Newton& newton, MultiplierSet& multipliers, double tolerance, int max_iterations)
    : problem_(problem), newton_(newton), multipliers_(multipliers), tolerance_(tolerance),
      current_(multipliers.new_vector()), change_(multipliers.new_vector()), updated_(multipliers.new_vector()) {
  AMT_PETSC(SNESCreate(problem.comm(), snes_.put()));
  AMT_PETSC(SNESSetOptionsPrefix(snes_, "uzawa_"));
  AMT_PETSC(SNESSetType(snes_, SNESANDERSON));
  AMT_PETSC(SNESSetFunction(snes_, change_, evaluate, this));
  AMT_PETSC(SNESSetConvergenceTest(snes_, test_convergence, this, nullptr));
  AMT_PETSC(SNESSetTolerances(snes_, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, max_iterations, PETSC_DEFAULT));
  AMT_PETSC(SNESSetFromOptions(snes_));
}

/// The change λ − λ⁺ that one Uzawa step makes; zero at the solution.
PetscErrorCode UzawaLoop::evaluate(SNES snes, Vec multipliers, Vec change, void* self) {
  auto& loop = *static_cast<UzawaLoop*>(self);
  return guarded(loop.kept_, [&] {
    loop.multipliers_.set(multipliers);
    loop.find_equilibrium();
    if (!loop.inner_.converged) AMT_PETSC(SNESSetFunctionDomainError(snes));
    loop.multipliers_.updated(loop.problem_.state_at(loop.unknowns_), loop.updated_);
    AMT_PETSC(VecWAXPY(change, -1.0, loop.updated_, multipliers));
    AMT_PETSC(VecNorm(loop.updated_, NORM_2, &loop.norm_));
  });
}

PetscErrorCode UzawaLoop::test_convergence(SNES snes, PetscInt iteration, PetscReal, PetscReal, PetscReal norm,
                                           SNESConvergedReason* reason, void* self) {
  auto& loop = *static_cast<UzawaLoop*>(self);
  return guarded(loop.kept_, [&] {
    PetscInt max_iterations = 0;
    AMT_PETSC(SNESGetTolerances(snes, nullptr, nullptr, nullptr, &max_iterations, nullptr));
    *reason = SNES_CONVERGED_ITERATING;
    if (!std::isfinite(norm))
      *reason = SNES_DIVERGED_FNORM_NAN;
    else if (norm <= loop.tolerance_ * loop.norm_)
      *reason = SNES_CONVERGED_FNORM_RELATIVE;
    else if (iteration >= max_iterations)
      *reason = SNES_DIVERGED_MAX_IT;
  });
}

void UzawaLoop::find_equilibrium() {
  const auto outcome = newton_.solve(unknowns_);
  inner_.add_effort(outcome);
  inner_.residual = outcome.residual;
  inner_.converged = outcome.converged;
  inner_.interrupted = outcome.interrupted;
  inner_.reason = outcome.reason;
}

SolveOutcome UzawaLoop::solve(Vec unknowns) {
  unknowns_ = unknowns;
  inner_ = {};
  kept_ = nullptr;
  newton_.require_iterations(1);
  newton_.set_reduction(inner_reduction);
  multipliers_.get(current_);
  const PetscErrorCode code = SNESSolve(snes_, nullptr, current_);
  if (kept_) std::rethrow_exception(kept_);
  AMT_PETSC(code);
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscInt iterations = 0;
  AMT_PETSC(SNESGetConvergedReason(snes_, &reason));
  AMT_PETSC(SNESGetIterationNumber(snes_, &iterations));
  newton_.set_reduction(0.0);
  newton_.require_iterations(0);
  if (inner_.converged && reason > 0) find_equilibrium();
  SolveOutcome outcome = inner_;
  outcome.outer = static_cast<int>(iterations) + 1;
  outcome.converged = inner_.converged && reason > 0;
  if (inner_.converged && reason <= 0)
    outcome.reason = "the Uzawa loop did not settle the multipliers in " + std::to_string(outcome.outer) +
                     " iterations (enforce.uzawa.max_iterations; a larger alpha converges in fewer)";
  return outcome;
}

} // namespace amontons
