// A sparse matrix and its incomplete Cholesky factors with numbers of single precision, for multigrid's smoother: what
// that does waits for memory, and single precision is as good as it needs. Sums are made in double precision, so both
// are linear and symmetric like what they stand for. Knows matrices of PETSc, no solvers and no other ranks.
#pragma once

#include "base/petsc.hpp"

#include <cstdint>
#include <vector>

namespace amontons {

/// Rows of dense blocks: block row i has the block columns column[start[i]] to column[start[i+1] - 1], ascending.
struct BlockRows {
  int block = 1; // equations along a block's side
  std::vector<std::int32_t> start, column;
  std::int32_t size() const { return static_cast<std::int32_t>(start.size()) - 1; }
};

/// Pattern of a sequential AIJ matrix in blocks of `block`, or of 1 where these would be too empty.
BlockRows block_rows(Mat matrix, int block);

/// A copy of a sequential AIJ matrix.
class SinglePrecisionMatrix {
 public:
  SinglePrecisionMatrix(Mat matrix, int block);
  /// The numbers anew, for the same pattern.
  void copy_numbers(Mat matrix);
  /// y = A x, or y += A x.
  void multiply(const double* x, double* y) const;
  void multiply_add(const double* x, double* y) const;

 private:
  BlockRows rows_;
  double unit_;                // of the numbers, in the matrix's
  std::vector<float> numbers_; // of each block column by column
};

/// (L + D) D⁻¹ (L + D)ᵀ with D of blocks and the pattern of a symmetric positive definite sequential AIJ matrix, in
/// reversed Cuthill-McKee order. Where pivots are not positive, all of it is made again with a larger diagonal.
/// Source: T. A. Manteuffel, Math. Comp. 34 (1980) 473 (shifted incomplete factorizations).
class SinglePrecisionFactors {
 public:
  SinglePrecisionFactors(Mat matrix, int block);
  /// For the same pattern. False if there are no factors, whatever the shift: something in it is not a number.
  bool factorize(Mat matrix);
  /// x = ((L + D) D⁻¹ (L + D)ᵀ)⁻¹ b.
  void solve(const double* b, double* x) const;
  /// What was added to the diagonal, as a part of it.
  double shift() const { return shift_; }

 private:
  template <int B>
  bool try_to_factorize(Mat matrix, double shift);

  double unit_;                      // of the numbers, in the matrix's
  BlockRows lower_;                  // of L, rows and columns in the new order
  std::vector<std::int32_t> source_; // new block row -> old one
  std::vector<std::int32_t> target_; // and back
  std::vector<float> numbers_;       // of L, of each block row by row
  std::vector<float> inverse_;       // of D
  mutable std::vector<double> work_;
  double shift_ = 0.0;
};

} // namespace amontons
