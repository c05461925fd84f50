#include "form/kept_rows.hpp"

#include <algorithm>
#include <doctest/doctest.h>

using namespace amontons;

TEST_CASE("kept rows are put back, also those with columns of other ranks") {
  constexpr PetscInt size = 30;
  MatHandle matrix, before;
  REQUIRE(MatCreate(PETSC_COMM_WORLD, matrix.put()) == 0);
  MatSetSizes(matrix, PETSC_DECIDE, PETSC_DECIDE, size, size);
  MatSetType(matrix, MATAIJ);
  MatSeqAIJSetPreallocation(matrix, 3, nullptr);
  MatMPIAIJSetPreallocation(matrix, 3, nullptr, 2, nullptr);
  PetscInt first = 0, end = 0;
  MatGetOwnershipRange(matrix, &first, &end);
  const auto add = [&](PetscInt row, double value) {
    for (PetscInt column = std::max<PetscInt>(0, row - 1); column <= std::min(size - 1, row + 1); ++column)
      MatSetValue(matrix, row, column, value + double(column), ADD_VALUES);
  };
  const auto assemble = [&] {
    MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY);
    MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY);
  };
  std::vector<PetscInt> every_third;
  for (PetscInt row = first; row < end; ++row) {
    add(row, 10.0 + 7.0 * double(row));
    if (row % 3 == 0) every_third.push_back(row);
  }
  assemble();
  MatDuplicate(matrix, MAT_COPY_VALUES, before.put());
  KeptRows kept;
  kept.store(matrix, every_third);
  const auto difference = [&] {
    MatHandle change;
    MatDuplicate(matrix, MAT_COPY_VALUES, change.put());
    MatAXPY(change, -1.0, before, SAME_NONZERO_PATTERN);
    double norm = 0.0;
    MatNorm(change, NORM_FROBENIUS, &norm);
    return norm;
  };
  for (const PetscInt row : every_third)
    add(row, 1.0);
  assemble();
  CHECK(difference() > 1.0);
  kept.restore(matrix);
  CHECK(difference() == 0.0);
}
