// Recovered minus computed stresses and strains of a cell, at points where their products are integrated. For
// lib/accuracy only.
#pragma once

#include "accuracy/patch_recovery.hpp"

#include <map>

namespace amontons::accuracy {

/// Where the error of a cell is integrated: a rule that sees polynomials of twice the element's order. That of the
/// stiffness does, except in simplices, whose points are just those where the stress is best.
struct ErrorRule {
  /// `own`: the element at the points of the stiffness.
  explicit ErrorRule(const Tabulation& own);

  const Tabulation* table;      // the element's functions, for places
  Eigen::MatrixXd corners;      // functions of order 1 at the points
  Eigen::MatrixXd continuation; // from values at the points of the stiffness to values here; empty: the same points
};

/// Strain and stress side by side, one point of the rule a row.
struct CellDifference {
  PointRows error;     // recovered minus computed
  PointRows fields;    // computed
  PointColumn volumes; // that the points stand for; on curved sides to first order
};
CellDifference difference(const PatchRecovery& recovery, const ErrorRule& rule, const Mesh& mesh,
                          const PointBatch& batch, std::int32_t c);

/// Dilatation of the nodes' displacements less that of the strains, at the points of the stiffness: what cells with a
/// mean dilatation leave out (quadrilaterals and hexahedra, lib/form/cell_kernel.hpp); zero in all others.
PointColumn left_out_dilatation(Space space, const Mesh& mesh, const PointBatch& batch, std::int32_t c,
                                std::span<const double> displacement);

/// Numbers the cells of this rank block by block as in Mesh::blocks.
class CellIndex {
 public:
  explicit CellIndex(const Mesh& mesh) {
    for (const auto& block : mesh.blocks) {
      first_[&block] = size_;
      size_ += static_cast<std::size_t>(block.size());
    }
  }
  std::size_t size() const { return size_; }
  /// Of cell `c` of a batch.
  std::size_t operator()(const PointBatch& batch, std::int32_t c) const {
    return first_.at(batch.block) + static_cast<std::size_t>(batch.first_cell + c);
  }

 private:
  std::map<const CellBlock*, std::size_t> first_;
  std::size_t size_ = 0;
};

} // namespace amontons::accuracy
