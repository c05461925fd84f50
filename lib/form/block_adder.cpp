#include "form/block_adder.hpp"

#include <algorithm>

namespace amontons {

BlockAdder::BlockAdder(Mat matrix) : matrix_(matrix) {
  PetscBool is_assembled = PETSC_FALSE, is_sequential = PETSC_FALSE, is_parallel = PETSC_FALSE;
  AMT_PETSC(MatAssembled(matrix, &is_assembled));
  AMT_PETSC(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(matrix), MATSEQAIJ, &is_sequential));
  AMT_PETSC(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(matrix), MATMPIAIJ, &is_parallel));
  if (!is_assembled || !(is_sequential || is_parallel)) return;
  inside_ = matrix;
  if (is_parallel) AMT_PETSC(MatMPIAIJGetSeqAIJ(matrix, &inside_, nullptr, nullptr));
  AMT_PETSC(MatGetOwnershipRange(matrix, &first_, nullptr));
  PetscBool done = PETSC_FALSE;
  AMT_PETSC(MatGetRowIJ(inside_, 0, PETSC_FALSE, PETSC_FALSE, &rows_, &begin_, &columns_, &done));
  AMT_PETSC(MatSeqAIJGetArray(inside_, &values_));
}

BlockAdder::~BlockAdder() {
  if (!inside_) return;
  PetscBool done = PETSC_FALSE;
  PetscInt count = rows_;
  MatSeqAIJRestoreArray(inside_, &values_);
  MatRestoreRowIJ(inside_, 0, PETSC_FALSE, PETSC_FALSE, &count, &begin_, &columns_, &done);
}

bool BlockAdder::add_in_place(std::span<const PetscInt> equations, std::span<const double> block) {
  const std::size_t size = equations.size();
  for (const PetscInt equation : equations)
    if (equation >= 0 && (equation < first_ || equation >= first_ + rows_)) return false;
  offsets_.assign(size, 0);
  places_.assign(size * size, -1);
  for (std::size_t r = 0; r < size; ++r) {
    if (equations[r] < 0) continue;
    const PetscInt start = begin_[equations[r] - first_], length = begin_[equations[r] - first_ + 1] - start;
    const PetscInt* row = columns_ + start;
    for (std::size_t c = 0; c < size; ++c) {
      if (equations[c] < 0) continue;
      const PetscInt column = equations[c] - first_;
      PetscInt& offset = offsets_[c];
      if (offset >= length || row[offset] != column) {
        offset = static_cast<PetscInt>(std::lower_bound(row, row + length, column) - row);
        if (offset == length || row[offset] != column) return false;
      }
      places_[r * size + c] = start + offset;
    }
  }
  for (std::size_t i = 0; i < places_.size(); ++i)
    if (places_[i] >= 0) values_[places_[i]] += block[i];
  return true;
}

void BlockAdder::add(std::span<const PetscInt> equations, std::span<const double> block) {
  if (inside_ && add_in_place(equations, block)) return;
  const auto size = static_cast<PetscInt>(equations.size());
  AMT_PETSC(MatSetValues(matrix_, size, equations.data(), size, equations.data(), block.data(), ADD_VALUES));
}

} // namespace amontons
