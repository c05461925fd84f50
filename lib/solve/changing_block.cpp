#include "solve/changing_block.hpp"

#include <algorithm>
#include <numeric>

namespace amontons {

namespace {

VecHandle new_vector(std::size_t size) {
  VecHandle vector;
  AMT_PETSC(VecCreateSeq(PETSC_COMM_SELF, static_cast<PetscInt>(size), vector.put()));
  return vector;
}

/// Factorizes a dense matrix in place, with partial pivoting; false if it is singular, which PETSc takes for an error.
bool factorize_in_place(Mat matrix) {
  MatFactorInfo info;
  AMT_PETSC(MatFactorInfoInitialize(&info));
  AMT_PETSC(PetscPushErrorHandler(PetscReturnErrorHandler, nullptr));
  const PetscErrorCode code = MatLUFactor(matrix, nullptr, nullptr, &info);
  AMT_PETSC(PetscPopErrorHandler());
  if (code == PETSC_ERR_MAT_LU_ZRPVT) return false;
  AMT_PETSC(code);
  return true;
}

void gather(std::span<const double> all, const std::vector<int>& places, Vec part) {
  VecArray values(part);
  for (std::size_t i = 0; i < places.size(); ++i)
    values[static_cast<PetscInt>(i)] = all[places[i]];
}

void scatter(Vec part, const std::vector<int>& places, std::span<double> all) {
  const VecReader values(part);
  for (std::size_t i = 0; i < places.size(); ++i)
    all[places[i]] = values[static_cast<PetscInt>(i)];
}

} // namespace

ChangingBlock::ChangingBlock(std::span<const double> reference, int size)
    : reference_(reference), size_(size), place_(size, -1) {}

bool ChangingBlock::covers(std::span<const Change> changes) const {
  return is_ready_ && std::all_of(changes.begin(), changes.end(), [this](const Change& change) {
           return place_[change.row] >= 0 && place_[change.column] >= 0;
         });
}

MatHandle ChangingBlock::part(const std::vector<int>& rows, const std::vector<int>& columns) const {
  MatHandle matrix;
  const auto height = static_cast<PetscInt>(rows.size());
  AMT_PETSC(MatCreateSeqDense(PETSC_COMM_SELF, height, static_cast<PetscInt>(columns.size()), nullptr, matrix.put()));
  double* values = nullptr;
  AMT_PETSC(MatDenseGetArrayWrite(matrix, &values));
  for (std::size_t j = 0; j < columns.size(); ++j)
    for (std::size_t i = 0; i < rows.size(); ++i)
      values[j * rows.size() + i] = reference_[std::size_t(columns[j]) * size_ + rows[i]];
  AMT_PETSC(MatDenseRestoreArrayWrite(matrix, &values));
  return matrix;
}

bool ChangingBlock::set_changing(std::vector<int> changing) {
  changing_ = std::move(changing);
  std::fill(place_.begin(), place_.end(), -1);
  for (std::size_t i = 0; i < changing_.size(); ++i)
    place_[changing_[i]] = static_cast<int>(i);
  steady_.clear();
  for (int i = 0; i < size_; ++i)
    if (place_[i] < 0) steady_.push_back(i);

  right_steady_ = new_vector(steady_.size());
  steady_part_ = new_vector(steady_.size());
  right_changing_ = new_vector(changing_.size());
  changing_part_ = new_vector(changing_.size());
  condensed_ = part(changing_, changing_);
  if (!steady_.empty()) steady_factor_ = part(steady_, steady_);
  is_ready_ = steady_.empty() || factorize_in_place(steady_factor_);
  if (!is_ready_ || steady_.empty() || changing_.empty()) return is_ready_;
  from_steady_ = part(changing_, steady_);
  const MatHandle coupling = part(steady_, changing_);
  AMT_PETSC(MatDuplicate(coupling, MAT_DO_NOT_COPY_VALUES, to_steady_.put()));
  AMT_PETSC(MatMatSolve(steady_factor_, coupling, to_steady_));
  MatHandle product;
  AMT_PETSC(MatMatMult(from_steady_, to_steady_, MAT_INITIAL_MATRIX, PETSC_DEFAULT, product.put()));
  AMT_PETSC(MatAXPY(condensed_, -1.0, product, SAME_NONZERO_PATTERN));
  return true;
}

bool ChangingBlock::factorize(std::span<const Change> changes) {
  if (changing_.empty()) return true;
  AMT_PETSC(MatDuplicate(condensed_, MAT_COPY_VALUES, factor_.put()));
  double* values = nullptr;
  AMT_PETSC(MatDenseGetArray(factor_, &values));
  for (const auto& change : changes)
    values[place_[change.column] * changing_.size() + place_[change.row]] += change.value;
  AMT_PETSC(MatDenseRestoreArray(factor_, &values));
  return factorize_in_place(factor_);
}

void ChangingBlock::solve(std::span<double> vector) const {
  gather(vector, changing_, right_changing_);
  if (!steady_.empty()) {
    gather(vector, steady_, right_steady_);
    AMT_PETSC(MatSolve(steady_factor_, right_steady_, steady_part_));
  }
  if (!changing_.empty()) {
    if (!steady_.empty()) {
      AMT_PETSC(MatMult(from_steady_, steady_part_, changing_part_));
      AMT_PETSC(VecAXPY(right_changing_, -1.0, changing_part_));
    }
    AMT_PETSC(MatSolve(factor_, right_changing_, changing_part_));
    if (!steady_.empty()) {
      AMT_PETSC(MatMult(to_steady_, changing_part_, right_steady_));
      AMT_PETSC(VecAXPY(steady_part_, -1.0, right_steady_));
    }
  }
  scatter(steady_part_, steady_, vector);
  scatter(changing_part_, changing_, vector);
}

std::vector<double> ChangingBlock::times_reference(std::span<const double> vector) const {
  std::vector<double> result(size_, 0.0);
  for (int j = 0; j < size_; ++j)
    for (int i = 0; i < size_; ++i)
      result[i] += reference_[std::size_t(j) * size_ + i] * vector[j];
  return result;
}

} // namespace amontons
