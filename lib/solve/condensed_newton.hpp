// Solves one increment of a Problem whose contact is a set of conditions on relative motions û, u = T û (semismooth
// contact with the dual basis): Newton's method by SNES on as many unknowns as there are displacements. Without
// friction the systems are symmetric positive definite: MUMPS Cholesky, or conjugate gradients with multigrid.
#pragma once

#include "form/condensed_unknowns.hpp"
#include "solve/changed_problem.hpp"
#include "solve/newton.hpp"

#include <vector>

namespace amontons {

class CondensedNewton : public IncrementNewton {
 public:
  /// Call choose_linear_solver first. `interrupted` is asked at every iteration and must be the same on every rank.
  /// Collective.
  CondensedNewton(Problem& problem, CondensedUnknowns& conditions, std::function<bool()> interrupted);

  /// From the state in `unknowns` (prescribed values already in place) to equilibrium. Collective.
  SolveOutcome solve(Vec unknowns) override;
  /// The merit function is |F|² where steps are not shortened otherwise, else |K⁻¹ F|, as for Newton.
  void set_steps(const StepLength& steps) override;
  double imbalance(Vec unknowns) override;
  std::vector<Switching*> switching() const override { return conditions_.switching(); }
  const StatusWatch& watch() const override { return course_.watch(); }

  /// What the last solve, which failed, came to, and the bodies that neither supports nor closed contact hold then.
  /// Collective.
  Trouble trouble();
  /// Gives the contact forms the tractions of a state that was solved before at the problem's time. Collective.
  void recover(Vec unknowns);

 private:
  static PetscErrorCode evaluate_residual(SNES, Vec changed, Vec result, void* self);
  static PetscErrorCode evaluate_tangent(SNES, Vec changed, Mat matrix, Mat, void* self);
  static PetscErrorCode test_convergence(SNES, PetscInt iteration, PetscReal, PetscReal, PetscReal norm,
                                         SNESConvergedReason* reason, void* self);
  static PetscErrorCode before_linear_solve(KSP, Vec right, Vec solution, void* self);
  static PetscErrorCode after_linear_solve(KSP, Vec right, Vec solution, void* self);
  void start(Vec unknowns);
  void take_matrix();
  bool find_residual(Vec changed, Evaluation evaluation, Vec result);
  void find_tangent(Vec changed);
  void replace_rows();
  void add_row(PetscInt row, double factor, PetscInt from);
  void fix_unknowns();
  void move_fixed_to(Vec right);
  void finish(Vec unknowns);

  Problem& problem_;
  CondensedUnknowns& conditions_;
  std::function<bool()> interrupted_;
  ChangedProblem whole_;
  SnesHandle snes_;
  SolveCourse course_; // of the running solve
  std::string chosen_search_;
  MatHandle matrix_; // Tᵀ K T with the rows of conditions
  bool is_assembled_ = false;
  VecHandle changed_, forces_, residual_;
  VecHandle given_residual_, guessed_residual_; // of SNES; that which the first step is to make zero
  bool is_guess_ = false;                       // the next linear solve is that of the first step
  std::vector<ConditionRows> assembled_rows_;
  std::vector<double> scaled_row_;                 // scratch
  PetscReal decrease_ = 0.0;                       // of a backtracking line search
  Evaluation evaluation_ = Evaluation::FirstGuess; // of the next tangent
  std::exception_ptr kept_;
  int factorizations_ = 0;
};

} // namespace amontons
