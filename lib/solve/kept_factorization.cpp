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

#include "base/timer.hpp"
#include "solve/factor_memory.hpp"

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
/// The last solve goes this far below the tolerance of Newton's method.
constexpr double overshoot = 1e-2;
/// Iterations that are granted to every solve, and to one with a factorization of the very matrix.
constexpr int fewest = 4, most_of_fresh = 40;
constexpr int restart = 40;

} // namespace

bool KeptFactorization::is_asked_for(SNES snes) {
  KSP ksp = nullptr;
  PC pc = nullptr;
  PetscBool is_shell = PETSC_FALSE;
  AMT_PETSC(SNESGetKSP(snes, &ksp));
  AMT_PETSC(KSPGetPC(ksp, &pc));
  AMT_PETSC(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCSHELL, &is_shell));
  return is_shell;
}

KeptFactorization::KeptFactorization(const Problem& problem, SNES snes)
    : problem_(problem), snes_(snes), defect_(problem.layout().new_vector()) {
  KSP ksp = nullptr;
  PC pc = nullptr;
  AMT_PETSC(SNESGetKSP(snes, &ksp));
  AMT_PETSC(KSPGetPC(ksp, &pc));
  AMT_PETSC(PCShellSetContext(pc, this));
  AMT_PETSC(PCShellSetApply(pc, apply));
  AMT_PETSC(SNESGetJacobian(snes, &matrix_, nullptr, nullptr, nullptr));

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

void KeptFactorization::begin() {
  factorizations_ = iterations_ = 0;
  caught_ = nullptr;
}

void KeptFactorization::rethrow() const {
  if (caught_) std::rethrow_exception(caught_);
}

PetscErrorCode KeptFactorization::apply(PC shell, Vec right, Vec solution) {
  void* self = nullptr;
  PetscCall(PCShellGetContext(shell, &self));
  auto& kept = *static_cast<KeptFactorization*>(self);
  return guarded(kept.caught_, [&] {
    const bool is_solved = kept.solve(right, solution);
    AMT_PETSC(PCSetFailedReason(shell, is_solved ? PC_NOERROR : PC_SUBPC_ERROR));
  });
}

PetscErrorCode KeptFactorization::substitute(PC shell, Vec right, Vec solution) {
  void* self = nullptr;
  PetscCall(PCShellGetContext(shell, &self));
  PetscCall(MatSolve(static_cast<KeptFactorization*>(self)->factor_, right, solution));
  return 0;
}

/// Norm of the residual to solve to, for a right-hand side of norm `norm`.
double KeptFactorization::tolerance(double norm) {
  PetscReal rtol = 0.0;
  AMT_PETSC(SNESGetTolerances(snes_, nullptr, &rtol, nullptr, nullptr, nullptr));
  const double last = std::max(overshoot * rtol * problem_.force_scale(), problem_.rounding());
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
  if (reason < 0) return false;
  PetscReal norm = 0.0;
  AMT_PETSC(MatMult(matrix_, solution, defect_));
  AMT_PETSC(VecAXPY(defect_, -1.0, right));
  AMT_PETSC(VecNorm(defect_, NORM_2, &norm));
  return norm <= 2.0 * tolerance;
}

MatHandle KeptFactorization::symmetric_part() const {
  MatHandle part;
  AMT_PETSC(MatTranspose(matrix_, MAT_INITIAL_MATRIX, part.put()));
  AMT_PETSC(MatAXPY(part, 1.0, matrix_, UNKNOWN_NONZERO_PATTERN));
  AMT_PETSC(MatScale(part, 0.5));
  return part;
}

/// Factorizes the matrix as it is now; false when MUMPS cannot (a singular matrix).
bool KeptFactorization::factorize() {
  const Phase phase("factorization");
  MatHandle part;
  if (kind_ == Kind::Symmetric && !problem_.tangent_is_symmetric()) part = symmetric_part();
  const Mat source = part ? part.get() : matrix_;
  const auto type = kind_ == Kind::Symmetric ? MAT_FACTOR_CHOLESKY : MAT_FACTOR_LU;
  MatFactorInfo info;
  AMT_PETSC(MatFactorInfoInitialize(&info));
  PetscObjectState pattern = 0;
  AMT_PETSC(MatGetNonzeroState(matrix_, &pattern));
  if (!factor_ || pattern != factor_pattern_ || factorized_tangent_ == none) {
    AMT_PETSC(MatGetFactor(source, MATSOLVERMUMPS, type, factor_.put()));
    if (kind_ == Kind::Symmetric)
      AMT_PETSC(MatCholeskyFactorSymbolic(factor_, source, nullptr, &info));
    else
      AMT_PETSC(MatLUFactorSymbolic(factor_, source, nullptr, nullptr, &info));
  }
  if (kind_ == Kind::Symmetric)
    AMT_PETSC(MatCholeskyFactorNumeric(factor_, source, &info));
  else
    AMT_PETSC(MatLUFactorNumeric(factor_, source, &info));
  factor_pattern_ = pattern;
  factorized_tangent_ = tangent_;
  spent_ = 0;
  ++factorizations_;
  MatFactorError error = MAT_FACTOR_NOERROR;
  AMT_PETSC(MatFactorGetError(factor_, &error));
  PetscReal operations = 0.0;
  PetscInt entries = 0;
  AMT_PETSC(MatMumpsGetRinfog(factor_, 3, &operations));
  AMT_PETSC(MatMumpsGetInfog(factor_, 29, &entries));
  // MUMPS gives large counts as minus millions.
  price_ = operations / (operations_per_entry * (entries < 0 ? -1e6 * entries : std::max<PetscInt>(entries, 1)));
  if (error == MAT_FACTOR_NOERROR) return true;
  refuse_lack_of_memory(factor_);
  factor_.reset();
  factorized_tangent_ = none;
  return false;
}

} // namespace amontons
