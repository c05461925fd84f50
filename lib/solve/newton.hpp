// Solves one increment of a Problem by SNES (semismooth Newton: the active set is part of the iteration), with MUMPS or
// a Krylov method with multigrid underneath. Everything can be tuned by PETSc options: -snes_*, -ksp_*, -pc_*,
// -mat_mumps_*.
#pragma once

#include "form/problem.hpp"

#include <functional>
#include <string>

namespace amontons {

/// How a solve went. Not converging is an outcome, not an exception.
struct SolveOutcome {
  bool converged = false;
  int newton = 0;         // iterations
  int linear = 0;         // Krylov iterations (1 a solve with a direct solver)
  int outer = 0;          // Uzawa iterations, 0 without multipliers to update
  int factorizations = 0; // or preconditioner set-ups
  double residual = 0.0;  // out-of-balance force relative to the force scale
  std::string reason;     // in words
};

/// Sets a PETSc option unless the user has set it already.
void default_option(const std::string& name, const std::string& value);

/// Sets the defaults for a problem: direct (MUMPS, Cholesky where the tangent is symmetric, SCOTCH ordering) or, above
/// a size where factorization no longer pays and for displacement-only problems, CG with smoothed-aggregation
/// multigrid. Returns in words what was chosen.
std::string choose_linear_solver(const Problem& problem);

/// Rigid-body modes, which multigrid needs to coarsen elasticity well. Collective.
NullSpaceHandle rigid_body_modes(const DofLayout& layout);

/// The residual, or where there is none a domain error of the SNES, which ends the solve. Collective.
void evaluate_in_domain(SNES snes, Problem& problem, Vec unknowns, Vec result);

/// Whether to go on at a residual of this norm: converged when it is small (snes_rtol) against the forces that are
/// balanced, which, unlike the first residual of an increment, do not become small when the guess is good.
SNESConvergedReason judge_residual(SNES snes, const Problem& problem, PetscInt iteration, double norm);

/// How a finished SNES went, without outer iterations and factorizations.
SolveOutcome outcome_of(SNES snes, const Problem& problem);

class Newton {
 public:
  /// Call choose_linear_solver first. `interrupted` is asked at every iteration and must be the same on every rank.
  /// Collective.
  Newton(Problem& problem, std::function<bool()> interrupted);

  /// Iterate at least this often unless the residual is rounding: for a loop around that wants more accuracy than the
  /// tolerance and pays only a back-substitution for it.
  void require_iterations(int least) { least_iterations_ = least; }

  /// From the state in `unknowns` (prescribed values already in place) to equilibrium. Collective.
  SolveOutcome solve(Vec unknowns);

 private:
  static PetscErrorCode evaluate_residual(SNES, Vec unknowns, Vec result, void* self);
  static PetscErrorCode evaluate_tangent(SNES, Vec unknowns, Mat matrix, Mat, void* self);
  static PetscErrorCode test_convergence(SNES, PetscInt iteration, PetscReal, PetscReal, PetscReal norm,
                                         SNESConvergedReason* reason, void* self);
  static PetscErrorCode stay_in_domain(SNESLineSearch, Vec start, Vec step, PetscBool* changed, void* self);
  void guard_domain();
  void ask_for_decrease(bool is_asked);
  void predict(Vec unknowns);

  Problem& problem_;
  std::function<bool()> interrupted_;
  SnesHandle snes_;
  MatHandle matrix_;
  VecHandle residual_;
  std::exception_ptr kept_;
  int factorizations_ = 0, least_iterations_ = 0;
  PetscReal sufficient_decrease_ = 0.0; // of a backtracking line search
};

} // namespace amontons
