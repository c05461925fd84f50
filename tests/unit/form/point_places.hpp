// Where the quadrature points of a batch are.
#pragma once

#include "form/bulk.hpp"

#include <array>

namespace amontons::testing {

/// Reference place of point `p` of a batch.
inline std::array<double, 3> point_place(const Mesh& mesh, const PointBatch& batch, std::size_t p) {
  const auto points = static_cast<std::size_t>(batch.table->rule->size());
  const auto shape = batch.table->value(static_cast<int>(p % points));
  const auto nodes = batch.block->cell(batch.first_cell + static_cast<std::int32_t>(p / points));
  std::array<double, 3> x{};
  for (std::size_t a = 0; a < nodes.size(); ++a)
    for (int i = 0; i < mesh.dim; ++i)
      x[i] += shape[a] * mesh.position(nodes[a])[i];
  return x;
}

} // namespace amontons::testing
