// Adds square blocks to a matrix whose places exist. MatSetValues looks for each column of each row; here the place
// found in one row is tried first in the next, and right for the rows of one node, so that most entries are not
// searched for.
#pragma once

#include "base/petsc.hpp"

#include <span>
#include <vector>

namespace amontons {

class BlockAdder {
 public:
  /// AIJ. Blocks go straight to their places when the matrix has been assembled, else through MatSetValues. The matrix
  /// must outlive this, be assembled by the caller afterwards, and get values from nowhere else in between.
  explicit BlockAdder(Mat matrix);
  ~BlockAdder();
  BlockAdder(const BlockAdder&) = delete;
  BlockAdder& operator=(const BlockAdder&) = delete;
  /// Adds block (row by row) at these global equations; negative ones are left out. Equations of other ranks and places
  /// that do not exist are left to MatSetValues.
  void add(std::span<const PetscInt> equations, std::span<const double> block);

 private:
  bool add_in_place(std::span<const PetscInt> equations, std::span<const double> block);

  Mat matrix_;
  Mat inside_ = nullptr; // this rank's rows and columns; null when places are not known
  PetscInt first_ = 0, rows_ = 0;
  const PetscInt *begin_ = nullptr, *columns_ = nullptr;
  double* values_ = nullptr;
  std::vector<PetscInt> offsets_; // of the block's columns in the last row
  std::vector<PetscInt> places_;  // of all of the block's values
};

} // namespace amontons
