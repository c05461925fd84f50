#include "solve/bounded_newton.hpp"

#include "base/timer.hpp"
#include "solve/kept_supports.hpp"

#include <algorithm>
#include <array>

namespace amontons {

namespace {

constexpr int most_halvings = 30;
/// Unknowns in 3D above which multigrid beats factorizations here: every iteration has another reduced matrix to
/// factor.
constexpr PetscInt multigrid_from_3d = 100'000;
/// Part of the promised fall of energy that a shortened step must bring (Armijo).
constexpr double least_fall = 1e-4;

bool is_semismooth() {
  std::array<char, 64> type{};
  AMT_PETSC(PetscOptionsGetString(nullptr, nullptr, "-snes_type", type.data(), type.size(), nullptr));
  return std::string(type.data()) == SNESVINEWTONSSLS;
}

} // namespace

std::string choose_bounded_solver(const Problem& problem) {
  // PETSc compares a length with this; a bounded unknown that is on its bound is there to the last digit.
  default_option("-snes_vi_zero_tolerance", "0");
  if (is_semismooth()) { // its Jacobian is not symmetric
    default_option("-snes_linesearch_type", SNESLINESEARCHBT);
    default_option("-ksp_type", KSPPREONLY);
    default_option("-pc_type", PCLU);
  }
  default_option("-snes_linesearch_type", SNESLINESEARCHSHELL);
  if (problem.layout().dim() == 3 && problem.layout().num_global() > multigrid_from_3d)
    default_option("-pc_type", PCGAMG);
  return choose_linear_solver(problem) + " on " + (is_semismooth() ? "semismooth" : "reduced") + " systems";
}

BoundedNewton::BoundedNewton(Problem& problem, BoundedUnknowns& bounds, std::function<bool()> interrupted)
    : problem_(problem), bounds_(bounds), interrupted_(std::move(interrupted)), whole_(problem),
      changed_(problem.layout().new_vector()), residual_(problem.layout().new_vector()),
      changed_residual_(problem.layout().new_vector()), upper_(problem.layout().new_vector()),
      forces_(problem.layout().new_vector()), sets_(bounds.sets()), course_(problem.comm(), bounded_points()) {
  AMT_PETSC(VecSet(upper_, PETSC_INFINITY));
  AMT_PETSC(PetscOptionsGetInt(nullptr, nullptr, "-vi_free_iterations", &free_iterations_, nullptr));
  AMT_PETSC(SNESCreate(problem.comm(), snes_.put()));
  AMT_PETSC(SNESSetType(snes_, SNESVINEWTONRSLS));
  AMT_PETSC(SNESSetFunction(snes_, changed_residual_, evaluate_residual, this));
  AMT_PETSC(SNESSetConvergenceTest(snes_, test_convergence, this, nullptr));
  AMT_PETSC(SNESSetFromOptions(snes_));
  SNESLineSearch search = nullptr;
  AMT_PETSC(SNESGetLineSearch(snes_, &search));
  AMT_PETSC(SNESLineSearchSetFromOptions(search));
  AMT_PETSC(SNESLineSearchShellSetUserFunc(search, search_line, this));
  KSP ksp = nullptr;
  PC pc = nullptr;
  PetscBool is_factorization = PETSC_FALSE;
  AMT_PETSC(SNESGetKSP(snes_, &ksp));
  AMT_PETSC(KSPGetPC(ksp, &pc));
  AMT_PETSC(PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(pc), &is_factorization, PCLU, PCCHOLESKY,
                                      PCREDUNDANT, ""));
  if (!is_factorization && !is_semismooth()) preconditioner_ = std::make_unique<WholePreconditioner>(snes_);
}

/// After the first tangent with another T.
void BoundedNewton::take_matrix() {
  given_tangent_.reset();
  if (is_semismooth()) AMT_PETSC(MatDuplicate(whole_.matrix(), MAT_DO_NOT_COPY_VALUES, given_tangent_.put()));
  Mat given = given_tangent_ ? given_tangent_.get() : whole_.matrix();
  AMT_PETSC(SNESSetJacobian(snes_, given, given, evaluate_tangent, this));
}

