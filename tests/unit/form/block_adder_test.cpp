#include "form/block_adder.hpp"
#include "square_matrix.hpp"

#include <algorithm>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

namespace {

constexpr PetscInt size = 30;

/// A dense matrix kept as AIJ, full of zeros.
MatHandle zeros() {
  auto matrix = square_matrix(size, size);
  PetscInt first = 0, end = 0;
  MatGetOwnershipRange(matrix, &first, &end);
  for (PetscInt row = first; row < end; ++row)
    for (PetscInt column = 0; column < size; ++column)
      if (row == column || (row + column) % 7 != 3) MatSetValue(matrix, row, column, 0.0, ADD_VALUES);
  assemble(matrix);
  MatSetOption(matrix, MAT_NEW_NONZERO_LOCATIONS, PETSC_FALSE);
  return matrix;
}

/// Equations of block i: next to each other, far apart, in falling order, left out, of this rank and of others.
std::vector<PetscInt> equations_of(PetscInt i) {
  return {(3 * i) % size, (3 * i + 1) % size, (3 * i + 2) % size, (11 * i + 5) % size, i % 4 ? size - 1 - i : -1};
}

std::vector<double> block_of(PetscInt i, std::size_t rows) {
  std::vector<double> block(rows * rows);
  for (std::size_t k = 0; k < block.size(); ++k)
    block[k] = 1.0 + 0.25 * double(k) - 0.5 * double(i);
  return block;
}

} // namespace

TEST_CASE("blocks are added as by MatSetValues: near and far columns, left out, of other ranks, without a place") {
  const auto by_petsc = zeros(), by_us = zeros(), empty = zeros();
  {
    BlockAdder adder(by_us);
    for (PetscInt i = 0; i < 8; ++i) {
      const auto equations = equations_of(i);
      const auto block = block_of(i, equations.size());
      const auto count = static_cast<PetscInt>(equations.size());
      MatSetValues(by_petsc, count, equations.data(), count, equations.data(), block.data(), ADD_VALUES);
      adder.add(equations, block);
    }
  }
  assemble(by_petsc);
  assemble(by_us);
  CHECK(distance(by_petsc, empty) > 10.0);
  CHECK(distance(by_petsc, by_us) < 1e-12);
}

TEST_CASE("products see what was added in place") {
  const auto matrix = zeros();
  VecHandle ones, sums;
  MatCreateVecs(matrix, ones.put(), sums.put());
  VecSet(ones, 1.0);
  MatMult(matrix, ones, sums); // whatever PETSc keeps of the old values it keeps from here
  PetscInt first = 0;
  MatGetOwnershipRange(matrix, &first, nullptr);
  {
    BlockAdder adder(matrix);
    adder.add(std::vector<PetscInt>{first, -1}, std::vector<double>{2.0, 1e3, 1e3, 1e3});
  }
  assemble(matrix);
  MatMult(matrix, ones, sums);
  double total = 0.0;
  int ranks = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  VecSum(sums, &total);
  CHECK(total == 2.0 * ranks);
}
