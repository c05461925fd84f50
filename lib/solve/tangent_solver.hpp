// What solves the linear systems of Newton's method in place of PETSc's own preconditioners: it sees which tangent the
// matrix holds, and decides what of an earlier factorization is still of use. Knows matrices and SNES, nothing of
// contact.
#pragma once

#include "form/problem.hpp"

#include <exception>
#include <memory>

namespace amontons {

class TangentSolver {
 public:
  virtual ~TangentSolver() = default;
  TangentSolver(const TangentSolver&) = delete;
  TangentSolver& operator=(const TangentSolver&) = delete;

  /// The matrix of the SNES holds another tangent.
  void tangent_changed() { ++tangent_; }
  /// The next system is no Newton step, which may be rough at first: solve it to the end.
  virtual void want_accuracy() {}

  /// Until complete(), a step may leave out parts that do not matter to the next ones. A residual is then that of the
  /// state in which they are put right only with add_left_out(). Collective.
  virtual void allow_partial_steps() {}
  /// Adds to the residual at `unknowns` what the parts left out would change in it. Collective.
  virtual void add_left_out(Vec /*unknowns*/, Vec /*residual*/) {}
  /// Puts the parts left out into the unknowns; false if there were none. Steps are whole from now on. Collective.
  virtual bool complete(Vec /*unknowns*/) { return false; }

  /// Since begin(): sparse factorizations, and iterations of a Krylov method.
  int factorizations() const { return factorizations_; }
  int iterations() const { return iterations_; }
  void begin();
  /// Throws what a callback caught since begin().
  void rethrow() const;

 protected:
  /// Makes itself the preconditioner of a SNES whose KSP is `preonly` with `shell`. Neither may be destroyed first
  /// while the other still solves. Collective.
  TangentSolver(const Problem& problem, SNES snes);
  /// False when the tangent is singular. Collective.
  virtual bool solve(Vec right, Vec solution) = 0;
  /// The norm of a residual that Newton's method cannot tell from none: a hundredth of its tolerance.
  double smallest_residual() const;
  /// ‖right − A solution‖, which is left in defect(). Collective.
  double measure_defect(Vec right, Vec solution);
  Vec defect() const { return defect_; }

  static constexpr int none = -1;
  const Problem& problem_;
  SNES snes_;
  Mat matrix_ = nullptr;
  int tangent_ = 0; // which one the matrix holds
  int factorizations_ = 0, iterations_ = 0;
  std::exception_ptr caught_;

 private:
  static PetscErrorCode apply(PC shell, Vec right, Vec solution);
  VecHandle defect_;
};

/// The one that the options ask for, KeptFactorization or SchurFactorization (`-pc_type shell`, `-shell_solver kept
/// | schur`); null where they name a preconditioner of PETSc's. Collective.
std::unique_ptr<TangentSolver> new_tangent_solver(const Problem& problem, SNES snes);

} // namespace amontons
