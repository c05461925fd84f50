#include "solve/condensed_newton.hpp"

#include "base/timer.hpp"
#include "solve/kept_supports.hpp"

#include <algorithm>

namespace amontons {

namespace {

/// Is row r of the node something else than its row of Tᵀ K T?
bool is_replaced(const ConditionRows& rows, int r) {
  for (int c = 0; c < rows.size; ++c)
    if (rows.forces[r][c] != (r == c ? 1.0 : 0.0) || rows.motion[r][c] != 0.0) return true;
  return false;
}

/// Equations whose rows are replaced.
std::vector<PetscInt> replaced_equations(std::span<const ConditionRows> all) {
  std::vector<PetscInt> equations;
  for (const auto& rows : all)
    for (int r = 0; r < rows.size; ++r)
      if (is_replaced(rows, r)) equations.push_back(rows.equations[r]);
  return equations;
}

} // namespace

CondensedNewton::CondensedNewton(Problem& problem, CondensedUnknowns& conditions, std::function<bool()> interrupted)
    : problem_(problem), conditions_(conditions), interrupted_(std::move(interrupted)), whole_(problem),
      course_(problem.comm(), watched(conditions.switching())), changed_(problem.layout().new_vector()),
      forces_(problem.layout().new_vector()), residual_(problem.layout().new_vector()),
      given_residual_(problem.layout().new_vector()), guessed_residual_(problem.layout().new_vector()) {
  AMT_PETSC(SNESCreate(problem.comm(), snes_.put()));
  AMT_PETSC(SNESSetFunction(snes_, residual_, evaluate_residual, this));
  AMT_PETSC(SNESSetConvergenceTest(snes_, test_convergence, this, nullptr));
  AMT_PETSC(SNESSetTolerances(snes_, PETSC_DEFAULT, PETSC_DEFAULT, 0.0, PETSC_DEFAULT, PETSC_DEFAULT));
  AMT_PETSC(SNESSetFromOptions(snes_));
  keep_supports(snes_, problem);
  decrease_ = decrease_asked_for(snes_);
  chosen_search_ = chosen_line_search(snes_);
  KSP ksp = nullptr;
  AMT_PETSC(SNESGetKSP(snes_, &ksp));
  AMT_PETSC(KSPSetPreSolve(ksp, before_linear_solve, this));
  AMT_PETSC(KSPSetPostSolve(ksp, after_linear_solve, this));
}

void CondensedNewton::start(Vec unknowns) {
  kept_ = nullptr;
  conditions_.release();
  if (conditions_.update(problem_.time()) || !whole_.has_transform()) {
    whole_.take_transform(conditions_.transform(), conditions_.inverse());
    matrix_.reset();
  }
  whole_.to_changed(unknowns, changed_);
}

/// After the first tangent with another T.
void CondensedNewton::take_matrix() {
  AMT_PETSC(MatDuplicate(whole_.matrix(), MAT_DO_NOT_COPY_VALUES, matrix_.put()));
  AMT_PETSC(MatSetOption(matrix_, MAT_KEEP_NONZERO_PATTERN, PETSC_TRUE));
  AMT_PETSC(MatSetOption(matrix_, MAT_NO_OFF_PROC_ZERO_ROWS, PETSC_TRUE));
  if (problem_.layout().num_extra() == 0) AMT_PETSC(MatSetNearNullSpace(matrix_, whole_.modes()));
  AMT_PETSC(SNESSetJacobian(snes_, matrix_, matrix_, evaluate_tangent, this));
  is_assembled_ = false;
}

bool CondensedNewton::find_residual(Vec changed, Evaluation evaluation, Vec result) {
  const bool exists = whole_.residual(changed, forces_);
  AMT_PETSC(VecCopy(forces_, result));
  conditions_.evaluate(changed, forces_, evaluation, result);
  return exists;
}

/// Anew only where K or a condition is another than at the last one.
void CondensedNewton::find_tangent(Vec changed) {
  is_assembled_ = !whole_.tangent(changed) && is_assembled_;
  find_residual(changed, evaluation_, guessed_residual_);
  is_guess_ = evaluation_ == Evaluation::FirstGuess;
  ask_for_decrease(snes_, is_guess_ ? accept_anything : decrease_);
  evaluation_ = Evaluation::True;
  const auto rows = conditions_.rows();
  int same = is_assembled_ && std::equal(rows.begin(), rows.end(), assembled_rows_.begin(), assembled_rows_.end());
  MPI_Allreduce(MPI_IN_PLACE, &same, 1, MPI_INT, MPI_MIN, problem_.comm());
  if (same) return;
  const Phase phase("matrix");
  assembled_rows_.assign(rows.begin(), rows.end());
  AMT_PETSC(MatCopy(whole_.matrix(), matrix_, SAME_NONZERO_PATTERN));
  if (problem_.tangent_is_symmetric())
    fix_unknowns();
  else
    replace_rows();
  is_assembled_ = true;
  ++factorizations_;
}

void CondensedNewton::replace_rows() {
  const auto equations = replaced_equations(assembled_rows_);
  AMT_PETSC(MatZeroRows(matrix_, static_cast<PetscInt>(equations.size()), equations.data(), 0.0, nullptr, nullptr));
  for (const auto& rows : assembled_rows_)
    for (int r = 0; r < rows.size; ++r) {
      if (!is_replaced(rows, r)) continue;
      AMT_PETSC(MatSetValues(matrix_, 1, &rows.equations[r], rows.size, rows.equations.data(), rows.motion[r].data(),
                             ADD_VALUES));
      for (int c = 0; c < rows.size; ++c)
        if (rows.forces[r][c] != 0.0) add_row(rows.equations[r], rows.forces[r][c], rows.equations[c]);
    }
  AMT_PETSC(MatAssemblyBegin(matrix_, MAT_FINAL_ASSEMBLY));
  AMT_PETSC(MatAssemblyEnd(matrix_, MAT_FINAL_ASSEMBLY));
}

/// Adds a multiple of a row of Tᵀ K T.
void CondensedNewton::add_row(PetscInt row, double factor, PetscInt from) {
  PetscInt size = 0;
  const PetscInt* columns = nullptr;
  const PetscScalar* values = nullptr;
  AMT_PETSC(MatGetRow(whole_.matrix(), from, &size, &columns, &values));
  scaled_row_.assign(values, values + size);
  for (double& value : scaled_row_)
    value *= factor;
  AMT_PETSC(MatSetValues(matrix_, 1, &row, size, columns, scaled_row_.data(), ADD_VALUES));
  AMT_PETSC(MatRestoreRow(whole_.matrix(), from, &size, &columns, &values));
}

/// Without friction a condition says how far one unknown moves; its column goes to the right side (move_fixed_to), so
/// that the matrix stays symmetric and positive definite.
void CondensedNewton::fix_unknowns() {
  const auto equations = replaced_equations(assembled_rows_);
  AMT_PETSC(
      MatZeroRowsColumns(matrix_, static_cast<PetscInt>(equations.size()), equations.data(), 0.0, nullptr, nullptr));
  for (const auto& rows : assembled_rows_)
    for (int r = 0; r < rows.size; ++r)
      if (is_replaced(rows, r))
        AMT_PETSC(MatSetValue(matrix_, rows.equations[r], rows.equations[r], rows.motion[r][r], INSERT_VALUES));
  AMT_PETSC(MatAssemblyBegin(matrix_, MAT_FINAL_ASSEMBLY));
  AMT_PETSC(MatAssemblyEnd(matrix_, MAT_FINAL_ASSEMBLY));
  AMT_PETSC(MatSetOption(matrix_, MAT_SYMMETRIC, PETSC_TRUE));
}

void CondensedNewton::move_fixed_to(Vec right) {
  const auto fixed = problem_.layout().new_vector(), forces = problem_.layout().new_vector();
  const PetscInt first = problem_.layout().first_equation();
  const auto each = [&](auto&& visit) {
    for (const auto& rows : assembled_rows_)
      for (int r = 0; r < rows.size; ++r)
        if (is_replaced(rows, r)) visit(rows.equations[r] - first, rows.motion[r][r]);
  };
  {
    VecArray moves(fixed);
    VecReader given(right);
    each([&](PetscInt i, double stiffness) { moves[i] = given[i] / stiffness; });
  }
  AMT_PETSC(MatMult(whole_.matrix(), fixed, forces));
  {
    VecArray values(forces);
    each([&](PetscInt i, double) { values[i] = 0.0; });
  }
  AMT_PETSC(VecAXPY(right, -1.0, forces));
}

PetscErrorCode CondensedNewton::before_linear_solve(KSP, Vec right, Vec, void* self) {
  auto& newton = *static_cast<CondensedNewton*>(self);
  return guarded(newton.kept_, [&] {
    AMT_PETSC(VecCopy(right, newton.given_residual_));
    if (newton.is_guess_) AMT_PETSC(VecCopy(newton.guessed_residual_, right));
    newton.is_guess_ = false;
    if (newton.problem_.tangent_is_symmetric()) newton.move_fixed_to(right);
  });
}

/// The right side is SNES's residual, which it looks at again.
PetscErrorCode CondensedNewton::after_linear_solve(KSP, Vec right, Vec, void* self) {
  auto& newton = *static_cast<CondensedNewton*>(self);
  return guarded(newton.kept_, [&] { AMT_PETSC(VecCopy(newton.given_residual_, right)); });
}

PetscErrorCode CondensedNewton::evaluate_residual(SNES, Vec changed, Vec result, void* self) {
  auto& newton = *static_cast<CondensedNewton*>(self);
  return guarded(newton.kept_, [&] {
    end_outside_domain(newton.snes_, newton.find_residual(changed, Evaluation::True, result), result);
  });
}

PetscErrorCode CondensedNewton::evaluate_tangent(SNES, Vec changed, Mat, Mat, void* self) {
  auto& newton = *static_cast<CondensedNewton*>(self);
  return guarded(newton.kept_, [&] { newton.find_tangent(changed); });
}

PetscErrorCode CondensedNewton::test_convergence(SNES snes, PetscInt iteration, PetscReal, PetscReal, PetscReal norm,
                                                 SNESConvergedReason* reason, void* self) {
  auto& newton = *static_cast<CondensedNewton*>(self);
  return guarded(newton.kept_, [&] {
    *reason = judge_residual(snes, newton.problem_, iteration, norm);
    newton.course_.observe(relative_to_forces(norm, newton.problem_));
    if (newton.interrupted_ && newton.interrupted_())
      *reason = SNES_BREAKOUT_INNER_ITER;
    else if (*reason == SNES_CONVERGED_ITERATING && newton.course_.repeats_itself())
      *reason = SNES_DIVERGED_LOCAL_MIN;
  });
}

Trouble CondensedNewton::trouble() {
  const auto outcome = outcome_of(snes_, problem_);
  Trouble trouble;
  trouble.solver = outcome.reason;
  trouble.residual = outcome.residual;
  course_.describe(trouble);
  const auto held = problem_.layout().new_vector();
  {
    VecArray marks(held);
    const PetscInt first = problem_.layout().first_equation();
    for (const auto& rows : assembled_rows_)
      for (int r = 0; r < rows.size; ++r)
        if (is_replaced(rows, r) && rows.motion[r][r] != 0.0) marks[rows.equations[r] - first] = 1.0;
  }
  trouble.free = whole_.free_motions(held);
  return trouble;
}

SolveOutcome CondensedNewton::solve(Vec unknowns) {
  const Phase phase("linear solver");
  factorizations_ = 0;
  course_.clear();
  evaluation_ = Evaluation::FirstGuess;
  start(unknowns);
  whole_.tangent_at(unknowns);
  if (!matrix_) take_matrix();
  const PetscErrorCode code = SNESSolve(snes_, nullptr, changed_);
  if (kept_) std::rethrow_exception(kept_);
  AMT_PETSC(code);
  SolveOutcome outcome = outcome_of(snes_, problem_);
  outcome.factorizations = factorizations_;
  if (outcome.converged) finish(unknowns);
  return outcome;
}

void CondensedNewton::set_steps(const StepLength& steps) {
  if (std::holds_alternative<ChosenSteps>(steps))
    choose_line_search(snes_, chosen_search_);
  else
    search_residual(snes_, chosen_search_);
  ask_for_decrease(snes_, decrease_);
}

double CondensedNewton::imbalance(Vec unknowns) {
  start(unknowns);
  double norm = 0.0;
  find_residual(changed_, Evaluation::True, residual_);
  AMT_PETSC(VecNorm(residual_, NORM_2, &norm));
  return relative_to_forces(norm, problem_);
}

void CondensedNewton::recover(Vec unknowns) {
  start(unknowns);
  finish(unknowns);
}

/// Holds the tractions of the state in `changed_`.
void CondensedNewton::finish(Vec unknowns) {
  find_residual(changed_, Evaluation::True, residual_);
  conditions_.hold();
  AMT_PETSC(VecCopy(whole_.unknowns(), unknowns));
  problem_.residual(unknowns, residual_);
}

} // namespace amontons
