// Solves one increment of a Problem by SNES (semismooth Newton: the active set is part of the iteration), with MUMPS or
// a Krylov method with multigrid underneath. Everything can be tuned by PETSc options: -snes_*, -ksp_*, -pc_*,
// -mat_mumps_*.
#pragma once

#include "form/problem.hpp"
#include "solve/increment_newton.hpp"
#include "solve/light_multigrid.hpp"
#include "solve/preconditioner_lag.hpp"
#include "solve/solve_course.hpp"
#include "solve/trouble.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace amontons {

class TangentSolver;

/// Sets a PETSc option unless it is set already; tells whether it has.
bool set_if_absent(const std::string& name, const std::string& value);

/// The same for a choice of the program's, not of the user's.
void default_option(const std::string& name, const std::string& value);

/// Takes back what default_option() has set, so that the next problem of this process (a finer mesh) gets a choice of
/// its own.
void forget_default_options();

/// Sets the defaults for a problem: direct (MUMPS, Cholesky where the tangent is symmetric, SCOTCH ordering) or, above
/// a size where factorization no longer pays and for displacement-only problems, CG with smoothed-aggregation
/// multigrid. Returns in words what was chosen.
std::string choose_linear_solver(const Problem& problem);

/// Rigid-body modes, which multigrid needs to coarsen elasticity well. Collective.
NullSpaceHandle rigid_body_modes(const DofLayout& layout);

/// Where a residual does not exist (see Problem::residual): makes it a domain error of the SNES, which ends the solve.
/// Collective.
void end_outside_domain(SNES snes, bool exists, Vec residual);

/// Whether to go on at a residual of this norm: converged when it is small (snes_rtol) against the forces that are
/// balanced, which, unlike the first residual of an increment, do not become small when the guess is good.
SNESConvergedReason judge_residual(SNES snes, const Problem& problem, PetscInt iteration, double norm);
/// The norm that judge_residual() takes for small.
double small_residual(SNES snes, const Problem& problem);

/// Backtracking goes back until |F|² has fallen by `alpha` of what the tangent promises. A tangent that is no
/// derivative promises nothing: with `accept_anything` its full step passes. Nothing happens with other line searches.
constexpr PetscReal accept_anything = -1e30;
void ask_for_decrease(SNES snes, PetscReal alpha);
/// That alpha as the options have it.
PetscReal decrease_asked_for(SNES snes);

/// The line search that a SNES has, by its name in PETSc, and another one, tuned by the options.
std::string chosen_line_search(SNES snes);
void choose_line_search(SNES snes, const std::string& type);
/// Steps that a merit function of the residual shortens: |F|² where steps are not shortened otherwise, and |K⁻¹ F|, the
/// natural one (P. Deuflhard, Newton Methods for Nonlinear Problems (2004), 3.3), where |F|² is in use already.
void search_residual(SNES snes, const std::string& chosen);

/// Residual norm relative to the forces in play; zero without any.
double relative_to_forces(double norm, const Problem& problem);

/// How a finished SNES went, without outer iterations and factorizations.
SolveOutcome outcome_of(SNES snes, const Problem& problem);

class Newton : public IncrementNewton {
 public:
  /// Call choose_linear_solver first. `interrupted` is asked at every iteration and must be the same on every rank.
  /// Collective.
  Newton(Problem& problem, std::function<bool()> interrupted);
  ~Newton() override;

  /// Iterate at least this often unless the residual is rounding: for a loop around that wants more accuracy than the
  /// tolerance and pays only a back-substitution for it.
  void require_iterations(int least) { least_iterations_ = least; }
  /// Of the next solves: one ends, too, when it has made the residual so many times smaller than it was at its start.
  /// For a loop around whose next change will disturb the equilibrium by more than that. 0: to the tolerance.
  void set_reduction(double reduction) { reduction_ = reduction; }

  /// From the state in `unknowns` (prescribed values already in place) to equilibrium. Collective.
  SolveOutcome solve(Vec unknowns) override;

  /// For the next solves. The merit function is the energy where there is one whose minimum is sought (symmetric
  /// tangent, displacements only), by an exact search, for which Newton's method converges from anywhere if the energy
  /// is convex; else as search_residual().
  void set_steps(const StepLength& steps) override;
  double imbalance(Vec unknowns) override;
  /// Displacements under `load` (zero in prescribed equations) in the problem linearised at `unknowns`; for problems
  /// with a symmetric tangent. A back-substitution where a factorization is at hand; else `accuracy` is the residual
  /// over the load to which it is solved. False if the linear solver failed. Collective.
  bool solve_linearized(Vec unknowns, Vec load, double accuracy, Vec result);
  /// What went on in the last solve, which did not converge. Collective.
  Trouble trouble() const;
  std::vector<Switching*> switching() const override { return problem_.switching(); }
  const StatusWatch& watch() const override { return course_.watch(); }

 private:
  static PetscErrorCode evaluate_residual(SNES, Vec unknowns, Vec result, void* self);
  static PetscErrorCode evaluate_tangent(SNES, Vec unknowns, Mat matrix, Mat, void* self);
  static PetscErrorCode test_convergence(SNES, PetscInt iteration, PetscReal, PetscReal, PetscReal norm,
                                         SNESConvergedReason* reason, void* self);
  static PetscErrorCode search_energy(SNESLineSearch search, void* self);
  void use_light_multigrid();
  void limit_linear_solve(double norm);
  void predict(Vec unknowns);
  bool solve_linear(Vec load, Vec result);
  void forget_failed_factorization();
  void run(Vec unknowns);

  Problem& problem_;
  std::function<bool()> interrupted_;
  SnesHandle snes_;
  std::unique_ptr<TangentSolver> tangent_solver_; // absent where PETSc's own preconditioners do
  MatHandle matrix_;
  VecHandle residual_;
  SolveCourse course_; // of the running solve
  std::string chosen_search_;
  std::optional<PreconditionerLag> lag_; // absent for factorizations
  std::optional<LightMultigrid> light_;  // where multigrid was chosen
  std::exception_ptr kept_;
  int factorizations_ = 0, least_iterations_ = 0;
  double reduction_ = 0.0, first_norm_ = 0.0; // norm of the residual at the start of the running solve
  double last_norm_ = 0.0;                    // and where the last linear solve started from
  PetscReal sufficient_decrease_ = 0.0;       // of a backtracking line search
};

} // namespace amontons
