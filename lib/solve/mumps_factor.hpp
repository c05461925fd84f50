// A matrix factorized by MUMPS through PETSc, for those that decide on their own when to factorize. The analysis is
// kept while the pattern holds.
#pragma once

#include "base/petsc.hpp"

namespace amontons {

/// (A + Aᵀ) / 2. Collective.
MatHandle symmetric_part(Mat matrix);

class MumpsFactor {
 public:
  enum class Kind { Symmetric, Unsymmetric };

  /// Factorizes `source`, of whose pattern `pattern` (MatGetNonzeroState) tells. With `kept`, the numbers of some
  /// equations (one rank only), these are not eliminated: their Schur complement is left in the factor
  /// (MatFactorGetSchurComplement). False when MUMPS cannot (a singular matrix); then there is no factor. Throws
  /// UserError for want of memory. Collective.
  bool factorize(Mat source, PetscObjectState pattern, Kind kind, IS kept = nullptr);
  /// The next factorization begins with an analysis.
  void forget() { factor_.reset(); }

  Mat get() const { return factor_; }
  explicit operator bool() const { return factor_.get() != nullptr; }
  /// Of the last factorization: operations, and entries of the factors.
  double operations() const;
  double entries() const;

 private:
  MatHandle factor_;
  Kind kind_ = Kind::Symmetric;
  PetscObjectState pattern_ = -1;
};

} // namespace amontons
