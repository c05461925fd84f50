#include "form/bulk.hpp"

#include "form/cell_access.hpp"
#include "form/cell_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace amontons {
namespace {

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
      scatter<Kernel>(force, material.block.cell(batch.first + static_cast<std::int32_t>(c)), forces);
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

} // namespace

BulkForm::BulkForm(const DofLayout& layout, Space space, std::vector<BulkLawPtr> laws, std::vector<BodyLoad> body_loads)
    : layout_(layout), space_(space), laws_(std::move(laws)), body_loads_(std::move(body_loads)) {
  check_cells(layout_.mesh(), space_);
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
  std::vector<double> weights, strain;
  each_block(state.time, [&](auto kernel, const Material& material) {
    using Kernel = decltype(kernel);
    each_batch<Kernel>(material, state.displacement, [&](const Batch<Kernel>& batch) {
      strain = batch.strain;
      material.law.complete_strain(strain);
      weights.clear();
      for (const auto& cell : batch.cells)
        for (int q = 0; q < cell.size; ++q)
          weights.push_back(cell.points[q].weight);
      visit({&material.block,
             batch.first,
             static_cast<std::int32_t>(batch.cells.size()),
             material.rule.table,
             weights,
             strain,
             batch.stress,
             {}});
    });
  });
}

} // namespace amontons
