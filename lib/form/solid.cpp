#include "form/solid.hpp"

#include "base/error.hpp"
#include "fe/node_numbering.hpp"
#include "form/cell_access.hpp"
#include "form/cell_kernel.hpp"

#include <numeric>
#include <string>

namespace amontons {
namespace {

/// The corner functions of an element at the points of its cell rule.
const Tabulation& corner_table(ElementType type, Space space) {
  return tabulation(linear_element(type), cell_degree(type, space));
}

/// Adds w N_a times a field of a batch at the corner nodes of its cells.
void add_projection(const PointBatch& batch, const Tabulation& corners, std::span<const double> field,
                    std::size_t components, std::span<double> nodal) {
  const int points = batch.table->rule->size();
  std::size_t point = 0;
  for (std::int32_t c = 0; c < batch.num_cells; ++c) {
    const auto nodes = batch.block->cell(batch.first_cell + c);
    for (int q = 0; q < points; ++q, ++point)
      for (int a = 0; a < num_nodes(corners.type); ++a) {
        const double weight = batch.weights[point] * corners.value(q)[a];
        for (std::size_t i = 0; i < components; ++i)
          nodal[nodes[a] * components + i] += weight * field[point * components + i];
      }
  }
}

/// Sums each of the interleaved components of a nodal array over the ranks that know a node. Collective.
void sum_over_ranks(const NodeSpace& nodes, std::size_t components, std::vector<double>& nodal) {
  std::vector<std::vector<double>> component(1, std::vector<double>(nodal.size() / components));
  for (std::size_t i = 0; i < components; ++i) {
    for (std::size_t node = 0; node < component[0].size(); ++node)
      component[0][node] = nodal[node * components + i];
    const VecHandle sum = nodes.new_vector();
    nodes.add(component, sum);
    nodes.gather(sum, component);
    for (std::size_t node = 0; node < component[0].size(); ++node)
      nodal[node * components + i] = component[0][node];
  }
}

/// Values at the nodes behind the corners of the cells of a block, interpolated from the corners.
void interpolate_middles(const CellBlock& block, std::size_t components, std::span<double> nodal) {
  const ElementType corner_type = linear_element(block.type);
  const int corners = num_nodes(corner_type), dim = element_dim(block.type);
  std::vector<double> values(corners);
  for (int m = corners; m < num_nodes(block.type); ++m) {
    shape_values(corner_type, reference_nodes(block.type).subspan(std::size_t(m) * dim, dim), values);
    for (std::int32_t c = 0; c < block.size(); ++c) {
      const auto nodes = block.cell(c);
      for (std::size_t i = 0; i < components; ++i) {
        double sum = 0;
        for (int a = 0; a < corners; ++a)
          sum += values[a] * nodal[nodes[a] * components + i];
        nodal[nodes[m] * components + i] = sum;
      }
    }
  }
}

void check_block(const Mesh& mesh, const CellBlock& block, Space space) {
  with_kernel(block.type, space, [&](auto kernel) {
    using Kernel = decltype(kernel);
    typename Kernel::Cell cell;
    const CellRule rule = cell_rule(block.type, space);
    for (std::int32_t c = 0; c < block.size(); ++c) {
      const typename Kernel::Nodal X = gather<Kernel>(mesh.coordinates, block.cell(c));
      if (Kernel::geometry(rule, X, cell)) continue;
      std::string place;
      for (int i = 0; i < Kernel::dim; ++i)
        place += (i ? ", " : "") + std::to_string(X[i]);
      throw UserError(
          "a cell of body '" + mesh.bodies[block.body] + "' near (" + place + ") is inverted or has no volume" +
          (Kernel::axisymmetric ? " or does not lie at x > 0 (x is the radius in axisymmetric space)" : "") +
          "; mend the mesh there.");
    }
  });
}

} // namespace

double SolidForm::dissipated_energy(const State& state) {
  double total = 0;
  for_each_new_states(state, [&](const NewPointStates& next) {
    const auto before = states_.blocks[next.block].dissipated_at(next.first_point, next.weights.size());
    for (std::size_t p = 0; p < next.weights.size(); ++p)
      total += next.weights[p] * (before[p] + next.dissipated[p]);
  });
  return total;
}

void SolidForm::commit(const State& state) {
  PointStates accepted = states_;
  accepted.time = state.time;
  for_each_new_states(state, [&](const NewPointStates& next) {
    accepted.blocks[next.block].accept(next.first_point, next.states, next.dissipated);
  });
  states_ = std::move(accepted);
}

void check_cells(const Mesh& mesh, Space space) {
  together(mesh.comm, [&] {
    for (const auto& block : mesh.blocks)
      check_block(mesh, block, space);
  });
}

void couple_cells(const DofLayout& layout, Coupling& coupling) {
  const int dim = layout.dim();
  std::vector<PetscInt> equations;
  for (const auto& block : layout.mesh().blocks)
    for (std::int32_t c = 0; c < block.size(); ++c) {
      equations.clear();
      for (const auto node : block.cell(c))
        for (int i = 0; i < dim; ++i)
          equations.push_back(layout.equation(node, i));
      coupling.add(equations);
    }
}

NodalStress nodal_stress(SolidForm& solid, const Mesh& mesh, const State& state) {
  const std::size_t size = mesh.num_local(), components = mesh.dim == 2 ? strain_size<2> : strain_size<3>,
                    num_scalars = solid.scalar_names().size();
  NodalStress result{.stress = std::vector<double>(size * components),
                     .strain = std::vector<double>(size * components),
                     .scalars = {}};
  std::vector<double> volume(size), scalars(size * num_scalars);
  solid.for_each_batch(state, [&](const PointBatch& batch) {
    const Tabulation& corners = corner_table(batch.block->type, solid.space());
    add_projection(batch, corners, std::vector<double>(batch.weights.size(), 1.0), 1, volume);
    add_projection(batch, corners, batch.stress, components, result.stress);
    add_projection(batch, corners, batch.strain, components, result.strain);
    add_projection(batch, corners, batch.scalars, num_scalars, scalars);
  });
  std::vector<std::int32_t> all(size);
  std::iota(all.begin(), all.end(), 0);
  const NodeSpace nodes(mesh, {{"node", std::move(all)}});
  sum_over_ranks(nodes, 1, volume);
  const auto finish = [&](std::size_t width, std::vector<double>& field) {
    sum_over_ranks(nodes, width, field);
    for (std::size_t node = 0; node < size; ++node)
      for (std::size_t i = 0; i < width && volume[node] > 0; ++i)
        field[node * width + i] /= volume[node];
    for (const auto& block : mesh.blocks)
      interpolate_middles(block, width, field);
  };
  finish(components, result.stress);
  finish(components, result.strain);
  if (num_scalars > 0) finish(num_scalars, scalars);
  for (std::size_t k = 0; k < num_scalars; ++k) {
    auto& field = result.scalars.emplace_back(size);
    for (std::size_t node = 0; node < size; ++node)
      field[node] = scalars[node * num_scalars + k];
  }
  return result;
}

} // namespace amontons
