// Linear systems of Newton's method by a factorization that is kept over several tangents. In small strains the
// tangents of a contact problem differ on the contact surface only, so a factorization of an earlier one, as
// preconditioner, needs few iterations of FGMRES, each of which costs a back-substitution. Knows matrices and SNES,
// nothing of contact.
#pragma once

#include "form/problem.hpp"

namespace amontons {

class KeptFactorization {
 public:
  /// Makes itself the preconditioner of a SNES whose KSP is `preonly` with `shell`. Neither may be destroyed first
  /// while the other still solves. Collective.
  KeptFactorization(const Problem& problem, SNES snes);
  KeptFactorization(const KeptFactorization&) = delete;
  KeptFactorization& operator=(const KeptFactorization&) = delete;

  /// Does this SNES use a preconditioner of type shell? (The user or choose_newton_solver has asked for it.)
  static bool is_asked_for(SNES snes);

  /// The matrix of the SNES holds another tangent.
  void tangent_changed() { ++tangent_; }
  /// The next system is no Newton step, which may be rough at first: solve it to the end.
  void want_accuracy() { solved_tangent_ = tangent_; }

  /// Since begin().
  int factorizations() const { return factorizations_; }
  int iterations() const { return iterations_; }
  void begin();
  /// Throws what a callback caught since begin().
  void rethrow() const;

 private:
  enum class Kind { Symmetric, Unsymmetric };
  static PetscErrorCode apply(PC shell, Vec right, Vec solution);
  static PetscErrorCode substitute(PC shell, Vec right, Vec solution);
  bool solve(Vec right, Vec solution);
  bool improve(Vec right, Vec solution, double tolerance, int most, int& iterations);
  double tolerance(double norm);
  bool factorize();
  MatHandle symmetric_part() const;

  const Problem& problem_;
  SNES snes_;
  Mat matrix_ = nullptr;
  KspHandle krylov_;
  MatHandle factor_;
  VecHandle defect_;
  Kind kind_ = Kind::Symmetric;
  // Which tangent the matrix holds, which one was factorized and which one solved last.
  int tangent_ = 0, factorized_tangent_ = none, solved_tangent_ = none;
  static constexpr int none = -1;
  PetscObjectState factor_pattern_ = -1;
  double last_norm_ = 0.0;
  int needed_ = 0;     // iterations of the first solve with the present factorization
  int spent_ = 0;      // iterations above that in later ones
  double price_ = 1.0; // of a factorization, in back-substitutions
  int factorizations_ = 0, iterations_ = 0;
  std::exception_ptr caught_;
};

} // namespace amontons
