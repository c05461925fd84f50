#include "form/bulk.hpp"

#include "form/cell_access.hpp"
#include "form/cell_kernel.hpp"
#include "material/elastic.hpp"

#include <cmath>
#include <stdexcept>

namespace amontons {
namespace {

/// One block of cells with all that its strains and stresses depend on besides the displacement.
struct Material {
  const Mesh& mesh;
  const CellBlock& block;
  CellRule rule;
  const SmallLaw& law;
  Space space;
  std::optional<Lame> linear; // the law's constants if it is linear elastic
  double unseen_shear;        // G' of what no quadrature point sees of a bubble: E / 3, the right one where it matters
  PointContext context;
  const PointStates::Block& accepted;
  std::span<const double> bubble_forces; // dim a cell; empty: none
};

/// Some consecutive cells of a block, deformed. `strain` and `stress` run as in PointBatch; the numbers of `stored`,
/// `dissipated` and `states` are those of a law that is not linear elastic.
template <class Kernel>
struct Batch {
  std::int32_t first;
  std::vector<typename Kernel::Cell> cells;
  std::vector<typename Kernel::Nodal> displacements; // of the nodes and of the bubble
  std::vector<double> strain, stress, moduli;
  std::vector<double> stored, dissipated, states;
  std::size_t stride() const { return strain.size() / cells.size(); }
  std::size_t points() const { return strain.size() / Kernel::components; }
  std::size_t first_point() const { return first * (points() / cells.size()); }
  SmallPoints at_points(const Material& material) const {
    return {strain, material.accepted.states_of(first_point(), points())};
  }
};

template <class Kernel>
PointOutcome find_stress(const Material& material, Batch<Kernel>& batch) {
  constexpr int dim = Kernel::dim, size = Kernel::components;
  if (material.linear) {
    for (std::size_t i = 0; i < batch.strain.size(); i += size)
      Eigen::Map<Stress<dim>>{&batch.stress[i]} =
          elastic_stress<dim>(*material.linear, material.space, Eigen::Map<const Strain<dim>>(&batch.strain[i]));
    return PointOutcome::Solved;
  }
  const auto failure = respond<dim>(material.law, material.context, batch.at_points(material),
                                    {batch.stress, batch.stored, batch.dissipated, batch.states});
  return failure ? failure->outcome : PointOutcome::Solved;
}

/// dσ/dε of a law that is not linear elastic.
template <class Kernel>
PointOutcome find_moduli(const Material& material, const Batch<Kernel>& batch, std::vector<double>& moduli) {
  moduli.resize(batch.strain.size() * Kernel::components);
  const auto failure = tangents<Kernel::dim>(material.law, material.context, batch.at_points(material), moduli);
  return failure ? failure->outcome : PointOutcome::Solved;
}

/// Newton's method for the bubbles of a batch: one step for a linear law.
constexpr int most_bubble_steps = 25;
constexpr double bubble_tolerance = 1e-10; // change of β relative to bubble_scale

/// What a bubble's displacement is small against: the displacements within the cell, or those that its stresses stand
/// for (in a cell that has come back to its place and has stresses left).
template <class Kernel>
double bubble_scale(const Material& material, std::size_t c, const Batch<Kernel>& batch) {
  constexpr int dim = Kernel::dim;
  const auto& u = batch.displacements[c];
  const auto& cell = batch.cells[c];
  double moved = 0, stress = 0, slope = 0;
  for (int i = 0; i < dim; ++i)
    for (int a = 1; a < Kernel::functions; ++a)
      moved = std::max(moved, std::abs(u[a * dim + i] - (a < Kernel::nodes ? u[i] : 0.0)));
  for (int q = 0; q < cell.size; ++q)
    for (int i = 0; i < dim; ++i)
      slope = std::max(slope, std::abs(cell.points[q].gradient[Kernel::node_unknowns + i]));
  const std::size_t at = c * batch.stride();
  for (std::size_t i = at; i < at + batch.stride(); ++i)
    stress = std::max(stress, std::abs(batch.stress[i]));
  return std::max(moved, stress / (3 * material.unseen_shear * slope));
}

/// One Newton step for the bubble of cell c of a batch. True when it was a small one. (Strains are changed in place, so
/// rounding in those of the nodes does not come back as a change of β.)
template <class Kernel>
bool improve_bubble(const Material& material, std::size_t c, Batch<Kernel>& batch) {
  constexpr int dim = Kernel::dim, first = Kernel::node_unknowns;
  const auto& cell = batch.cells[c];
  const std::size_t at = c * batch.stride();
  const double shear = material.unseen_shear;
  auto& u = batch.displacements[c];
  const auto stiffness = material.linear
                             ? Kernel::bubble_stiffness(cell, *material.linear, shear)
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
  double change = 0;
  for (int i = 0; i < dim; ++i) {
    u[first + i] += step[first + i];
    change = std::max(change, std::abs(step[first + i]));
  }
  return change <= bubble_tolerance * bubble_scale(material, c, batch);
}

/// Brings the bubbles of a batch into equilibrium with the nodes' displacements, and makes the stresses.
template <class Kernel>
PointOutcome relax_bubbles(const Material& material, Batch<Kernel>& batch) {
  bool done = false;
  for (int step = 0; step < most_bubble_steps && !done; ++step) {
    auto outcome = find_stress(material, batch);
    if (outcome == PointOutcome::Solved && !material.linear) outcome = find_moduli(material, batch, batch.moduli);
    if (outcome != PointOutcome::Solved) return outcome;
    done = true;
    for (std::size_t c = 0; c < batch.cells.size(); ++c)
      done = improve_bubble(material, c, batch) && done;
    done = done || material.linear;
  }
  return done ? find_stress(material, batch) : PointOutcome::NotConverged;
}

/// Geometry, strains and stresses batch by batch: calls work(batch) for each batch of the block, up to the first one
/// that has no answer, and returns how that went.
template <class Kernel, class Work>
PointOutcome each_batch(const Material& material, std::span<const double> displacement, Work&& work) {
  const CellBlock& block = material.block;
  const auto points = static_cast<std::size_t>(material.rule.table->rule->size());
  Batch<Kernel> batch;
  for (batch.first = 0; batch.first < block.size(); batch.first += batch_cells<Kernel>) {
    const std::size_t count = std::min(batch_cells<Kernel>, block.size() - batch.first);
    batch.cells.resize(count);
    batch.displacements.resize(count);
    batch.strain.assign(count * points * Kernel::components, 0.0);
    batch.stress.resize(batch.strain.size());
    if (!material.linear) {
      batch.stored.resize(count * points);
      batch.dissipated.resize(count * points);
      batch.states.resize(count * points * material.accepted.components);
    }
    for (std::size_t c = 0; c < count; ++c) {
      const auto nodes = block.cell(batch.first + static_cast<std::int32_t>(c));
      Kernel::geometry(material.rule, gather<Kernel>(material.mesh.coordinates, nodes), batch.cells[c]);
      batch.displacements[c] = gather<Kernel>(displacement, nodes);
      Kernel::template add_strains<0, Kernel::nodes>(batch.cells[c], batch.displacements[c],
                                                     &batch.strain[c * batch.stride()]);
    }
    PointOutcome outcome;
    if constexpr (Kernel::has_bubble)
      outcome = relax_bubbles(material, batch);
    else
      outcome = find_stress(material, batch);
    if (outcome != PointOutcome::Solved) return outcome;
    work(batch);
  }
  return PointOutcome::Solved;
}

template <class Kernel>
PointOutcome add_block_forces(const Material& material, std::span<const double> displacement,
                              std::span<double> forces) {
  return each_batch<Kernel>(material, displacement, [&](const Batch<Kernel>& batch) {
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
    tangent.add(equations, Kernel::condensed(K, cell, material.unseen_shear));
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

/// A law that answers to a strain has moduli there, too, unless they overflow: then nothing is added, and the solver
/// meets the failure at its next residual.
template <class Kernel>
void add_stiffness(const DofLayout& layout, const Material& material, std::span<const double> displacement,
                   Tangent& tangent) {
  typename Kernel::Block K;
  std::vector<double> moduli;
  each_batch<Kernel>(material, displacement, [&](const Batch<Kernel>& batch) {
    if (find_moduli(material, batch, moduli) != PointOutcome::Solved) return;
    for (std::size_t c = 0; c < batch.cells.size(); ++c) {
      Kernel::stiffness(batch.cells[c], &moduli[c * batch.stride() * Kernel::components], K);
      add_cell_stiffness<Kernel>(layout, material, batch.first + static_cast<std::int32_t>(c), batch.cells[c], K,
                                 tangent);
    }
  });
}

/// Σ w σ : ε over a batch.
template <class Kernel>
double work_at_points(const Batch<Kernel>& batch) {
  std::vector<double> density(batch.points(), 0.0);
  for (std::size_t i = 0; i < batch.strain.size(); ++i)
    density[i / Kernel::components] += batch.stress[i] * batch.strain[i];
  return weighted(batch, density);
}

/// β · (unseen stiffness) β over a batch: twice the energy of what the points do not see of the bubbles.
template <class Kernel>
double unseen_work(const Material& material, const Batch<Kernel>& batch) {
  double sum = 0;
  if constexpr (Kernel::has_bubble)
    for (std::size_t c = 0; c < batch.cells.size(); ++c) {
      const auto unseen = Kernel::unseen_stiffness(batch.cells[c], material.unseen_shear);
      const double* const beta = &batch.displacements[c][Kernel::node_unknowns];
      for (int i = 0; i < Kernel::dim; ++i)
        for (int j = 0; j < Kernel::dim; ++j)
          sum += beta[i] * unseen[i][j] * beta[j];
    }
  return sum;
}

/// The zz strains that the others imply where zz is free.
void complete_strain(const Elastic& elastic, std::span<double> strain) {
  for (std::size_t i = 0; i < strain.size(); i += strain_size<2>)
    strain[i + 2] = plane_stress_zz_strain(elastic, strain[i], strain[i + 1]);
}

} // namespace

BulkForm::BulkForm(const DofLayout& layout, Space space, std::vector<SmallLaw> laws, std::vector<BodyLoad> body_loads)
    : SolidForm(virgin_states(layout.mesh(), space, laws)), layout_(layout), space_(space), laws_(std::move(laws)),
      body_loads_(std::move(body_loads)) {
  for (const auto& law : laws_) {
    const auto* elastic = std::get_if<Elastic>(&law);
    if (!elastic && space_ == Space::PlaneStress)
      throw std::invalid_argument("BulkForm: plane stress is for linear elastic bodies");
    BodyModuli moduli{.young = young(initial_lame(law)), .linear = {}};
    if (elastic) moduli.linear = lame_constants(*elastic, space_);
    moduli_.push_back(moduli);
  }
  check_cells(layout_.mesh(), space_);
}

template <class Work>
void BulkForm::each_block(const State& state, Work&& work) {
  const Mesh& mesh = layout_.mesh();
  const bool known = bubble_forces_time_ == state.time;
  const PointContext context{.dt = std::max(0.0, state.time - states_.time)};
  bubble_forces_.resize(mesh.blocks.size());
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const CellBlock& block = mesh.blocks[b];
    const auto& [young_modulus, linear] = moduli_[block.body];
    with_kernel(block.type, space_, [&](auto kernel) {
      if constexpr (decltype(kernel)::has_bubble)
        if (!known && !body_loads_.empty())
          bubble_forces_[b] = bubble_forces(mesh, space_, block, body_loads_, state.time);
      work(kernel,
           Material{mesh, block, cell_rule(block.type, space_), laws_[block.body], space_, linear, young_modulus / 3,
                    context, states_.blocks[b], bubble_forces_[b]},
           b);
    });
  }
  bubble_forces_time_ = state.time;
}

void BulkForm::add_residual(const State& state, Residual& residual) {
  each_block(state, [&](auto kernel, const Material& material, std::size_t) {
    const auto outcome = add_block_forces<decltype(kernel)>(material, state.displacement, residual.nodal());
    if (outcome != PointOutcome::Solved) residual.fail(failure_text(material.mesh, material.block, outcome));
  });
}

void BulkForm::add_constant_tangent(const State& state, Tangent& tangent) {
  each_block(state, [&](auto kernel, const Material& material, std::size_t) {
    if (material.linear) add_isotropic_stiffness<decltype(kernel)>(layout_, material, *material.linear, tangent);
  });
}

void BulkForm::add_changing_tangent(const State& state, Tangent& tangent) {
  each_block(state, [&](auto kernel, const Material& material, std::size_t) {
    if (!material.linear) add_stiffness<decltype(kernel)>(layout_, material, state.displacement, tangent);
  });
}

void BulkForm::add_tangent(const State& state, Tangent& tangent) {
  add_constant_tangent(state, tangent);
  add_changing_tangent(state, tangent);
}

bool BulkForm::tangent_is_constant() const {
  return std::all_of(moduli_.begin(), moduli_.end(), [](const auto& moduli) { return moduli.linear.has_value(); });
}

void BulkForm::for_each_new_states(const State& state, const std::function<void(const NewPointStates&)>& visit) {
  std::vector<double> weights;
  each_block(state, [&](auto kernel, const Material& material, std::size_t b) {
    using Kernel = decltype(kernel);
    if (!material.accepted.has_memory()) return;
    each_batch<Kernel>(material, state.displacement, [&](const Batch<Kernel>& batch) {
      find_weights(batch, weights);
      visit({b, batch.first_point(), weights, batch.states, batch.dissipated});
    });
  });
}

double BulkForm::stored_energy(const State& state) {
  double total = 0;
  each_block(state, [&](auto kernel, const Material& material, std::size_t) {
    using Kernel = decltype(kernel);
    each_batch<Kernel>(material, state.displacement, [&](const Batch<Kernel>& batch) {
      total += material.linear ? 0.5 * work_at_points(batch) : weighted(batch, batch.stored);
      total += 0.5 * unseen_work(material, batch);
    });
  });
  return total;
}

double BulkForm::internal_work(const State& state) {
  double total = 0;
  each_block(state, [&](auto kernel, const Material& material, std::size_t) {
    using Kernel = decltype(kernel);
    each_batch<Kernel>(material, state.displacement, [&](const Batch<Kernel>& batch) {
      total += work_at_points(batch) + unseen_work(material, batch);
    });
  });
  return total;
}

LoadedBubbles BulkForm::loaded_bubbles(const State& state) {
  LoadedBubbles result;
  if (body_loads_.empty()) return result;
  each_block(state, [&](auto kernel, const Material& material, std::size_t) {
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

std::vector<std::string> BulkForm::scalar_names() const {
  const bool plastic =
      std::any_of(laws_.begin(), laws_.end(), [](const auto& law) { return !state_names(law).empty(); });
  if (!plastic) return {};
  return {"accumulated_plastic_strain"};
}

void BulkForm::for_each_batch(const State& state, const std::function<void(const PointBatch&)>& visit) {
  const bool has_scalars = !scalar_names().empty();
  std::vector<double> weights, strain, scalars;
  each_block(state, [&](auto kernel, const Material& material, std::size_t) {
    using Kernel = decltype(kernel);
    each_batch<Kernel>(material, state.displacement, [&](const Batch<Kernel>& batch) {
      strain = batch.strain;
      if (space_ == Space::PlaneStress) complete_strain(std::get<Elastic>(material.law), strain);
      find_weights(batch, weights);
      scalars.assign(has_scalars ? batch.points() : 0, 0.0);
      for (std::size_t p = 0; p < batch.points() && material.accepted.has_memory(); ++p)
        scalars[p] = batch.states[p * material.accepted.components];
      visit({&material.block, batch.first, static_cast<std::int32_t>(batch.cells.size()), material.rule.table, weights,
             strain, batch.stress, scalars});
    });
  });
}

} // namespace amontons
