// The pattern of the tangent before the matrix exists: which blocks of unknowns couple, collected on every rank, rows
// sent to their owners, then exact preallocation.
#pragma once

#include "form/form.hpp"

#include <unordered_map>
#include <vector>

namespace amontons {

class Sparsity : public Coupling {
 public:
  explicit Sparsity(const DofLayout& layout);
  void add(std::span<const PetscInt> equations) override;
  /// Sends rows to their owners and preallocates `matrix` (AIJ, sizes set). Collective.
  void preallocate(Mat matrix);
  /// Equations of other ranks that were named, ascending. Valid before preallocate().
  std::vector<PetscInt> foreign_equations() const;

 private:
  using Row = std::vector<PetscInt>; // ascending block numbers
  void insert(Row& row, const std::vector<PetscInt>& blocks);
  void exchange();

  const DofLayout& layout_;
  std::vector<Row> rows_;                     // owned blocks
  std::unordered_map<PetscInt, Row> foreign_; // rows of blocks of other ranks
  std::vector<PetscInt> blocks_, merged_;     // scratch
};

} // namespace amontons
