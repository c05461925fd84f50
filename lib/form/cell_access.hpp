// From the arrays of a mesh to those of the cell kernels and back. A detail of the solid forms.
#pragma once

#include "fe/dof_layout.hpp"
#include "form/cell_kernel.hpp"
#include "form/point_states.hpp"
#include "material/small_law.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

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

/// The virgin states of all points of a mesh, with a law for each of its bodies.
template <class Law>
PointStates virgin_states(const Mesh& mesh, Space space, const std::vector<Law>& laws) {
  PointStates result;
  for (const auto& block : mesh.blocks) {
    auto& states = result.blocks.emplace_back();
    states.points = cell_rule(block.type, space).table->rule->size();
    states.components = static_cast<int>(state_names(laws[block.body]).size());
    if (!states.has_memory()) continue;
    std::vector<double> virgin(states.components);
    initial_state(laws[block.body], virgin);
    const std::size_t points = std::size_t(block.size()) * states.points;
    for (std::size_t p = 0; p < points; ++p)
      states.states.insert(states.states.end(), virgin.begin(), virgin.end());
    states.dissipated.assign(points, 0.0);
  }
  return result;
}

/// The weights of the points of a batch, in `weights`.
template <class Batch>
void find_weights(const Batch& batch, std::vector<double>& weights) {
  weights.clear();
  for (const auto& cell : batch.cells)
    for (int q = 0; q < cell.size; ++q)
      weights.push_back(cell.points[q].weight);
}

/// Σ w density over a batch.
template <class Batch>
double weighted(const Batch& batch, std::span<const double> density) {
  double sum = 0;
  std::size_t point = 0;
  for (const auto& cell : batch.cells)
    for (int q = 0; q < cell.size; ++q)
      sum += cell.points[q].weight * density[point++];
  return sum;
}

/// What Residual::fail is told.
inline std::string failure_text(const Mesh& mesh, const CellBlock& block, PointOutcome outcome) {
  return "in body '" + mesh.bodies[block.body] + "' " + std::string(outcome_text(outcome));
}

} // namespace amontons
