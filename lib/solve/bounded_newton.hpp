// Solves one increment of a Problem whose frictionless contact is a set of bounds on other unknowns û, u = T û, by
// PETSc's SNESVI: the reduced-space active-set method (SNESVINEWTONRSLS), or with -snes_type vinewtonssls the
// semismooth one. The tangent Tᵀ K T stays symmetric and positive definite, so everything that serves a body without
// contact serves here: MUMPS Cholesky, or conjugate gradients with multigrid.
#pragma once

#include "form/bounded_unknowns.hpp"
#include "solve/changed_problem.hpp"
#include "solve/newton.hpp"
#include "solve/whole_preconditioner.hpp"

#include <memory>

namespace amontons {

/// As choose_linear_solver, for a problem with bounds.
std::string choose_bounded_solver(const Problem& problem);

class BoundedNewton {
 public:
  /// Call choose_bounded_solver first. `interrupted` is asked at every iteration and must be the same on every rank.
  /// Collective.
  BoundedNewton(Problem& problem, BoundedUnknowns& bounds, std::function<bool()> interrupted);

  /// From the state in `unknowns` (prescribed values already in place) to equilibrium. The bounds that were touched at
  /// the end of the last solve that converged are taken for touched at the start. Collective.
  SolveOutcome solve(Vec unknowns);
  /// What the last solve, which failed, came to, and the bodies that neither supports nor closed contact hold then.
  /// Collective.
  Trouble trouble();

 private:
  static PetscErrorCode evaluate_residual(SNES, Vec changed, Vec result, void* self);
  static PetscErrorCode evaluate_tangent(SNES, Vec changed, Mat matrix, Mat, void* self);
  static PetscErrorCode test_convergence(SNES, PetscInt iteration, PetscReal, PetscReal, PetscReal norm,
                                         SNESConvergedReason* reason, void* self);
  static PetscErrorCode search_line(SNESLineSearch search, void* self);
  void descend(SNESLineSearch search);
  void take_matrix();
  void start_from(Vec unknowns);
  Vec contact_forces();
  std::vector<WatchedPoints> bounded_points();
  std::vector<std::uint8_t> touching(std::size_t set) const;

  Problem& problem_;
  BoundedUnknowns& bounds_;
  std::function<bool()> interrupted_;
  ChangedProblem whole_;
  SnesHandle snes_;
  MatHandle given_tangent_; // a copy of the tangent for the semismooth method, which scales it in place
  VecHandle changed_, residual_, changed_residual_, upper_, forces_;
  std::unique_ptr<WholePreconditioner> preconditioner_;
  std::vector<BoundedUnknowns::Set> sets_; // as of the last update
  SolveCourse course_;                     // of the running solve, from the first step that must lower the energy on
  std::exception_ptr kept_;
  /// Iterations that take their full step without asking whether the energy falls (-vi_free_iterations): nearly all
  /// solves end within them.
  PetscInt free_iterations_ = 12;
};

} // namespace amontons
