#include "form/bulk.hpp"

#include "base/error.hpp"
#include "fe/node_numbering.hpp"
#include "form/cell_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

namespace amontons {
namespace {

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

/// The shear modulus G' of what no quadrature point sees of a bubble: E / 3, the right one where it matters.
double unseen_shear(const BulkLaw& law) { return law.stiffness() / 3; }

/// One block of cells with all that its strains and stresses depend on besides the displacement.
struct Material {
  const Mesh& mesh;
  const CellBlock& block;
  CellRule rule;
  const BulkLaw& law;
  std::span<const double> bubble_forces; // dim a cell; empty: none
};

/// Some consecutive cells of a block, deformed. `strain` and `stress` run as in PointBatch.
template <class Kernel>
struct Batch {
  std::int32_t first;
  std::vector<typename Kernel::Cell> cells;
  std::vector<typename Kernel::Nodal> displacements; // of the nodes and of the bubble
  std::vector<double> strain, stress, moduli;
  std::size_t stride() const { return strain.size() / cells.size(); }
};

/// Newton's method for the bubbles of a batch: one step for constant moduli.
constexpr int most_bubble_steps = 25;
constexpr double bubble_tolerance = 1e-10; // change of β relative to the displacements within the cell

/// One Newton step for the bubble of cell c of a batch. True when it was a small one. (Strains are changed in place, so
/// rounding in those of the nodes does not come back as a change of β.)
template <class Kernel>
bool improve_bubble(const Material& material, std::size_t c, Batch<Kernel>& batch) {
  constexpr int dim = Kernel::dim, first = Kernel::node_unknowns;
  const auto& cell = batch.cells[c];
  const std::size_t at = c * batch.stride();
  const double shear = unseen_shear(material.law);
  auto& u = batch.displacements[c];
  const auto lame = material.law.constant_lame();
  const auto stiffness = lame ? Kernel::bubble_stiffness(cell, *lame, shear)
                              : Kernel::bubble_stiffness(cell, &batch.moduli[at * Kernel::components], shear);
  const auto unseen = Kernel::unseen_stiffness(cell, shear);
  auto force = Kernel::template forces<Kernel::nodes, Kernel::functions>(cell, &batch.stress[at]);
  for (int i = 0; i < dim; ++i) {
    if (!material.bubble_forces.empty()) force[first + i] -= material.bubble_forces[(batch.first + c) * dim + i];
    for (int j = 0; j < dim; ++j)
      force[first + i] += unseen[i][j] * u[first + j];
  }
  const auto step = Kernel::solve(stiffness, force);
  Kernel::template add_strains<Kernel::nodes, Kernel::functions>(cell, step, &batch.strain[at]);
  double change = 0, scale = 0;
  for (int i = 0; i < dim; ++i) {
    u[first + i] += step[first + i];
    change = std::max(change, std::abs(step[first + i]));
    for (int a = 1; a < Kernel::functions; ++a)
      scale = std::max(scale, std::abs(u[a * dim + i] - (a < Kernel::nodes ? u[i] : 0.0)));
  }
  return change <= bubble_tolerance * scale;
}

/// Brings the bubbles of a batch into equilibrium with the nodes' displacements, and makes the stresses. Where the law
/// does not let them, the stresses are not numbers, and the solver tries a smaller increment.
template <class Kernel>
void relax_bubbles(const Material& material, Batch<Kernel>& batch) {
  const bool linear = material.law.constant_lame().has_value();
  bool done = false;
  for (int step = 0; step < most_bubble_steps && !done; ++step) {
    material.law.stress(batch.strain, batch.stress);
    if (!linear) {
      batch.moduli.resize(batch.strain.size() * Kernel::components);
      material.law.moduli(batch.strain, batch.moduli);
    }
    done = true;
    for (std::size_t c = 0; c < batch.cells.size(); ++c)
      done = improve_bubble(material, c, batch) && done;
    done = done || linear;
  }
  material.law.stress(batch.strain, batch.stress);
  if (!done) std::fill(batch.stress.begin(), batch.stress.end(), std::numeric_limits<double>::quiet_NaN());
}

/// Geometry, strains and stresses batch by batch: calls work(batch) for each batch of the block.
template <class Kernel, class Work>
void each_batch(const Material& material, std::span<const double> displacement, Work&& work) {
  const CellBlock& block = material.block;
  const auto points = static_cast<std::size_t>(material.rule.table->rule->size());
  Batch<Kernel> batch;
  for (batch.first = 0; batch.first < block.size(); batch.first += batch_cells<Kernel>) {
    const std::size_t count = std::min(batch_cells<Kernel>, block.size() - batch.first);
    batch.cells.resize(count);
    batch.displacements.resize(count);
    batch.strain.assign(count * points * Kernel::components, 0.0);
    batch.stress.resize(batch.strain.size());
    for (std::size_t c = 0; c < count; ++c) {
      const auto nodes = block.cell(batch.first + static_cast<std::int32_t>(c));
      Kernel::geometry(material.rule, gather<Kernel>(material.mesh.coordinates, nodes), batch.cells[c]);
      batch.displacements[c] = gather<Kernel>(displacement, nodes);
      Kernel::template add_strains<0, Kernel::nodes>(batch.cells[c], batch.displacements[c],
                                                     &batch.strain[c * batch.stride()]);
    }
    if constexpr (Kernel::has_bubble)
      relax_bubbles(material, batch);
    else
      material.law.stress(batch.strain, batch.stress);
    work(batch);
  }
}

template <class Kernel>
void add_block_forces(const Material& material, std::span<const double> displacement, std::span<double> forces) {
  each_batch<Kernel>(material, displacement, [&](const Batch<Kernel>& batch) {
    for (std::size_t c = 0; c < batch.cells.size(); ++c) {
      const auto force = Kernel::template forces<0, Kernel::nodes>(batch.cells[c], &batch.stress[c * batch.stride()]);
      const auto nodes = material.block.cell(batch.first + static_cast<std::int32_t>(c));
      for (int a = 0; a < Kernel::nodes; ++a)
        for (int i = 0; i < Kernel::dim; ++i)
          forces[std::size_t(nodes[a]) * Kernel::dim + i] += force[a * Kernel::dim + i];
    }
  });
}

/// Adds the stiffness of one cell, its bubble condensed.
template <class Kernel>
void add_cell_stiffness(const DofLayout& layout, const Material& material, std::int32_t c,
                        const typename Kernel::Cell& cell, const typename Kernel::Block& K, Tangent& tangent) {
  const auto equations = cell_equations<Kernel>(layout, material.block.cell(c));
  if constexpr (Kernel::has_bubble)
    tangent.add(equations, Kernel::condensed(K, cell, unseen_shear(material.law)));
  else
    tangent.add(equations, K);
}

template <class Kernel>
void add_isotropic_stiffness(const DofLayout& layout, const Material& material, const Lame& lame, Tangent& tangent) {
  typename Kernel::Cell cell;
  typename Kernel::Block K;
  for (std::int32_t c = 0; c < material.block.size(); ++c) {
    Kernel::geometry(material.rule, gather<Kernel>(material.mesh.coordinates, material.block.cell(c)), cell);
    Kernel::isotropic_stiffness(cell, lame, K);
    add_cell_stiffness<Kernel>(layout, material, c, cell, K, tangent);
  }
}

template <class Kernel>
void add_stiffness(const DofLayout& layout, const Material& material, std::span<const double> displacement,
                   Tangent& tangent) {
  typename Kernel::Block K;
  std::vector<double> moduli;
  each_batch<Kernel>(material, displacement, [&](const Batch<Kernel>& batch) {
    moduli.resize(batch.strain.size() * Kernel::components);
    material.law.moduli(batch.strain, moduli);
    for (std::size_t c = 0; c < batch.cells.size(); ++c) {
      Kernel::stiffness(batch.cells[c], &moduli[c * batch.stride() * Kernel::components], K);
      add_cell_stiffness<Kernel>(layout, material, batch.first + static_cast<std::int32_t>(c), batch.cells[c], K,
                                 tangent);
    }
  });
}

/// Strain energy at the points plus that of what they do not see of the bubbles.
template <class Kernel>
double block_energy(const Material& material, std::span<const double> displacement) {
  double energy = 0;
  std::vector<double> density;
  each_batch<Kernel>(material, displacement, [&](const Batch<Kernel>& batch) {
    density.resize(batch.strain.size() / Kernel::components);
    material.law.energy(batch.strain, density);
    std::size_t point = 0;
    for (std::size_t c = 0; c < batch.cells.size(); ++c) {
      for (int q = 0; q < batch.cells[c].size; ++q)
        energy += batch.cells[c].points[q].weight * density[point++];
      if constexpr (Kernel::has_bubble) {
        const auto unseen = Kernel::unseen_stiffness(batch.cells[c], unseen_shear(material.law));
        const double* const beta = &batch.displacements[c][Kernel::node_unknowns];
        for (int i = 0; i < Kernel::dim; ++i)
          for (int j = 0; j < Kernel::dim; ++j)
            energy += 0.5 * beta[i] * unseen[i][j] * beta[j];
      }
    }
  });
  return energy;
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

BulkForm::BulkForm(const DofLayout& layout, Space space, std::vector<BulkLawPtr> laws, std::vector<BodyLoad> body_loads)
    : layout_(layout), space_(space), laws_(std::move(laws)), body_loads_(std::move(body_loads)) {
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

template <class Work>
void BulkForm::each_block(double time, Work&& work) {
  const Mesh& mesh = layout_.mesh();
  const bool known = bubble_forces_time_ == time;
  bubble_forces_.resize(mesh.blocks.size());
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const CellBlock& block = mesh.blocks[b];
    with_kernel(block.type, space_, [&](auto kernel) {
      if constexpr (decltype(kernel)::has_bubble)
        if (!known && !body_loads_.empty()) bubble_forces_[b] = bubble_forces(mesh, space_, block, body_loads_, time);
      work(kernel, Material{mesh, block, cell_rule(block.type, space_), *laws_[block.body], bubble_forces_[b]});
    });
  }
  bubble_forces_time_ = time;
}

void BulkForm::add_residual(const State& state, Residual& residual) {
  each_block(state.time, [&](auto kernel, const Material& material) {
    add_block_forces<decltype(kernel)>(material, state.displacement, residual.nodal());
  });
}

void BulkForm::add_tangent(const State& state, Tangent& tangent) {
  each_block(state.time, [&](auto kernel, const Material& material) {
    if (const auto lame = material.law.constant_lame())
      add_isotropic_stiffness<decltype(kernel)>(layout_, material, *lame, tangent);
    else
      add_stiffness<decltype(kernel)>(layout_, material, state.displacement, tangent);
  });
}

bool BulkForm::tangent_is_constant() const {
  return std::all_of(laws_.begin(), laws_.end(), [](const auto& law) { return law->constant_lame().has_value(); });
}

double BulkForm::stored_energy(const State& state) {
  double total = 0;
  each_block(state.time, [&](auto kernel, const Material& material) {
    total += block_energy<decltype(kernel)>(material, state.displacement);
  });
  return total;
}

LoadedBubbles BulkForm::loaded_bubbles(const State& state) {
  LoadedBubbles result;
  if (body_loads_.empty()) return result;
  each_block(state.time, [&](auto kernel, const Material& material) {
    using Kernel = decltype(kernel);
    if constexpr (Kernel::has_bubble) {
      result.forces.insert(result.forces.end(), material.bubble_forces.begin(), material.bubble_forces.end());
      each_batch<Kernel>(material, state.displacement, [&](const Batch<Kernel>& batch) {
        for (const auto& u : batch.displacements)
          result.displacements.insert(result.displacements.end(), u.begin() + Kernel::node_unknowns, u.end());
      });
    }
  });
  return result;
}

void BulkForm::for_each_batch(const State& state, const std::function<void(const PointBatch&)>& visit) {
  std::vector<double> weights;
  each_block(state.time, [&](auto kernel, const Material& material) {
    using Kernel = decltype(kernel);
    each_batch<Kernel>(material, state.displacement, [&](const Batch<Kernel>& batch) {
      weights.clear();
      for (const auto& cell : batch.cells)
        for (int q = 0; q < cell.size; ++q)
          weights.push_back(cell.points[q].weight);
      visit({&material.block, batch.first, static_cast<std::int32_t>(batch.cells.size()), material.rule.table, weights,
             batch.strain, batch.stress});
    });
  });
}

NodalStress BulkForm::nodal_stress(const State& state) {
  const Mesh& mesh = layout_.mesh();
  const std::size_t size = mesh.num_local(), components = space_dim(space_) == 2 ? strain_size<2> : strain_size<3>;
  NodalStress result{std::vector<double>(size * components), std::vector<double>(size * components)};
  std::vector<double> volume(size);
  for_each_batch(state, [&](const PointBatch& batch) {
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
