// The values of some rows of a matrix, kept to be put back. The constant part of a tangent needs to be remembered only
// where other forms add to it: on contact surfaces, not in the bulk. (MatStoreValues keeps all, which at millions of
// unknowns is gigabytes.)
#pragma once

#include "base/petsc.hpp"

#include <span>
#include <vector>

namespace amontons {

class KeptRows {
 public:
  /// Copies the values of these rows of an assembled AIJ matrix (equations that this rank owns, ascending).
  void store(Mat matrix, std::span<const PetscInt> rows);
  /// Puts them back; the pattern must be that of store().
  void restore(Mat matrix) const;

 private:
  std::vector<PetscInt> rows_; // local
  std::vector<double> values_; // row by row, of the diagonal part of this rank first, then of the rest
};

} // namespace amontons
