#include "solve/newton.hpp"

#include "base/timer.hpp"
#include "solve/factor_memory.hpp"
#include "solve/kept_supports.hpp"
#include "solve/tangent_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace amontons {

namespace {

/// Unknowns above which a displacement-only problem goes to CG with multigrid rather than to a factorization.
constexpr PetscInt multigrid_from_2d = 1'000'000;
constexpr PetscInt multigrid_from_3d = 500'000;
/// Unknowns up to which every rank factorizes the whole matrix by itself. MUMPS on several ranks adds what other ranks
/// send in the order of its arrival, so that runs do not repeat bit by bit; so small factorizations gain nothing from
/// more ranks.
constexpr PetscInt repeatable_up_to = 20'000;

/// Another formulation that may get there: multipliers updated one by one where they are unknowns, unknown ones
/// elsewhere.
std::string another_way(const Problem& problem) {
  if (problem.switching().empty()) return "smaller increments may help";
  return std::string("smaller increments or `enforce: ") +
         (problem.layout().num_extra() > 0 ? "{uzawa: {}}" : "{semismooth: {}}") + "` may help";
}

std::string in_words(SNESConvergedReason reason, double relative, const Problem& problem) {
  switch (reason) {
  case SNES_DIVERGED_FNORM_NAN:
    return "the residual is not a number";
  case SNES_DIVERGED_MAX_IT:
    return "Newton's method used all its iterations; the out-of-balance force is still " + std::to_string(relative) +
           " of the forces in play (" + another_way(problem) + ")";
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
  case SNES_DIVERGED_LOCAL_MIN: // given by test_convergence
    return "Newton's method repeats itself";
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

/// Length of a step along −y for which the energy is least: the root of φ'(λ) = −F(x − λ y) · y, which rises with λ
/// for a convex energy. Full steps that do not pass it are taken whole; a step that does not point downhill, too.
class EnergySearch {
 public:
  explicit EnergySearch(SNESLineSearch search) : search_(search) {
    AMT_PETSC(SNESLineSearchGetSNES(search, &snes_));
    AMT_PETSC(SNESLineSearchGetVecs(search, &start_, &force_, &step_, &next_, &next_force_));
  }
  /// Leaves the new iterate and its residual where SNES looks for them, and returns the length.
  double run() {
    PetscScalar promised = 0.0;
    PetscBool changed = PETSC_FALSE;
    AMT_PETSC(SNESLineSearchPreCheck(search_, start_, step_, &changed));
    AMT_PETSC(VecDot(force_, step_, &promised));
    double low = 0.0, high = 1.0, length = 1.0, slope = slope_at(1.0), low_slope = -promised, high_slope = slope;
    for (int i = 0; i < most_trials && promised > 0.0 && high_slope > 0.0; ++i) {
      if (std::abs(slope) <= remaining_slope * promised) break;
      // Regula falsi, by halves where it would hardly move; a slope that is not a number counts as beyond the root.
      length = low + (high - low) * std::clamp(-low_slope / (high_slope - low_slope), 0.1, 0.9);
      if (!std::isfinite(length)) length = 0.5 * (low + high);
      slope = slope_at(length);
      (slope < 0.0 ? low : high) = length;
      (slope < 0.0 ? low_slope : high_slope) = slope;
    }
    AMT_PETSC(VecCopy(next_, start_));
    AMT_PETSC(VecCopy(next_force_, force_));
    return length;
  }

 private:
  static constexpr int most_trials = 30;
  static constexpr double remaining_slope = 0.1; // of the slope at the start
  double slope_at(double length) {
    PetscScalar slope = 0.0;
    AMT_PETSC(VecWAXPY(next_, -length, step_, start_));
    AMT_PETSC(SNESComputeFunction(snes_, next_, next_force_));
    AMT_PETSC(VecDot(next_force_, step_, &slope));
    return -slope;
  }
  SNESLineSearch search_ = nullptr;
  SNES snes_ = nullptr;
  Vec start_ = nullptr, force_ = nullptr, step_ = nullptr, next_ = nullptr, next_force_ = nullptr;
};

/// Krylov methods solve to this residual, relative to the load, for the life of the scope. Eisenstat and Walker's rule
/// rests: it would set the tolerance of every solve, also of those that are none of Newton's method.
class KrylovAccuracy {
 public:
  KrylovAccuracy(SNES snes, double residual) : snes_(snes) {
    AMT_PETSC(SNESGetKSP(snes, &solver_));
    AMT_PETSC(SNESKSPGetUseEW(snes, &has_rule_));
    AMT_PETSC(SNESKSPSetUseEW(snes, PETSC_FALSE));
    AMT_PETSC(KSPGetTolerances(solver_, &relative_, &absolute_, nullptr, nullptr));
    AMT_PETSC(KSPSetTolerances(solver_, residual, 0.0, PETSC_DEFAULT, PETSC_DEFAULT));
  }
  ~KrylovAccuracy() {
    KSPSetTolerances(solver_, relative_, absolute_, PETSC_DEFAULT, PETSC_DEFAULT);
    SNESKSPSetUseEW(snes_, has_rule_);
  }
  KrylovAccuracy(const KrylovAccuracy&) = delete;
  KrylovAccuracy& operator=(const KrylovAccuracy&) = delete;

 private:
  SNES snes_ = nullptr;
  KSP solver_ = nullptr;
  PetscBool has_rule_ = PETSC_FALSE;
  PetscReal relative_ = 0.0, absolute_ = 0.0;
};

/// Whether multigrid by smoothed aggregation was chosen, here or by the user.
bool is_aggregation() {
  std::array<char, 64> type{};
  AMT_PETSC(PetscOptionsGetString(nullptr, nullptr, "-pc_type", type.data(), type.size(), nullptr));
  return std::string(type.data()) == PCGAMG;
}

/// Names of options that are defaults of ours. PETSc's options are one table a process, and so is this.
std::vector<std::string>& defaults_set() {
  static std::vector<std::string> names;
  return names;
}

/// Does the user set options of MUMPS, or choose its solver? Then it is taken as it is.
bool is_tuned() {
  char* all = nullptr;
  AMT_PETSC(PetscOptionsGetAll(nullptr, &all));
  const std::string options = all ? all : "";
  AMT_PETSC(PetscFree(all));
  return options.find("-pc_") != std::string::npos || options.find("-mat_mumps_") != std::string::npos;
}

} // namespace

void SolveOutcome::add_effort(const SolveOutcome& other) {
  newton += other.newton;
  linear += other.linear;
  outer += other.outer;
  factorizations += other.factorizations;
}

bool set_if_absent(const std::string& name, const std::string& value) {
  PetscBool present = PETSC_FALSE;
  AMT_PETSC(PetscOptionsHasName(nullptr, nullptr, name.c_str(), &present));
  if (!present) AMT_PETSC(PetscOptionsSetValue(nullptr, name.c_str(), value.c_str()));
  return !present;
}

void default_option(const std::string& name, const std::string& value) {
  if (set_if_absent(name, value)) defaults_set().push_back(name);
}

void forget_default_options() {
  for (const auto& name : defaults_set())
    AMT_PETSC(PetscOptionsClearValue(nullptr, name.c_str()));
  defaults_set().clear();
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
    if (symmetric && is_aggregation()) {
      default_option("-mg_levels_pc_type", PCBJACOBI);
      default_option("-mg_levels_sub_pc_type", PCICC);
    }
    return symmetric ? "conjugate gradients with smoothed-aggregation multigrid"
                     : "GMRES with smoothed-aggregation multigrid";
  }
  int ranks = 1;
  MPI_Comm_size(problem.comm(), &ranks);
  const bool on_each = ranks > 1 && layout.num_global() <= repeatable_up_to && !is_tuned();
  const std::string prefix = on_each ? "-redundant_" : "-";
  if (on_each) default_option("-pc_type", PCREDUNDANT);
  default_option("-ksp_type", "preonly");
  default_option(prefix + "pc_type", symmetric ? "cholesky" : "lu");
  default_option(prefix + "pc_factor_mat_solver_type", "mumps");
  // SCOTCH; MUMPS falls back by itself where it was built without. Spare workspace for delayed pivots of the saddle
  // point, per cent.
  default_option(prefix + "mat_mumps_icntl_7", "3");
  default_option(prefix + "mat_mumps_icntl_14", "40");
  return std::string("MUMPS, ") + (symmetric ? "symmetric" : "unsymmetric") + " factorization" +
         (on_each ? " on each rank" : "");
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

void end_outside_domain(SNES snes, bool exists, Vec residual) {
  if (exists) return;
  // Both: SNES looks for the reason where the norm is not finite.
  AMT_PETSC(VecSet(residual, PETSC_INFINITY));
  AMT_PETSC(SNESSetFunctionDomainError(snes));
}

double small_residual(SNES snes, const Problem& problem) {
  PetscReal rtol = 0.0;
  AMT_PETSC(SNESGetTolerances(snes, nullptr, &rtol, nullptr, nullptr, nullptr));
  return std::max(rtol * problem.force_scale(), problem.rounding());
}

SNESConvergedReason judge_residual(SNES snes, const Problem& problem, PetscInt iteration, double norm) {
  PetscInt max_iterations = 0;
  AMT_PETSC(SNESGetTolerances(snes, nullptr, nullptr, nullptr, &max_iterations, nullptr));
  if (!std::isfinite(norm)) return SNES_DIVERGED_FNORM_NAN;
  if (norm <= small_residual(snes, problem)) return SNES_CONVERGED_FNORM_RELATIVE;
  return iteration >= max_iterations ? SNES_DIVERGED_MAX_IT : SNES_CONVERGED_ITERATING;
}

void ask_for_decrease(SNES snes, PetscReal alpha) {
  if (const auto search = backtracking(snes)) AMT_PETSC(SNESLineSearchBTSetAlpha(search, alpha));
}

PetscReal decrease_asked_for(SNES snes) {
  PetscReal alpha = 0.0;
  if (const auto search = backtracking(snes)) AMT_PETSC(SNESLineSearchBTGetAlpha(search, &alpha));
  return alpha;
}

std::string chosen_line_search(SNES snes) {
  SNESLineSearch search = nullptr;
  SNESLineSearchType type = nullptr;
  AMT_PETSC(SNESGetLineSearch(snes, &search));
  AMT_PETSC(SNESLineSearchGetType(search, &type));
  return type ? type : "";
}

void choose_line_search(SNES snes, const std::string& type) {
  SNESLineSearch search = nullptr;
  AMT_PETSC(SNESGetLineSearch(snes, &search));
  AMT_PETSC(SNESLineSearchSetType(search, type.c_str()));
  AMT_PETSC(SNESLineSearchSetFromOptions(search));
}

void search_residual(SNES snes, const std::string& chosen) {
  SNESLineSearch search = nullptr;
  AMT_PETSC(SNESGetLineSearch(snes, &search));
  AMT_PETSC(SNESLineSearchSetType(search, chosen == SNESLINESEARCHBT ? SNESLINESEARCHNLEQERR : SNESLINESEARCHBT));
}

double relative_to_forces(double norm, const Problem& problem) {
  return problem.force_scale() > 0.0 ? norm / problem.force_scale() : 0.0;
}

SolveOutcome outcome_of(SNES snes, const Problem& problem) {
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscInt newton = 0, linear = 0;
  double norm = 0.0;
  AMT_PETSC(SNESGetConvergedReason(snes, &reason));
  AMT_PETSC(SNESGetIterationNumber(snes, &newton));
  AMT_PETSC(SNESGetLinearSolveIterations(snes, &linear));
  AMT_PETSC(SNESGetFunctionNorm(snes, &norm));
  if (reason == SNES_DIVERGED_LINEAR_SOLVE) refuse_lack_of_memory(snes);
  SolveOutcome outcome;
  outcome.interrupted = reason == SNES_BREAKOUT_INNER_ITER;
  outcome.converged = reason > 0 && !outcome.interrupted;
  outcome.newton = static_cast<int>(newton);
  outcome.linear = static_cast<int>(linear);
  outcome.residual = relative_to_forces(norm, problem);
  outcome.reason = outcome.converged ? "converged" : in_words(reason, outcome.residual, problem);
  if (!outcome.converged && !problem.failure().empty()) outcome.reason = problem.failure();
  return outcome;
}

Newton::~Newton() = default;

Newton::Newton(Problem& problem, std::function<bool()> interrupted)
    : problem_(problem), interrupted_(std::move(interrupted)), matrix_(problem.new_matrix()),
      residual_(problem.layout().new_vector()), course_(problem.comm(), watched(problem.switching())) {
  AMT_PETSC(SNESCreate(problem.comm(), snes_.put()));
  AMT_PETSC(SNESSetFunction(snes_, residual_, evaluate_residual, this));
  AMT_PETSC(SNESSetJacobian(snes_, matrix_, matrix_, evaluate_tangent, this));
  AMT_PETSC(SNESSetConvergenceTest(snes_, test_convergence, this, nullptr));
  // When a line search gives up, PETSc (3.18) compares the last step that it noted, which may be the short last one of
  // an earlier solve, with stol |u|, and takes any residual for converged.
  AMT_PETSC(SNESSetTolerances(snes_, PETSC_DEFAULT, PETSC_DEFAULT, 0.0, PETSC_DEFAULT, PETSC_DEFAULT));
  AMT_PETSC(SNESSetFromOptions(snes_));
  keep_supports(snes_, problem);
  sufficient_decrease_ = decrease_asked_for(snes_);
  chosen_search_ = chosen_line_search(snes_);
  if (PreconditionerLag::applies_to(snes_)) lag_.emplace();
  tangent_solver_ = new_tangent_solver(problem, snes_);
  use_light_multigrid();
  if (problem.layout().num_extra() == 0)
    AMT_PETSC(MatSetNearNullSpace(matrix_, modes_beside_supports(problem, rigid_body_modes(problem.layout()))));
}

/// After the tangent solver, which takes preconditioners of users' making for its own.
void Newton::use_light_multigrid() {
  KSP solver = nullptr;
  AMT_PETSC(SNESGetKSP(snes_, &solver));
  AMT_PETSC(KSPSetOperators(solver, matrix_, matrix_));
  if (LightMultigrid::applies_to(solver)) light_.emplace(solver);
}

void Newton::set_steps(const StepLength& steps) {
  SNESLineSearch search = nullptr;
  AMT_PETSC(SNESGetLineSearch(snes_, &search));
  if (std::holds_alternative<ChosenSteps>(steps)) {
    choose_line_search(snes_, chosen_search_);
  } else if (problem_.tangent_is_symmetric() && problem_.layout().num_extra() == 0) {
    AMT_PETSC(SNESLineSearchSetType(search, SNESLINESEARCHSHELL));
    AMT_PETSC(SNESLineSearchShellSetUserFunc(search, search_energy, this));
  } else {
    search_residual(snes_, chosen_search_);
  }
  ask_for_decrease(snes_, sufficient_decrease_);
}

double Newton::imbalance(Vec unknowns) {
  double norm = 0.0;
  problem_.residual(unknowns, residual_);
  AMT_PETSC(VecNorm(residual_, NORM_2, &norm));
  return relative_to_forces(norm, problem_);
}

PetscErrorCode Newton::search_energy(SNESLineSearch search, void* self) {
  auto& newton = *static_cast<Newton*>(self);
  return guarded(newton.kept_, [&] {
    const double length = EnergySearch(search).run();
    AMT_PETSC(SNESLineSearchSetLambda(search, length));
    AMT_PETSC(SNESLineSearchComputeNorms(search));
  });
}

PetscErrorCode Newton::evaluate_residual(SNES, Vec unknowns, Vec result, void* self) {
  auto& newton = *static_cast<Newton*>(self);
  return guarded(newton.kept_, [&] {
    end_outside_domain(newton.snes_, newton.problem_.residual(unknowns, result), result);
    if (newton.tangent_solver_) newton.tangent_solver_->add_left_out(unknowns, result);
  });
}

PetscErrorCode Newton::evaluate_tangent(SNES, Vec unknowns, Mat matrix, Mat, void* self) {
  auto& newton = *static_cast<Newton*>(self);
  return guarded(newton.kept_, [&] {
    const bool is_guess = newton.problem_.is_first_guess();
    ask_for_decrease(newton.snes_, is_guess ? accept_anything : newton.sufficient_decrease_);
    if (!newton.problem_.tangent(unknowns, matrix)) return;
    if (newton.tangent_solver_) newton.tangent_solver_->tangent_changed();
    if (newton.lag_) newton.lag_->decide(newton.snes_, newton.last_norm_);
    if (!newton.lag_ || newton.lag_->rebuilds()) ++newton.factorizations_;
  });
}

PetscErrorCode Newton::test_convergence(SNES snes, PetscInt iteration, PetscReal, PetscReal, PetscReal norm,
                                        SNESConvergedReason* reason, void* self) {
  auto& newton = *static_cast<Newton*>(self);
  return guarded(newton.kept_, [&] {
    *reason = judge_residual(snes, newton.problem_, iteration, norm);
    newton.course_.observe(relative_to_forces(norm, newton.problem_));
    if (iteration == 0) newton.first_norm_ = norm;
    if (*reason == SNES_CONVERGED_ITERATING && norm <= newton.reduction_ * newton.first_norm_)
      *reason = SNES_CONVERGED_FNORM_RELATIVE;
    if (newton.interrupted_ && newton.interrupted_())
      *reason = SNES_BREAKOUT_INNER_ITER;
    else if (*reason == SNES_CONVERGED_ITERATING && newton.course_.repeats_itself())
      *reason = SNES_DIVERGED_LOCAL_MIN;
    else if (*reason > 0 && iteration < newton.least_iterations_ && norm > 1e-15 * newton.problem_.force_scale())
      *reason = SNES_CONVERGED_ITERATING;
    if (*reason == SNES_CONVERGED_ITERATING) newton.limit_linear_solve(norm);
  });
}

/// Where convergence is quadratic, Eisenstat and Walker's rule asks the last linear solve for more than Newton's method
/// can use. (A method that looks at preconditioned residuals cannot be told so.)
void Newton::limit_linear_solve(double norm) {
  constexpr double margin = 0.3; // what the tangent does not foresee needs room, too
  const double goal = std::max(small_residual(snes_, problem_), reduction_ * first_norm_);
  KSP ksp = nullptr;
  KSPNormType kind = KSP_NORM_DEFAULT;
  last_norm_ = norm;
  AMT_PETSC(SNESGetKSP(snes_, &ksp));
  AMT_PETSC(KSPGetNormType(ksp, &kind));
  if (kind != KSP_NORM_UNPRECONDITIONED) return;
  // A solve that must iterate though its residual is small already still has something to do.
  AMT_PETSC(KSPSetTolerances(ksp, PETSC_DEFAULT, margin * std::min(goal, 0.1 * norm), PETSC_DEFAULT, PETSC_DEFAULT));
}

Trouble Newton::trouble() const {
  const auto outcome = outcome_of(snes_, problem_);
  Trouble trouble;
  trouble.solver = outcome.reason;
  trouble.residual = outcome.residual;
  course_.describe(trouble);
  trouble.free = find_free_motions(problem_, matrix_);
  return trouble;
}

/// With the tangent in matrix_.
bool Newton::solve_linear(Vec load, Vec result) {
  KSP solver = nullptr;
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  AMT_PETSC(SNESGetKSP(snes_, &solver));
  AMT_PETSC(KSPSetOperators(solver, matrix_, matrix_));
  AMT_PETSC(KSPSolve(solver, load, result));
  clear_prescribed(problem_, result);
  AMT_PETSC(KSPGetConvergedReason(solver, &reason));
  return reason > 0;
}

/// PETSc (3.18) takes a factorization that failed for one that MUMPS has analysed in vain, and makes no other until the
/// pattern changes; the solve after that has no factors and is an error. So it starts anew.
void Newton::forget_failed_factorization() {
  KSP solver = nullptr;
  PC preconditioner = nullptr;
  PCFailedReason reason = PC_NOERROR;
  AMT_PETSC(SNESGetKSP(snes_, &solver));
  AMT_PETSC(KSPGetPC(solver, &preconditioner));
  AMT_PETSC(PCGetFailedReason(preconditioner, &reason));
  int failed = reason != PC_NOERROR;
  MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, problem_.comm());
  if (failed) AMT_PETSC(PCReset(preconditioner));
}

/// Where the supports move a body that must not be strained by their motion alone; see Problem::begin_prediction.
void Newton::predict(Vec unknowns) {
  VecHandle load = problem_.layout().new_vector(), step = problem_.layout().new_vector();
  if (problem_.begin_prediction(unknowns, matrix_, load)) {
    if (tangent_solver_) tangent_solver_->tangent_changed();
    ++factorizations_;
    if (!solve_linear(load, step)) AMT_PETSC(VecSet(step, 0.0)); // the solve from there will tell what is wrong
    forget_failed_factorization();
  }
  problem_.end_prediction(unknowns, step);
}

bool Newton::solve_linearized(Vec unknowns, Vec load, double accuracy, Vec result) {
  const Phase phase("linear solver");
  const bool is_new = problem_.tangent(unknowns, matrix_);
  if (tangent_solver_) {
    tangent_solver_->begin();
    if (is_new) tangent_solver_->tangent_changed();
    tangent_solver_->want_accuracy();
  }
  // Where a tolerance of factorizations is one of forces, it is that of the scene: a load of their size is solved for as
  // well as they are.
  PetscReal norm = 0.0;
  AMT_PETSC(VecNorm(load, NORM_2, &norm));
  AMT_PETSC(VecSet(result, 0.0));
  if (norm == 0.0) return true;
  const double scale = problem_.force_scale() > 0.0 ? problem_.force_scale() / norm : 1.0;
  AMT_PETSC(VecScale(load, scale));
  const KrylovAccuracy to_that(snes_, accuracy);
  const bool is_solved = solve_linear(load, result);
  AMT_PETSC(VecScale(load, 1.0 / scale));
  AMT_PETSC(VecScale(result, 1.0 / scale));
  if (tangent_solver_) tangent_solver_->rethrow();
  return is_solved;
}

void Newton::run(Vec unknowns) {
  const PetscErrorCode code = SNESSolve(snes_, nullptr, unknowns);
  if (kept_) std::rethrow_exception(kept_);
  if (tangent_solver_) tangent_solver_->rethrow();
  AMT_PETSC(code);
}

SolveOutcome Newton::solve(Vec unknowns) {
  factorizations_ = 0;
  course_.clear();
  kept_ = nullptr;
  if (tangent_solver_) tangent_solver_->begin();
  const Phase phase("linear solver"); // the phases of forms inside stop this clock
  forget_failed_factorization();
  if (problem_.wants_prediction()) predict(unknowns);
  // A loop around this may want more than equilibrium, and its solves are short.
  const bool is_alone = least_iterations_ == 0 && reduction_ == 0.0;
  if (tangent_solver_ && is_alone) tangent_solver_->allow_partial_steps();
  run(unknowns);
  SolveOutcome outcome = outcome_of(snes_, problem_);
  if (tangent_solver_ && tangent_solver_->complete(unknowns) && outcome.converged) {
    // The residual of the state that counts is measured, and the solve goes on if it is not small.
    const int before = outcome.newton;
    run(unknowns);
    outcome = outcome_of(snes_, problem_);
    outcome.newton += before;
  }
  outcome.factorizations = factorizations_;
  if (tangent_solver_) {
    outcome.factorizations = tangent_solver_->factorizations();
    outcome.linear = tangent_solver_->iterations();
  }
  return outcome;
}

} // namespace amontons
