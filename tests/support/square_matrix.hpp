// Matrices whose entries a test sets itself.
#pragma once

#include "base/petsc.hpp"

#include <doctest/doctest.h>

namespace amontons::test {

/// size x size over all ranks, with room for `entries` in a row. Collective.
inline MatHandle square_matrix(PetscInt size, PetscInt entries) {
  MatHandle matrix;
  REQUIRE(MatCreate(PETSC_COMM_WORLD, matrix.put()) == 0);
  MatSetSizes(matrix, PETSC_DECIDE, PETSC_DECIDE, size, size);
  MatSetType(matrix, MATAIJ);
  MatSeqAIJSetPreallocation(matrix, entries, nullptr);
  MatMPIAIJSetPreallocation(matrix, entries, nullptr, entries, nullptr);
  return matrix;
}

inline void assemble(Mat matrix) {
  MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY);
  MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY);
}

/// Frobenius norm of the difference of two matrices of one pattern. Collective.
inline double distance(Mat one, Mat other) {
  MatHandle change;
  MatDuplicate(one, MAT_COPY_VALUES, change.put());
  MatAXPY(change, -1.0, other, SAME_NONZERO_PATTERN);
  double norm = 0.0;
  MatNorm(change, NORM_FROBENIUS, &norm);
  return norm;
}

} // namespace amontons::test