PetscErrorCode BoundedNewton::evaluate_residual(SNES, Vec changed, Vec result, void* self) {
  auto& newton = *static_cast<BoundedNewton*>(self);
  return guarded(newton.kept_,
                 [&] { end_outside_domain(newton.snes_, newton.whole_.residual(changed, result), result); });
}

PetscErrorCode BoundedNewton::evaluate_tangent(SNES, Vec changed, Mat, Mat, void* self) {
  auto& newton = *static_cast<BoundedNewton*>(self);
  return guarded(newton.kept_, [&] {
    newton.whole_.tangent(changed);
    if (newton.given_tangent_) AMT_PETSC(MatCopy(newton.whole_.matrix(), newton.given_tangent_, SAME_NONZERO_PATTERN));
  });
}

PetscErrorCode BoundedNewton::test_convergence(SNES snes, PetscInt iteration, PetscReal, PetscReal, PetscReal norm,
                                               SNESConvergedReason* reason, void* self) {
  auto& newton = *static_cast<BoundedNewton*>(self);
  return guarded(newton.kept_, [&] {
    *reason = judge_residual(snes, newton.problem_, iteration, norm);
    // Full steps may go through a cycle; what counts is whether steps that must lower the energy still get on.
    if (iteration >= newton.free_iterations_) newton.course_.observe(relative_to_forces(norm, newton.problem_));
    if (newton.interrupted_ && newton.interrupted_())
      *reason = SNES_BREAKOUT_INNER_ITER;
    else if (*reason == SNES_CONVERGED_ITERATING && newton.course_.repeats_itself())
      *reason = SNES_DIVERGED_LOCAL_MIN;
  });
}

PetscErrorCode BoundedNewton::search_line(SNESLineSearch search, void* self) {
  auto& newton = *static_cast<BoundedNewton*>(self);
  return guarded(newton.kept_, [&] { newton.descend(search); });
}

/// Projected Newton step. After the first iterations steps are halved until the potential energy falls, as D. P.
/// Bertsekas (SIAM J. Control Optim. 20 (1982) 221-246) does, so that active sets cannot go round in circles. The fall
/// is the residual's work along the step by the trapezoidal rule: exact for linear elasticity.
void BoundedNewton::descend(SNESLineSearch search) {
  Vec start = nullptr, force = nullptr, step = nullptr, next = nullptr, next_force = nullptr;
  SNESLineSearchVIProjectFunc project = nullptr;
  SNESLineSearchVINormFunc inactive_norm = nullptr;
  PetscInt iteration = 0;
  AMT_PETSC(SNESLineSearchGetVecs(search, &start, &force, &step, &next, &next_force));
  AMT_PETSC(SNESLineSearchGetVIFunctions(search, &project, &inactive_norm));
  AMT_PETSC(SNESGetIterationNumber(snes_, &iteration));
  clear_prescribed(problem_, step);
  const auto move = problem_.layout().new_vector();
  const auto take = [&](double length) {
    AMT_PETSC(VecWAXPY(next, -length, step, start));
    AMT_PETSC(project(snes_, next));
    AMT_PETSC(SNESComputeFunction(snes_, next, next_force));
  };
  const auto energy_falls = [&] {
    PetscScalar before = 0.0, after = 0.0;
    AMT_PETSC(VecWAXPY(move, -1.0, start, next));
    AMT_PETSC(VecDot(move, force, &before));
    AMT_PETSC(VecDot(move, next_force, &after));
    return 0.5 * (before + after) <= least_fall * before;
  };
  double length = 1.0;
  take(length);
  for (int halving = 0; iteration >= free_iterations_ && !energy_falls(); ++halving) {
    length = halving < most_halvings ? 0.5 * length : 1.0; // no descent within rounding: Newton knows better
    take(length);
    if (length == 1.0) break;
  }
  PetscReal size = 0.0, norm = 0.0, step_size = 0.0;
  AMT_PETSC(VecCopy(next, start));
  AMT_PETSC(VecCopy(next_force, force));
  AMT_PETSC(inactive_norm(snes_, force, start, &norm));
  AMT_PETSC(VecNorm(start, NORM_2, &size));
  AMT_PETSC(VecNorm(step, NORM_2, &step_size));
  AMT_PETSC(SNESLineSearchSetNorms(search, size, norm, length * step_size));
  AMT_PETSC(SNESLineSearchSetLambda(search, length));
}

