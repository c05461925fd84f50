// Products and incomplete factors of single precision are those of the matrix to six digits, symmetric to rounding, and
// multigrid finds with them what it finds without.
#include "solve/light_multigrid.hpp"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <string>
#include <vector>

using namespace amontons;

namespace {

/// Symmetric positive definite unless `weakness` is 1 or more: a chain of nodes with `block` equations each, every node
/// coupled with those up to `reach` away in whole blocks. Numbers from 1e11 on, as of SI units.
MatHandle chain(int block, int nodes, int reach, double weakness = 0.0) {
  MatHandle matrix;
  PetscInt own = PETSC_DECIDE, all = nodes;
  AMT_PETSC(PetscSplitOwnership(PETSC_COMM_WORLD, &own, &all));
  AMT_PETSC(MatCreateAIJ(PETSC_COMM_WORLD, own * block, own * block, nodes * block, nodes * block,
                         (2 * reach + 1) * block, nullptr, (2 * reach + 1) * block, nullptr, matrix.put()));
  AMT_PETSC(MatSetBlockSize(matrix, block));
  AMT_PETSC(MatSetUp(matrix));
  PetscInt first = 0, end = 0;
  AMT_PETSC(MatGetOwnershipRange(matrix, &first, &end));
  for (PetscInt row = first; row < end; ++row)
    for (PetscInt column = 0; column < nodes * block; ++column) {
      if (std::abs(row / block - column / block) > reach) continue;
      const double coupling = -0.3 * (1.0 + std::cos(1.0 * (row + column)) * std::cos(1.0 * (row - column)));
      const double value = row == column ? 0.7 * block * (2 * reach + 1) * (1.0 - weakness) : coupling;
      AMT_PETSC(MatSetValue(matrix, row, column, 1e11 * value, INSERT_VALUES));
    }
  AMT_PETSC(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  AMT_PETSC(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  return matrix;
}

VecHandle made_up(Mat matrix, double frequency) {
  VecHandle vector;
  AMT_PETSC(MatCreateVecs(matrix, vector.put(), nullptr));
  PetscInt first = 0;
  AMT_PETSC(VecGetOwnershipRange(vector, &first, nullptr));
  VecArray values(vector);
  for (PetscInt i = 0; i < values.size(); ++i)
    values[i] = std::sin(frequency * (first + i) + 0.3);
  return vector;
}

VecHandle same_layout(Vec vector) {
  VecHandle other;
  AMT_PETSC(VecDuplicate(vector, other.put()));
  return other;
}

/// |a − b| / |b|.
double difference(Vec a, Vec b) {
  VecHandle rest = same_layout(a);
  PetscReal norm = 0.0, whole = 0.0;
  AMT_PETSC(VecWAXPY(rest, -1.0, b, a));
  AMT_PETSC(VecNorm(rest, NORM_2, &norm));
  AMT_PETSC(VecNorm(b, NORM_2, &whole));
  REQUIRE(whole > 0.0);
  return norm / whole;
}

/// How far from symmetric an operator is: |x · B y − y · B x| / (|x| |B y|).
template <class Operator>
double asymmetry(Mat matrix, Operator&& apply) {
  const VecHandle x = made_up(matrix, 0.7), y = made_up(matrix, 1.9);
  VecHandle image = same_layout(x);
  PetscScalar forth = 0.0, back = 0.0;
  PetscReal length = 0.0, image_length = 0.0;
  apply(y, image);
  AMT_PETSC(VecNorm(x, NORM_2, &length));
  AMT_PETSC(VecNorm(image, NORM_2, &image_length));
  AMT_PETSC(VecDot(x, image, &forth));
  apply(x, image);
  AMT_PETSC(VecDot(y, image, &back));
  REQUIRE(image_length > 0.0);
  return std::abs(forth - back) / (length * image_length);
}

/// The PC by its name in PETSc's options, for the matrix.
Handle<PC, PCDestroy> factors(Mat matrix) {
  Handle<PC, PCDestroy> pc;
  register_icc_single();
  AMT_PETSC(PCCreate(PetscObjectComm(reinterpret_cast<PetscObject>(matrix)), pc.put()));
  AMT_PETSC(PCSetOperators(pc, matrix, matrix));
  AMT_PETSC(PCSetType(pc, pc_icc_single));
  AMT_PETSC(PCSetUp(pc));
  return pc;
}

} // namespace

TEST_CASE("products of single precision are the matrix's to its digits, and symmetric to more") {
  for (const int block : {1, 2, 3, 5, 6}) {
    CAPTURE(block);
    const MatHandle matrix = chain(block, 40, 3);
    const VecHandle x = made_up(matrix, 0.7);
    VecHandle exact = same_layout(x), found = same_layout(x);
    SinglePrecisionProduct product(matrix);
    AMT_PETSC(MatMult(matrix, x, exact));
    AMT_PETSC(MatMult(product, x, found));
    CHECK(difference(found, exact) < 2e-7);
    CHECK(difference(found, exact) > 1e-10); // single precision indeed
    CHECK(asymmetry(matrix, [&](Vec in, Vec out) { AMT_PETSC(MatMult(product, in, out)); }) < 1e-13);
    CHECK_FALSE(product.update());
    AMT_PETSC(MatScale(matrix, 3.0));
    CHECK(product.update());
    AMT_PETSC(VecScale(exact, 3.0));
    AMT_PETSC(MatMult(product, x, found));
    CHECK(difference(found, exact) < 2e-7);
    CHECK_FALSE(product.is_outdated());
  }
}

TEST_CASE("blocks may have gaps") {
  MatHandle matrix = chain(3, 40, 1);
  AMT_PETSC(MatSetOption(matrix, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  SinglePrecisionProduct before(matrix);
  PetscInt first = 0;
  AMT_PETSC(MatGetOwnershipRange(matrix, &first, nullptr));
  AMT_PETSC(MatSetValue(matrix, first, (first + 60) % 120, 4e11, INSERT_VALUES));
  AMT_PETSC(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  AMT_PETSC(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  CHECK(before.is_outdated());
  const VecHandle x = made_up(matrix, 0.7);
  VecHandle exact = same_layout(x), found = same_layout(x);
  AMT_PETSC(MatMult(matrix, x, exact));
  AMT_PETSC(MatMult(SinglePrecisionProduct(matrix), x, found));
  CHECK(difference(found, exact) < 2e-7);
}

TEST_CASE("incomplete factors without anything left out are whole factors of each rank's own block") {
  for (const int block : {1, 2, 3, 5, 6})
    for (const int reach : {1, 50}) { // one chain and a full matrix: no fill
      CAPTURE(block);
      CAPTURE(reach);
      const MatHandle matrix = chain(block, 30, reach);
      Mat own = nullptr;
      AMT_PETSC(MatGetDiagonalBlock(matrix, &own));
      const auto pc = factors(matrix);
      const VecHandle x = made_up(own, 0.7);
      VecHandle load = same_layout(x), image, found;
      AMT_PETSC(MatMult(own, x, load));
      AMT_PETSC(MatCreateVecs(matrix, found.put(), image.put()));
      {
        const VecReader from(load);
        VecArray to(image);
        for (PetscInt i = 0; i < to.size(); ++i)
          to[i] = from[i];
      }
      AMT_PETSC(PCApply(pc, image, found));
      const VecReader solution(found), expected(x);
      double error = 0.0;
      for (PetscInt i = 0; i < expected.size(); ++i)
        error = std::max(error, std::abs(solution[i] - expected[i]));
      CHECK(error < 1e-5);
      CHECK(asymmetry(matrix, [&](Vec in, Vec out) { AMT_PETSC(PCApply(pc, in, out)); }) < 1e-13);
    }
}

TEST_CASE("incomplete factors with pieces left out are those of PETSc") {
  MatHandle matrix; // a plate of 12 x 12 nodes, on every rank
  constexpr int side = 12, block = 3;
  AMT_PETSC(MatCreateSeqAIJ(PETSC_COMM_SELF, side * side * block, side * side * block, 27, nullptr, matrix.put()));
  AMT_PETSC(MatSetBlockSize(matrix, block));
  for (int a = 0; a < side * side; ++a)
    for (int b = 0; b < side * side; ++b) {
      if (std::abs(a / side - b / side) > 1 || std::abs(a % side - b % side) > 1) continue;
      for (int r = 0; r < block; ++r)
        for (int c = 0; c < block; ++c) {
          const int i = a * block + r, j = b * block + c;
          const double value = i == j ? 9.0 : -0.3 * (1.0 + std::cos(1.0 * (i + j)) * std::cos(1.0 * (i - j)));
          AMT_PETSC(MatSetValue(matrix, i, j, value, INSERT_VALUES));
        }
    }
  AMT_PETSC(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  AMT_PETSC(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  const auto ours = factors(matrix);
  Handle<PC, PCDestroy> theirs;
  AMT_PETSC(PCCreate(PETSC_COMM_SELF, theirs.put()));
  AMT_PETSC(PCSetOperators(theirs, matrix, matrix));
  AMT_PETSC(PCSetType(theirs, PCICC));
  AMT_PETSC(PCFactorSetMatOrderingType(theirs, MATORDERINGRCM));
  AMT_PETSC(PCSetUp(theirs));
  const VecHandle load = made_up(matrix, 0.7);
  VecHandle found = same_layout(load), expected = same_layout(load), image = same_layout(load);
  AMT_PETSC(PCApply(ours, load, found));
  AMT_PETSC(PCApply(theirs, load, expected));
  CHECK(difference(found, expected) < 1e-5);
  AMT_PETSC(MatMult(matrix, found, image));
  CHECK(difference(image, load) > 1e-3); // incomplete indeed
}

TEST_CASE("factors of a matrix that is not positive definite are shifted until they are") {
  const MatHandle matrix = chain(3, 30, 2, 0.9);
  Mat own = nullptr;
  AMT_PETSC(MatGetDiagonalBlock(matrix, &own));
  SinglePrecisionFactors shifted(own, 3);
  REQUIRE(shifted.factorize(own));
  CHECK(shifted.shift() > 0.0);
  const VecHandle load = made_up(own, 0.7);
  VecHandle found = same_layout(load);
  PetscScalar energy = 0.0;
  {
    const VecReader from(load);
    VecArray to(found);
    shifted.solve(from.data(), to.data());
  }
  AMT_PETSC(VecDot(load, found, &energy));
  CHECK(energy > 0.0);
}

TEST_CASE(
    "multigrid with single precision takes the iterations of multigrid, also for a tangent that it was not made for") {
  const MatHandle matrix = chain(3, 400, 2, 0.2);
  AMT_PETSC(MatSetOption(matrix, MAT_SPD, PETSC_TRUE));
  const VecHandle load = made_up(matrix, 0.7);
  std::vector<VecHandle> found;
  std::vector<PetscInt> iterations;
  for (const bool is_light : {false, true}) {
    AMT_PETSC(PetscOptionsSetValue(nullptr, "-mg_levels_pc_type", is_light ? pc_icc_single : PCJACOBI));
    register_icc_single();
    KspHandle solver;
    std::optional<LightMultigrid> light;
    PC pc = nullptr;
    AMT_PETSC(KSPCreate(PETSC_COMM_WORLD, solver.put()));
    AMT_PETSC(KSPSetType(solver, KSPCG));
    AMT_PETSC(KSPSetOperators(solver, matrix, matrix));
    AMT_PETSC(KSPSetTolerances(solver, 1e-11, PETSC_DEFAULT, PETSC_DEFAULT, 200));
    AMT_PETSC(KSPGetPC(solver, &pc));
    AMT_PETSC(PCSetType(pc, PCGAMG));
    REQUIRE(LightMultigrid::applies_to(solver));
    if (is_light) light.emplace(solver);
    for (const double scale : {1.0, 1.25}) {
      PetscInt count = 0;
      KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
      AMT_PETSC(MatScale(matrix, scale));
      found.push_back(same_layout(load));
      AMT_PETSC(KSPSolve(solver, load, found.back()));
      AMT_PETSC(KSPGetConvergedReason(solver, &reason));
      AMT_PETSC(KSPGetIterationNumber(solver, &count));
      CHECK(reason > 0);
      iterations.push_back(count);
      AMT_PETSC(KSPSetReusePreconditioner(solver, PETSC_TRUE));
      AMT_PETSC(MatScale(matrix, 1.0 / scale));
    }
  }
  AMT_PETSC(PetscOptionsClearValue(nullptr, "-mg_levels_pc_type"));
  CHECK(difference(found[2], found[0]) < 1e-9);
  CHECK(difference(found[3], found[1]) < 1e-9);
  CHECK(iterations[2] <= iterations[0]); // factors smooth better than the diagonal
  CHECK(iterations[3] <= iterations[2] + 1);
}

TEST_CASE("factors of what is not a number do not exist, and the PC says so") {
  MatHandle matrix = chain(3, 30, 1);
  AMT_PETSC(MatScale(matrix, std::nan("")));
  PCFailedReason reason = PC_NOERROR;
  AMT_PETSC(PCGetFailedReason(factors(matrix), &reason));
  CHECK(reason == PC_FACTOR_NUMERIC_ZEROPIVOT);
}
