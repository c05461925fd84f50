// Linear systems of Newton's method by a factorization that is kept over several tangents. In small strains the
// tangents of a contact problem differ on the contact surface only, so a factorization of an earlier one, as
// preconditioner, needs few iterations of FGMRES, each of which costs a back-substitution. Knows matrices and SNES,
// nothing of contact.
#pragma once

#include "solve/mumps_factor.hpp"
#include "solve/tangent_solver.hpp"

namespace amontons {

class KeptFactorization : public TangentSolver {
 public:
  /// See TangentSolver. Collective.
  KeptFactorization(const Problem& problem, SNES snes);

  void want_accuracy() override { solved_tangent_ = tangent_; }

 private:
  using Kind = MumpsFactor::Kind;
  static PetscErrorCode substitute(PC shell, Vec right, Vec solution);
  bool solve(Vec right, Vec solution) override;
  bool improve(Vec right, Vec solution, double tolerance, int most, int& iterations);
  double tolerance(double norm);
  bool factorize();

  KspHandle krylov_;
  MumpsFactor factor_;
  Kind kind_ = Kind::Symmetric;
  int factorized_tangent_ = none, solved_tangent_ = none; // the last ones
  double last_norm_ = 0.0;
  int needed_ = 0;     // iterations of the first solve with the present factorization
  int spent_ = 0;      // iterations above that in later ones
  double price_ = 1.0; // of a factorization, in back-substitutions
};

} // namespace amontons
