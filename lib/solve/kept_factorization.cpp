// When to factorize anew. A factorization costs as much as `price` back-substitutions; an iteration of FGMRES costs
// one. Without knowing what tangents are to come, the rule that never costs more than twice the best is to iterate
// until as much has been spent as a factorization costs, and then to factorize.
//
// How far to solve. As far as Newton's method can use: ‖b − A x‖ <= η ‖b‖ with η = (‖b‖ / ‖b_old‖)^1.618 (Eisenstat and
// Walker, SIAM J. Sci. Comput. 17 (1996), choice 2), but never farther than a hundredth of its tolerance. When the
// tangent has not changed since the last solve the active set has settled: it is solved to that hundredth at once.
//
// What is factorized is symmetric, also with friction: half the memory. The unsymmetric part of the tangent of slip,
// μ t ⊗ n, is a fraction μ of the symmetric one in stick, so what is left to FGMRES is a part of order μ / 2.
#include "solve/kept_factorization.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

namespace {

/// Operations of a factorization that take the time of one factor entry in a back-substitution. MUMPS with OpenBLAS,
/// one thread, 8k, 25k and 73k unknowns in 3D and 25k in 2D: between 41 and 44.
constexpr double operations_per_entry = 42.0;
/// With 5e-2 Newton's method takes twice as many iterations, and may not end where springs are stiff; with these as
/// many as with exact solves.
constexpr double forcing_exponent = 1.618, largest_forcing = 1e-3, first_forcing = 1e-4;
/// Iterations that are granted to every solve, and to one with a factorization of the very matrix.
constexpr int fewest = 4, most_of_fresh = 40;
constexpr int restart = 40;

} // namespace

KeptFactorization::KeptFactorization(const Problem& problem, SNES snes) : TangentSolver(problem, snes) {
  PC pc = nullptr;
  AMT_PETSC(KSPCreate(problem.comm(), krylov_.put()));
  AMT_PETSC(KSPSetOptionsPrefix(krylov_, "kept_"));
  AMT_PETSC(KSPSetType(krylov_, KSPFGMRES));
  AMT_PETSC(KSPGMRESSetRestart(krylov_, restart));
  AMT_PETSC(KSPSetInitialGuessNonzero(krylov_, PETSC_TRUE));
  AMT_PETSC(KSPSetOperators(krylov_, matrix_, matrix_));
  AMT_PETSC(KSPGetPC(krylov_, &pc));
  AMT_PETSC(PCSetType(pc, PCSHELL));
  AMT_PETSC(PCShellSetContext(pc, this));
  AMT_PETSC(PCShellSetApply(pc, substitute));
  AMT_PETSC(KSPSetFromOptions(krylov_));
}

PetscErrorCode KeptFactorization::substitute(PC shell, Vec right, Vec solution) {
  void* self = nullptr;
  PetscCall(PCShellGetContext(shell, &self));
  PetscCall(MatSolve(static_cast<KeptFactorization*>(self)->factor_.get(), right, solution));
  return 0;
}

/// Norm of the residual to solve to, for a right-hand side of norm `norm`.
double KeptFactorization::tolerance(double norm) {
  const double last = smallest_residual();
  const bool is_settled = tangent_ == solved_tangent_;
  PetscInt iteration = 0;
  AMT_PETSC(SNESGetIterationNumber(snes_, &iteration));
  double forcing = first_forcing;
  if (iteration > 0) forcing = std::min(largest_forcing, std::pow(norm / last_norm_, forcing_exponent));
  last_norm_ = norm;
  return is_settled ? last : std::max(last, forcing * norm);
}

bool KeptFactorization::solve(Vec right, Vec solution) {
  PetscReal norm = 0.0;
  AMT_PETSC(VecNorm(right, NORM_2, &norm));
  const auto wanted = tolerance(norm);
  solved_tangent_ = tangent_;
  AMT_PETSC(VecSet(solution, 0.0));
  int iterations = 0;
  if (factor_ && factorized_tangent_ != tangent_) {
    const int allowed = needed_ + std::max(fewest, static_cast<int>(price_) - spent_);
    const bool is_solved = improve(right, solution, wanted, allowed, iterations);
    spent_ += std::max(0, iterations - needed_);
    if (is_solved) return true;
  }
  for (;;) {
    const bool is_new = factorized_tangent_ != tangent_;
    if (is_new && !factorize()) return false;
    const bool is_solved = improve(right, solution, wanted, most_of_fresh, iterations);
    if (is_new) needed_ = iterations;
    if (is_solved) return true;
    if (kind_ == Kind::Unsymmetric || problem_.tangent_is_symmetric()) return false;
    kind_ = Kind::Unsymmetric; // what slips is too different from its symmetric part
    factorized_tangent_ = none;
  }
}

/// FGMRES from what is in `solution`, for at most so many iterations; true when the tolerance is really met.
bool KeptFactorization::improve(Vec right, Vec solution, double tolerance, int most, int& iterations) {
  AMT_PETSC(KSPSetTolerances(krylov_, 0.0, tolerance, PETSC_DEFAULT, most));
  AMT_PETSC(KSPSolve(krylov_, right, solution));
  PetscInt count = 0;
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  AMT_PETSC(KSPGetIterationNumber(krylov_, &count));
  AMT_PETSC(KSPGetConvergedReason(krylov_, &reason));
  iterations = static_cast<int>(count);
  iterations_ += iterations;
  return reason >= 0 && measure_defect(right, solution) <= 2.0 * tolerance;
}

/// Factorizes the matrix as it is now; false when MUMPS cannot (a singular matrix).
bool KeptFactorization::factorize() {
  MatHandle part;
  if (kind_ == Kind::Symmetric && !problem_.tangent_is_symmetric()) part = symmetric_part(matrix_);
  PetscObjectState pattern = 0;
  AMT_PETSC(MatGetNonzeroState(matrix_, &pattern));
  ++factorizations_;
  spent_ = 0;
  factorized_tangent_ = none;
  if (!factor_.factorize(part ? part.get() : matrix_, pattern, kind_)) return false;
  factorized_tangent_ = tangent_;
  price_ = factor_.operations() / (operations_per_entry * factor_.entries());
  return true;
}

} // namespace amontons