void BoundedNewton::start_from(Vec unknowns) {
  whole_.to_changed(unknowns, changed_);
  VecArray values(changed_);
  VecReader lower(bounds_.lower()), forces(forces_);
  for (PetscInt i = 0; i < values.size(); ++i)
    if (forces[i] > 0.0) values[i] = lower[i];
}

/// Forces on the bounds that are touched, by the test of the primal-dual active set.
Vec BoundedNewton::contact_forces() {
  const auto diagonal = problem_.layout().new_vector();
  AMT_PETSC(MatGetDiagonal(whole_.matrix(), diagonal));
  VecArray forces(forces_);
  VecReader values(changed_), lower(bounds_.lower()), residual(changed_residual_), stiffness(diagonal);
  for (PetscInt i = 0; i < forces.size(); ++i) {
    const bool is_bounded = lower[i] > PETSC_NINFINITY;
    forces[i] = is_bounded && residual[i] > stiffness[i] * (values[i] - lower[i]) ? residual[i] : 0.0;
  }
  return forces_;
}

std::vector<WatchedPoints> BoundedNewton::bounded_points() {
  std::vector<WatchedPoints> points;
  for (std::size_t set = 0; set < sets_.size(); ++set)
    points.push_back({.name = sets_[set].name,
                      .branches = [this, set] { return touching(set); },
                      .place = [this, set](std::size_t point) { return sets_[set].places[point]; }});
  return points;
}

/// Bounds that the iterate is on and pressed against, which is what SNESVI takes for active.
std::vector<std::uint8_t> BoundedNewton::touching(std::size_t set) const {
  const auto& unknowns = sets_[set].unknowns;
  std::vector<std::uint8_t> touching(unknowns.size(), std::uint8_t(0));
  if (!bounds_.lower()) return touching; // before the first solve
  const VecReader values(changed_), lower(bounds_.lower()), residual(changed_residual_);
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    if (const PetscInt u = unknowns[i]; u >= 0) touching[i] = values[u] <= lower[u] && residual[u] > 0.0;
  return touching;
}

Trouble BoundedNewton::trouble() {
  const auto outcome = outcome_of(snes_, problem_);
  Trouble trouble;
  trouble.solver = outcome.reason;
  trouble.residual = outcome.residual;
  course_.describe(trouble);
  const auto held = problem_.layout().new_vector();
  if (whole_.residual(changed_, changed_residual_)) {
    VecArray marks(held);
    VecReader forces(contact_forces());
    for (PetscInt i = 0; i < marks.size(); ++i)
      marks[i] = forces[i] > 0.0 ? 1.0 : 0.0;
  }
  trouble.free = whole_.free_motions(held);
  return trouble;
}

SolveOutcome BoundedNewton::solve(Vec unknowns) {
  kept_ = nullptr;
  course_.clear();
  const Phase phase("linear solver");
  bounds_.release();
  const bool moved = bounds_.update(problem_.time()) || !whole_.has_transform();
  if (moved) {
    sets_ = bounds_.sets();
    whole_.take_transform(bounds_.transform(), bounds_.inverse());
    if (preconditioner_) preconditioner_->take_modes(whole_.modes());
  }
  whole_.tangent_at(unknowns);
  if (moved) take_matrix();
  AMT_PETSC(SNESVISetVariableBounds(snes_, bounds_.lower(), upper_));
  start_from(unknowns);
  const PetscErrorCode code = SNESSolve(snes_, nullptr, changed_);
  if (kept_) std::rethrow_exception(kept_);
  AMT_PETSC(code);
  SolveOutcome outcome = outcome_of(snes_, problem_);
  outcome.factorizations = outcome.newton;
  if (!outcome.converged) return outcome;
  whole_.residual(changed_, changed_residual_);
  AMT_PETSC(VecCopy(whole_.unknowns(), unknowns));
  bounds_.hold_forces(contact_forces());
  problem_.residual(unknowns, residual_);
  double norm = 0.0;
  AMT_PETSC(VecNorm(residual_, NORM_2, &norm));
  outcome.residual = relative_to_forces(norm, problem_);
  return outcome;
}

} // namespace amontons
