#include "solve/newton.hpp"

#include "base/timer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace amontons {

namespace {

/// Unknowns above which a displacement-only problem goes to CG with multigrid rather than to a factorization.
constexpr PetscInt multigrid_from_2d = 1'000'000;
constexpr PetscInt multigrid_from_3d = 500'000;

std::string in_words(SNESConvergedReason reason, double relative) {
  switch (reason) {
  case SNES_DIVERGED_FNORM_NAN:
    return "the residual is not a number";
  case SNES_DIVERGED_MAX_IT:
    return "Newton's method used all its iterations; the out-of-balance force is still " + std::to_string(relative) +
           " of the forces in play (-snes_max_it, smaller increments or `enforce: {uzawa: {}}` may help)";
  case SNES_DIVERGED_LINEAR_SOLVE:
    return "the linear solver failed: the tangent is singular (a body that nothing holds?) or, for an iterative "
           "solver, "
           "the tolerance was not reached (-ksp_converged_reason tells; -pc_type lu is the robust choice)";
  case SNES_DIVERGED_LINE_SEARCH:
    return "the line search found no decrease";
  case SNES_DIVERGED_DTOL:
    return "the residual grew without bound";
  case SNES_DIVERGED_FUNCTION_DOMAIN:
    return "the residual could not be evaluated";
  case SNES_DIVERGED_FUNCTION_COUNT:
    return "too many residual evaluations";
  case SNES_BREAKOUT_INNER_ITER:
    return "interrupted";
  default:
    return std::string("SNES: ") + SNESConvergedReasons[reason];
  }
}

/// The line search if it is one that backtracks, else null.
SNESLineSearch backtracking(SNES snes) {
  SNESLineSearch search = nullptr;
  PetscBool is_backtracking = PETSC_FALSE;
  AMT_PETSC(SNESGetLineSearch(snes, &search));
  AMT_PETSC(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(search), SNESLINESEARCHBT, &is_backtracking));
  return is_backtracking ? search : nullptr;
}

/// Whether multigrid by smoothed aggregation was chosen, here or by the user.
bool is_aggregation() {
  std::array<char, 64> type{};
  AMT_PETSC(PetscOptionsGetString(nullptr, nullptr, "-pc_type", type.data(), type.size(), nullptr));
  return std::string(type.data()) == PCGAMG;
}

/// Incomplete Cholesky as the smoother (under Chebyshev's iteration) instead of the diagonal: what cells that are much
/// longer than high couple strongly, it nearly solves for. A fifth of the iterations on graded meshes of contact
/// (README.md), and no dearer on even ones. In the order of the matrix: reversed Cuthill-McKee is worse on some.
void smooth_by_factors() {
  default_option("-mg_levels_pc_type", PCBJACOBI);
  default_option("-mg_levels_sub_pc_type", PCICC);
}

} // namespace

void default_option(const std::string& name, const std::string& value) {
  PetscBool present = PETSC_FALSE;
  AMT_PETSC(PetscOptionsHasName(nullptr, nullptr, name.c_str(), &present));
  if (!present) AMT_PETSC(PetscOptionsSetValue(nullptr, name.c_str(), value.c_str()));
}

std::string choose_linear_solver(const Problem& problem) {
  const auto& layout = problem.layout();
  const bool displacement_only = layout.num_extra() == 0;
  const bool symmetric = problem.tangent_is_symmetric();
  const bool is_large = layout.num_global() > (layout.dim() == 2 ? multigrid_from_2d : multigrid_from_3d);
  default_option("-snes_rtol", "1e-10");
  default_option("-snes_max_it", "50");
  // Full steps end in finitely many iterations where status is all that changes. With friction (unsymmetric) they may
  // go round in circles: backtracking stops that.
  default_option("-snes_linesearch_type", symmetric ? "basic" : "bt");
  if (displacement_only && (is_large || is_aggregation())) {
    default_option("-ksp_type", symmetric ? "cg" : "gmres");
    default_option("-ksp_rtol", "1e-8");
    default_option("-ksp_max_it", "2000");
    default_option("-pc_type", PCGAMG);
    if (symmetric && is_aggregation()) smooth_by_factors();
    return symmetric ? "conjugate gradients with smoothed-aggregation multigrid"
                     : "GMRES with smoothed-aggregation multigrid";
  }
  default_option("-ksp_type", "preonly");
  default_option("-pc_type", symmetric ? "cholesky" : "lu");
  default_option("-pc_factor_mat_solver_type", "mumps");
  default_option("-mat_mumps_icntl_7", "3");   // SCOTCH; MUMPS falls back by itself where it was built without
  default_option("-mat_mumps_icntl_14", "40"); // spare workspace for delayed pivots of the saddle point, per cent
  return symmetric ? "MUMPS, symmetric factorization" : "MUMPS, unsymmetric factorization";
}

NullSpaceHandle rigid_body_modes(const DofLayout& layout) {
  const auto& mesh = layout.mesh();
  VecHandle places = layout.new_vector();
  {
    VecArray values(places);
    for (std::int32_t node = 0; node < mesh.num_owned; ++node)
      for (int c = 0; c < mesh.dim; ++c)
        values[node * mesh.dim + c] = mesh.position(node)[c];
  }
  NullSpaceHandle modes;
  AMT_PETSC(MatNullSpaceCreateRigidBody(places, modes.put()));
  return modes;
}

