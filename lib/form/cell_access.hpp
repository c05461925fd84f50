// From the arrays of a mesh to those of the cell kernels and back. A detail of the solid forms.
#pragma once

#include "fe/dof_layout.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace amontons {

/// Cells whose points are handed to a law in one call.
template <class Kernel>
constexpr std::int32_t batch_cells = std::max(1, 64 / Kernel::max_points);

/// The numbers of a cell's nodes in an array of nodal vectors; none for the bubble.
template <class Kernel>
typename Kernel::Nodal gather(std::span<const double> nodal, std::span<const std::int32_t> nodes) {
  typename Kernel::Nodal result{};
  for (int a = 0; a < Kernel::nodes; ++a)
    for (int i = 0; i < Kernel::dim; ++i)
      result[a * Kernel::dim + i] = nodal[std::size_t(nodes[a]) * Kernel::dim + i];
  return result;
}

/// Adds the forces on a cell's nodes to an array of nodal vectors.
template <class Kernel>
void scatter(const typename Kernel::Nodal& force, std::span<const std::int32_t> nodes, std::span<double> nodal) {
  for (int a = 0; a < Kernel::nodes; ++a)
    for (int i = 0; i < Kernel::dim; ++i)
      nodal[std::size_t(nodes[a]) * Kernel::dim + i] += force[a * Kernel::dim + i];
}

/// The equations of the nodes of a cell.
template <class Kernel>
std::array<PetscInt, Kernel::node_unknowns> cell_equations(const DofLayout& layout,
                                                           std::span<const std::int32_t> nodes) {
  std::array<PetscInt, Kernel::node_unknowns> equations;
  for (int a = 0; a < Kernel::nodes; ++a)
    for (int i = 0; i < Kernel::dim; ++i)
      equations[a * Kernel::dim + i] = layout.equation(nodes[a], i);
  return equations;
}

} // namespace amontons
