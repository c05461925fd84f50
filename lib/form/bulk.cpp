#include "form/bulk.hpp"

#include "base/error.hpp"
#include "fe/node_numbering.hpp"
#include "form/cell_kernel.hpp"

#include <algorithm>
#include <numeric>
#include <string>

namespace amontons {
namespace {

/// Cells whose points are handed to a law in one call.
template <class Kernel>
constexpr std::int32_t batch_cells = std::max(1, 64 / Kernel::max_points);

/// The numbers of a cell's nodes in an array of nodal vectors.
template <class Kernel>
typename Kernel::Nodal gather(std::span<const double> nodal, std::span<const std::int32_t> nodes) {
  typename Kernel::Nodal result;
  for (int a = 0; a < Kernel::nodes; ++a)
    for (int i = 0; i < Kernel::dim; ++i)
      result[a * Kernel::dim + i] = nodal[std::size_t(nodes[a]) * Kernel::dim + i];
  return result;
}

template <class Kernel>
std::array<PetscInt, Kernel::unknowns> cell_equations(const DofLayout& layout, std::span<const std::int32_t> nodes) {
  std::array<PetscInt, Kernel::unknowns> equations;
  for (int a = 0; a < Kernel::nodes; ++a)
    for (int i = 0; i < Kernel::dim; ++i)
      equations[a * Kernel::dim + i] = layout.equation(nodes[a], i);
  return equations;
}

/// Geometry and strains of a batch of cells: calls work(first, cells, strain) for each batch of the block.
template <class Kernel, class Work>
void strain_batches(const Mesh& mesh, const CellBlock& block, const CellRule& rule,
                    std::span<const double> displacement, Work&& work) {
  std::vector<typename Kernel::Cell> cells(batch_cells<Kernel>);
  const int points = rule.table->rule->size();
  std::vector<double> strain(cells.size() * points * Kernel::components);
  for (std::int32_t first = 0; first < block.size(); first += batch_cells<Kernel>) {
    const std::int32_t count = std::min(batch_cells<Kernel>, block.size() - first);
    for (std::int32_t c = 0; c < count; ++c) {
      const auto nodes = block.cell(first + c);
      Kernel::geometry(rule, gather<Kernel>(mesh.coordinates, nodes), cells[c]);
      Kernel::strains(cells[c], gather<Kernel>(displacement, nodes), &strain[c * points * Kernel::components]);
    }
    work(first, std::span<const typename Kernel::Cell>(cells).first(count),
         std::span(strain).first(std::size_t(count) * points * Kernel::components));
  }
}

template <class Kernel>
void add_block_forces(const Mesh& mesh, const CellBlock& block, const CellRule& rule, const BulkLaw& law,
                      std::span<const double> displacement, std::span<double> forces) {
  std::vector<double> stress;
  strain_batches<Kernel>(mesh, block, rule, displacement, [&](std::int32_t first, auto cells, auto strain) {
    stress.resize(strain.size());
    law.stress(strain, stress);
    const std::size_t stride = strain.size() / cells.size();
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const typename Kernel::Nodal force = Kernel::forces(cells[c], &stress[c * stride]);
      const auto nodes = block.cell(first + static_cast<std::int32_t>(c));
      for (int a = 0; a < Kernel::nodes; ++a)
        for (int i = 0; i < Kernel::dim; ++i)
          forces[std::size_t(nodes[a]) * Kernel::dim + i] += force[a * Kernel::dim + i];
    }
  });
}

template <class Kernel>
void add_isotropic_stiffness(const DofLayout& layout, const CellBlock& block, const CellRule& rule, const Lame& lame,
                             Tangent& tangent) {
  typename Kernel::Cell cell;
  typename Kernel::Block K;
  for (std::int32_t c = 0; c < block.size(); ++c) {
    const auto nodes = block.cell(c);
    Kernel::geometry(rule, gather<Kernel>(layout.mesh().coordinates, nodes), cell);
    Kernel::isotropic_stiffness(cell, lame, K);
    tangent.add(cell_equations<Kernel>(layout, nodes), K);
  }
}

template <class Kernel>
void add_stiffness(const DofLayout& layout, const CellBlock& block, const CellRule& rule, const BulkLaw& law,
                   std::span<const double> displacement, Tangent& tangent) {
  typename Kernel::Block K;
  std::vector<double> moduli;
  strain_batches<Kernel>(layout.mesh(), block, rule, displacement, [&](std::int32_t first, auto cells, auto strain) {
    moduli.resize(strain.size() * Kernel::components);
    law.moduli(strain, moduli);
    const std::size_t stride = moduli.size() / cells.size();
    for (std::size_t c = 0; c < cells.size(); ++c) {
      Kernel::stiffness(cells[c], &moduli[c * stride], K);
      tangent.add(cell_equations<Kernel>(layout, block.cell(first + static_cast<std::int32_t>(c))), K);
    }
  });
}

/// The corner functions of an element at the points of its cell rule.
const Tabulation& corner_table(ElementType type, Space space) {
  return tabulation(linear_element(type), cell_degree(type, space));
}

/// Adds stress and strain times w N_a at the corner nodes of the cells of a batch, and w N_a itself to `volume`.
void add_projection(const PointBatch& batch, const Tabulation& corners, std::size_t components,
                    std::span<double> volume, std::span<double> stress, std::span<double> strain) {
  const int points = batch.table->rule->size();
  std::size_t point = 0;
  for (std::int32_t c = 0; c < batch.num_cells; ++c) {
    const auto nodes = batch.block->cell(batch.first_cell + c);
    for (int q = 0; q < points; ++q, ++point)
      for (int a = 0; a < num_nodes(corners.type); ++a) {
        const double weight = batch.weights[point] * corners.value(q)[a];
        const std::size_t node = nodes[a];
        volume[node] += weight;
        for (std::size_t i = 0; i < components; ++i) {
          stress[node * components + i] += weight * batch.stress[point * components + i];
          strain[node * components + i] += weight * batch.strain[point * components + i];
        }
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

} // namespace

BulkForm::BulkForm(const DofLayout& layout, Space space, std::vector<BulkLawPtr> laws)
    : layout_(layout), space_(space), laws_(std::move(laws)) {
  together(layout_.mesh().comm, [this] { check_cells(); });
}

void BulkForm::check_cells() const {
  const Mesh& mesh = layout_.mesh();
  for (const auto& block : mesh.blocks)
    with_kernel(block.type, space_, [&](auto kernel) {
      using Kernel = decltype(kernel);
      typename Kernel::Cell cell;
      const CellRule rule = cell_rule(block.type, space_);
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

void BulkForm::couple(Coupling& coupling) const {
  for (const auto& block : layout_.mesh().blocks)
    with_kernel(block.type, space_, [&](auto kernel) {
      for (std::int32_t c = 0; c < block.size(); ++c)
        coupling.add(cell_equations<decltype(kernel)>(layout_, block.cell(c)));
    });
}

void BulkForm::add_residual(const State& state, Residual& residual) {
  for (const auto& block : layout_.mesh().blocks)
    with_kernel(block.type, space_, [&](auto kernel) {
      add_block_forces<decltype(kernel)>(layout_.mesh(), block, cell_rule(block.type, space_), *laws_[block.body],
                                         state.displacement, residual.nodal());
    });
}

void BulkForm::add_tangent(const State& state, Tangent& tangent) {
  for (const auto& block : layout_.mesh().blocks)
    with_kernel(block.type, space_, [&](auto kernel) {
      const CellRule rule = cell_rule(block.type, space_);
      const BulkLaw& law = *laws_[block.body];
      if (const auto lame = law.constant_lame())
        add_isotropic_stiffness<decltype(kernel)>(layout_, block, rule, *lame, tangent);
      else
        add_stiffness<decltype(kernel)>(layout_, block, rule, law, state.displacement, tangent);
    });
}

bool BulkForm::tangent_is_constant() const {
  return std::all_of(laws_.begin(), laws_.end(), [](const auto& law) { return law->constant_lame().has_value(); });
}

double BulkForm::stored_energy(const State& state) {
  double total = 0;
  std::vector<double> density;
  for_each_batch(state.displacement, [&](const PointBatch& batch) {
    density.resize(batch.weights.size());
    laws_[batch.block->body]->energy(batch.strain, density);
    total += std::inner_product(density.begin(), density.end(), batch.weights.begin(), 0.0);
  });
  return total;
}

void BulkForm::for_each_batch(std::span<const double> displacement,
                              const std::function<void(const PointBatch&)>& visit) const {
  std::vector<double> stress, weights;
  for (const auto& block : layout_.mesh().blocks)
    with_kernel(block.type, space_, [&](auto kernel) {
      using Kernel = decltype(kernel);
      const CellRule rule = cell_rule(block.type, space_);
      strain_batches<Kernel>(
          layout_.mesh(), block, rule, displacement, [&](std::int32_t first, auto cells, auto strain) {
            stress.resize(strain.size());
            laws_[block.body]->stress(strain, stress);
            weights.clear();
            for (const auto& cell : cells)
              for (int q = 0; q < cell.size; ++q)
                weights.push_back(cell.points[q].weight);
            visit({&block, first, static_cast<std::int32_t>(cells.size()), rule.table, weights, strain, stress});
          });
    });
}

NodalStress BulkForm::nodal_stress(std::span<const double> displacement) const {
  const Mesh& mesh = layout_.mesh();
  const std::size_t size = mesh.num_local(), components = space_dim(space_) == 2 ? strain_size<2> : strain_size<3>;
  NodalStress result{std::vector<double>(size * components), std::vector<double>(size * components)};
  std::vector<double> volume(size);
  for_each_batch(displacement, [&](const PointBatch& batch) {
    std::vector<double> strain(batch.strain.begin(), batch.strain.end());
    laws_[batch.block->body]->complete_strain(strain);
    PointBatch complete = batch;
    complete.strain = strain;
    const Tabulation& corners = corner_table(batch.block->type, space_);
    add_projection(complete, corners, components, volume, result.stress, result.strain);
  });
  std::vector<std::int32_t> all(size);
  std::iota(all.begin(), all.end(), 0);
  const NodeSpace nodes(mesh, {{"node", std::move(all)}});
  sum_over_ranks(nodes, 1, volume);
  for (auto* const field : {&result.stress, &result.strain}) {
    sum_over_ranks(nodes, components, *field);
    for (std::size_t node = 0; node < size; ++node)
      for (std::size_t i = 0; i < components && volume[node] > 0; ++i)
        (*field)[node * components + i] /= volume[node];
    for (const auto& block : mesh.blocks)
      interpolate_middles(block, components, *field);
  }
  return result;
}

} // namespace amontons
