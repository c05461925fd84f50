#include "form/kept_rows.hpp"

#include <algorithm>

namespace amontons {

namespace {

/// The one or two sequential matrices that hold a rank's rows.
std::vector<Mat> parts_of(Mat matrix) {
  PetscBool is_parallel = PETSC_FALSE;
  AMT_PETSC(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(matrix), MATMPIAIJ, &is_parallel));
  if (!is_parallel) return {matrix};
  Mat inside = nullptr, outside = nullptr;
  AMT_PETSC(MatMPIAIJGetSeqAIJ(matrix, &inside, &outside, nullptr));
  return {inside, outside};
}

/// Calls visit(values of the row) for every row.
template <class Visit>
void for_each_row(Mat part, std::span<const PetscInt> rows, const Visit& visit) {
  PetscInt count = 0;
  const PetscInt *begin = nullptr, *columns = nullptr;
  PetscBool done = PETSC_FALSE;
  double* values = nullptr;
  AMT_PETSC(MatGetRowIJ(part, 0, PETSC_FALSE, PETSC_FALSE, &count, &begin, &columns, &done));
  AMT_PETSC(MatSeqAIJGetArray(part, &values));
  for (const PetscInt row : rows)
    visit(std::span(values + begin[row], values + begin[row + 1]));
  AMT_PETSC(MatSeqAIJRestoreArray(part, &values));
  AMT_PETSC(MatRestoreRowIJ(part, 0, PETSC_FALSE, PETSC_FALSE, &count, &begin, &columns, &done));
}

} // namespace

void KeptRows::store(Mat matrix, std::span<const PetscInt> rows) {
  PetscInt first = 0;
  AMT_PETSC(MatGetOwnershipRange(matrix, &first, nullptr));
  rows_.assign(rows.begin(), rows.end());
  for (PetscInt& row : rows_)
    row -= first;
  values_.clear();
  for (const Mat part : parts_of(matrix))
    for_each_row(part, rows_,
                 [&](std::span<const double> row) { values_.insert(values_.end(), row.begin(), row.end()); });
  values_.shrink_to_fit();
}

void KeptRows::restore(Mat matrix) const {
  auto from = values_.begin();
  for (const Mat part : parts_of(matrix))
    for_each_row(part, rows_, [&](std::span<double> row) {
      std::copy_n(from, row.size(), row.begin());
      from += static_cast<std::ptrdiff_t>(row.size());
    });
}

} // namespace amontons
