#include "form/kept_rows.hpp"
#include "square_matrix.hpp"

#include <algorithm>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

TEST_CASE("kept rows are put back, also those with columns of other ranks") {
  constexpr PetscInt size = 30;
  const auto matrix = square_matrix(size, 3);
  MatHandle before;
  PetscInt first = 0, end = 0;
  MatGetOwnershipRange(matrix, &first, &end);
  const auto add = [&](PetscInt row, double value) {
    for (PetscInt column = std::max<PetscInt>(0, row - 1); column <= std::min(size - 1, row + 1); ++column)
      MatSetValue(matrix, row, column, value + double(column), ADD_VALUES);
  };
  std::vector<PetscInt> every_third;
  for (PetscInt row = first; row < end; ++row) {
    add(row, 10.0 + 7.0 * double(row));
    if (row % 3 == 0) every_third.push_back(row);
  }
  assemble(matrix);
  MatDuplicate(matrix, MAT_COPY_VALUES, before.put());
  KeptRows kept;
  kept.store(matrix, every_third);
  for (const PetscInt row : every_third)
    add(row, 1.0);
  assemble(matrix);
  CHECK(distance(matrix, before) > 1.0);
  kept.restore(matrix);
  CHECK(distance(matrix, before) == 0.0);
}