SNESConvergedReason judge_residual(SNES snes, const Problem& problem, PetscInt iteration, double norm) {
  PetscReal rtol = 0.0;
  PetscInt max_iterations = 0;
  AMT_PETSC(SNESGetTolerances(snes, nullptr, &rtol, nullptr, &max_iterations, nullptr));
  if (!std::isfinite(norm)) return SNES_DIVERGED_FNORM_NAN;
  if (norm <= std::max(rtol * problem.force_scale(), problem.rounding())) return SNES_CONVERGED_FNORM_RELATIVE;
  return iteration >= max_iterations ? SNES_DIVERGED_MAX_IT : SNES_CONVERGED_ITERATING;
}

SolveOutcome outcome_of(SNES snes, const Problem& problem) {
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscInt newton = 0, linear = 0;
  double norm = 0.0;
  AMT_PETSC(SNESGetConvergedReason(snes, &reason));
  AMT_PETSC(SNESGetIterationNumber(snes, &newton));
  AMT_PETSC(SNESGetLinearSolveIterations(snes, &linear));
  AMT_PETSC(SNESGetFunctionNorm(snes, &norm));
  SolveOutcome outcome;
  outcome.converged = reason > 0 && reason != SNES_BREAKOUT_INNER_ITER;
  outcome.newton = static_cast<int>(newton);
  outcome.linear = static_cast<int>(linear);
  const double scale = problem.force_scale();
  outcome.residual = scale > 0.0 ? norm / scale : 0.0;
  outcome.reason = outcome.converged ? "converged" : in_words(reason, outcome.residual);
  return outcome;
}

Newton::Newton(Problem& problem, std::function<bool()> interrupted)
    : problem_(problem), interrupted_(std::move(interrupted)), matrix_(problem.new_matrix()),
      residual_(problem.layout().new_vector()) {
  AMT_PETSC(SNESCreate(problem.comm(), snes_.put()));
  AMT_PETSC(SNESSetFunction(snes_, residual_, evaluate_residual, this));
  AMT_PETSC(SNESSetJacobian(snes_, matrix_, matrix_, evaluate_tangent, this));
  AMT_PETSC(SNESSetConvergenceTest(snes_, test_convergence, this, nullptr));
  // When a line search gives up, PETSc (3.18) compares the last step that it noted, which may be the short last one of
  // an earlier solve, with stol |u|, and takes any residual for converged.
  AMT_PETSC(SNESSetTolerances(snes_, PETSC_DEFAULT, PETSC_DEFAULT, 0.0, PETSC_DEFAULT, PETSC_DEFAULT));
  AMT_PETSC(SNESSetFromOptions(snes_));
  if (const auto search = backtracking(snes_)) AMT_PETSC(SNESLineSearchBTGetAlpha(search, &sufficient_decrease_));
  if (problem.layout().num_extra() == 0) AMT_PETSC(MatSetNearNullSpace(matrix_, rigid_body_modes(problem.layout())));
}

/// Backtracking goes back until |F|² has fallen by alpha of what the tangent promises. A tangent that is no derivative
/// promises nothing: with a large negative alpha its full step passes.
void Newton::ask_for_decrease(bool is_asked) {
  constexpr PetscReal accept_anything = -1e30;
  if (const auto search = backtracking(snes_))
    AMT_PETSC(SNESLineSearchBTSetAlpha(search, is_asked ? sufficient_decrease_ : accept_anything));
}

PetscErrorCode Newton::evaluate_residual(SNES, Vec unknowns, Vec result, void* self) {
  auto& newton = *static_cast<Newton*>(self);
  return guarded(newton.kept_, [&] { newton.problem_.residual(unknowns, result); });
}

PetscErrorCode Newton::evaluate_tangent(SNES, Vec unknowns, Mat matrix, Mat, void* self) {
  auto& newton = *static_cast<Newton*>(self);
  return guarded(newton.kept_, [&] {
    newton.ask_for_decrease(!newton.problem_.is_first_guess());
    if (newton.problem_.tangent(unknowns, matrix)) ++newton.factorizations_;
  });
}

PetscErrorCode Newton::test_convergence(SNES snes, PetscInt iteration, PetscReal, PetscReal, PetscReal norm,
                                        SNESConvergedReason* reason, void* self) {
  auto& newton = *static_cast<Newton*>(self);
  return guarded(newton.kept_, [&] {
    *reason = judge_residual(snes, newton.problem_, iteration, norm);
    if (newton.interrupted_ && newton.interrupted_())
      *reason = SNES_BREAKOUT_INNER_ITER;
    else if (*reason > 0 && iteration < newton.least_iterations_ && norm > 1e-15 * newton.problem_.force_scale())
      *reason = SNES_CONVERGED_ITERATING;
  });
}

SolveOutcome Newton::solve(Vec unknowns) {
  factorizations_ = 0;
  kept_ = nullptr;
  const Phase phase("linear solver"); // the phases of forms inside stop this clock
  const PetscErrorCode code = SNESSolve(snes_, nullptr, unknowns);
  if (kept_) std::rethrow_exception(kept_);
  AMT_PETSC(code);
  SolveOutcome outcome = outcome_of(snes_, problem_);
  outcome.factorizations = factorizations_;
  return outcome;
}

} // namespace amontons
