#include "form/finite_bulk.hpp"

#include "form/cell_access.hpp"
#include "form/finite_kernel.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <stdexcept>

namespace amontons {
namespace {

/// One block of cells with all that its stresses depend on besides the displacement.
struct Material {
  const Mesh& mesh;
  const CellBlock& block;
  CellRule rule;
  const FiniteLaw& law;
  PointContext context;
  const PointStates::Block& accepted;
};

/// Some consecutive cells of a block, deformed. The numbers of the points run cell by cell.
template <class Kernel>
struct Batch {
  std::int32_t first = 0;
  std::vector<typename Kernel::Cell> cells;
  std::vector<typename Kernel::Deformation> deformations;
  std::vector<double> F, piola; // F̄ and P̄
  std::vector<double> stored, dissipated, states;
  std::size_t points() const { return stored.size(); }
  std::size_t stride() const { return points() / cells.size(); }
  std::size_t first_point() const { return first * stride(); }
  FinitePoints at_points(const Material& material) const {
    return {F, material.accepted.states_of(first_point(), points())};
  }
};

/// Deforms the cells of a batch; false when one is turned inside out.
template <class Kernel>
bool deform(const Material& material, std::span<const double> displacement, std::size_t count, Batch<Kernel>& batch) {
  const auto points = static_cast<std::size_t>(material.rule.table->rule->size());
  batch.cells.resize(count);
  batch.deformations.resize(count);
  batch.F.resize(9 * count * points);
  batch.piola.resize(batch.F.size());
  batch.stored.resize(count * points);
  batch.dissipated.assign(count * points, 0.0);
  batch.states.resize(count * points * material.accepted.components);
  bool sound = true;
  for (std::size_t c = 0; c < count; ++c) {
    const auto nodes = material.block.cell(batch.first + static_cast<std::int32_t>(c));
    Kernel::geometry(material.rule, gather<Kernel>(material.mesh.coordinates, nodes), batch.cells[c]);
    const auto u = gather<Kernel>(displacement, nodes);
    sound = Kernel::deform(batch.cells[c], u, batch.deformations[c], &batch.F[9 * c * points]) && sound;
  }
  return sound;
}

/// Geometry, deformation and stresses batch by batch: calls work(batch) for each batch of the block, up to the first
/// one that has no answer, and returns how that went.
template <class Kernel, class Work>
PointOutcome each_batch(const Material& material, std::span<const double> displacement, Work&& work) {
  Batch<Kernel> batch;
  for (batch.first = 0; batch.first < material.block.size(); batch.first += batch_cells<Kernel>) {
    const std::size_t count = std::min(batch_cells<Kernel>, material.block.size() - batch.first);
    if (!deform(material, displacement, count, batch)) return PointOutcome::Inverted;
    const auto failure = respond(material.law, material.context, batch.at_points(material),
                                 {batch.piola, batch.stored, batch.dissipated, batch.states});
    if (failure) return failure->outcome;
    work(batch);
  }
  return PointOutcome::Solved;
}

/// Calls work(cell of the batch, its number in the block, P*) for each cell of a batch.
template <class Kernel, class Work>
void each_cell(const Batch<Kernel>& batch, Work&& work) {
  std::array<double, std::size_t(9) * Kernel::max_points> effective;
  for (std::size_t c = 0; c < batch.cells.size(); ++c) {
    Kernel::effective_stress(batch.cells[c], batch.deformations[c], &batch.piola[9 * c * batch.stride()],
                             effective.data());
    work(c, batch.first + static_cast<std::int32_t>(c), effective.data());
  }
}

/// A law that answers to F has a tangent there, too, unless it overflows: then nothing is added, and the solver meets
/// the failure at its next residual.
template <class Kernel>
void add_stiffness(const DofLayout& layout, const Material& material, std::span<const double> displacement,
                   Tangent& tangent) {
  typename Kernel::Block K;
  std::vector<double> moduli;
  each_batch<Kernel>(material, displacement, [&](const Batch<Kernel>& batch) {
    moduli.resize(81 * batch.points());
    if (tangents(material.law, material.context, batch.at_points(material), moduli)) return;
    for (std::size_t c = 0; c < batch.cells.size(); ++c) {
      const std::size_t at = c * batch.stride();
      Kernel::stiffness(batch.cells[c], batch.deformations[c], &batch.piola[9 * at], &moduli[81 * at], K);
      tangent.add(cell_equations<Kernel>(layout, material.block.cell(batch.first + static_cast<std::int32_t>(c))), K);
    }
  });
}

/// Cauchy's stress P Fᵀ / det F and the logarithmic strain ln V, V² = F Fᵀ, in the components of a PointBatch; returns
/// det F.
template <int components>
double spatial(const double* gradient, const double* piola, double* strain, double* stress) {
  const Tensor F = unflat(gradient), P = unflat(piola);
  const double J = F.determinant();
  const Tensor sigma = P * F.transpose() / J;
  const Eigen::SelfAdjointEigenSolver<Tensor> spectrum(F * F.transpose());
  const Tensor axes = spectrum.eigenvectors();
  const Tensor E = 0.5 * axes * spectrum.eigenvalues().array().log().matrix().asDiagonal() * axes.transpose();
  constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};
  for (int i = 0; i < components; ++i) {
    const auto [a, b] = pairs[i];
    stress[i] = sigma(a, b);
    strain[i] = (a == b ? 1.0 : 2.0) * E(a, b);
  }
  return J;
}

/// What a PointBatch is made of, for one batch.
struct SpatialFields {
  std::vector<double> weights, strain, stress, scalars;
};

template <class Kernel>
void find_spatial_fields(const Batch<Kernel>& batch, int state_components, std::size_t scalars, SpatialFields& fields) {
  constexpr int components = Kernel::components;
  find_weights(batch, fields.weights);
  fields.scalars.assign(batch.points() * scalars, 0.0);
  fields.strain.resize(batch.points() * components);
  fields.stress.resize(fields.strain.size());
  for (std::size_t p = 0; p < batch.points(); ++p) {
    double* const scalar = &fields.scalars[p * scalars];
    scalar[0] = spatial<components>(&batch.F[9 * p], &batch.piola[9 * p], &fields.strain[p * components],
                                    &fields.stress[p * components]);
    if (state_components > 0) scalar[1] = batch.states[p * state_components];
  }
}

} // namespace

FiniteBulkForm::FiniteBulkForm(const DofLayout& layout, Space space, std::vector<FiniteLaw> laws)
    : SolidForm(virgin_states(layout.mesh(), space, laws)), layout_(layout), space_(space), laws_(std::move(laws)) {
  if (space == Space::PlaneStress) throw std::invalid_argument("FiniteBulkForm: there is no plane stress");
  check_cells(layout_.mesh(), space_);
}

template <class Work>
void FiniteBulkForm::each_block(const State& state, Work&& work) {
  const Mesh& mesh = layout_.mesh();
  const PointContext context{.dt = std::max(0.0, state.time - states_.time)};
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const CellBlock& block = mesh.blocks[b];
    with_finite_kernel(block.type, space_, [&](auto kernel) {
      work(kernel, Material{mesh, block, cell_rule(block.type, space_), laws_[block.body], context, states_.blocks[b]},
           b);
    });
  }
}

void FiniteBulkForm::add_residual(const State& state, Residual& residual) {
  each_block(state, [&](auto kernel, const Material& material, std::size_t) {
    using Kernel = decltype(kernel);
    const auto outcome = each_batch<Kernel>(material, state.displacement, [&](const Batch<Kernel>& batch) {
      each_cell(batch, [&](std::size_t c, std::int32_t number, const double* effective) {
        scatter<Kernel>(Kernel::forces(batch.cells[c], effective), material.block.cell(number), residual.nodal());
      });
    });
    if (outcome != PointOutcome::Solved) residual.fail(failure_text(material.mesh, material.block, outcome));
  });
}

void FiniteBulkForm::add_tangent(const State& state, Tangent& tangent) {
  each_block(state, [&](auto kernel, const Material& material, std::size_t) {
    add_stiffness<decltype(kernel)>(layout_, material, state.displacement, tangent);
  });
}

bool FiniteBulkForm::tangent_is_symmetric() const {
  return std::all_of(laws_.begin(), laws_.end(), [](const auto& law) { return has_symmetric_tangent(law); });
}

void FiniteBulkForm::for_each_new_states(const State& state, const std::function<void(const NewPointStates&)>& visit) {
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

double FiniteBulkForm::stored_energy(const State& state) {
  double total = 0;
  each_block(state, [&](auto kernel, const Material& material, std::size_t) {
    using Kernel = decltype(kernel);
    each_batch<Kernel>(material, state.displacement,
                       [&](const Batch<Kernel>& batch) { total += weighted(batch, batch.stored); });
  });
  return total;
}

double FiniteBulkForm::internal_work(const State& state) {
  double total = 0;
  each_block(state, [&](auto kernel, const Material& material, std::size_t) {
    using Kernel = decltype(kernel);
    each_batch<Kernel>(material, state.displacement, [&](const Batch<Kernel>& batch) {
      each_cell(batch, [&](std::size_t c, std::int32_t, const double* effective) {
        total += Kernel::work(batch.cells[c], batch.deformations[c], effective);
      });
    });
  });
  return total;
}

double FiniteBulkForm::stiffness(std::int32_t body) const { return young(initial_lame(laws_[body])); }

std::vector<std::string> FiniteBulkForm::scalar_names() const {
  std::vector<std::string> names = {"volume_ratio"};
  if (std::any_of(laws_.begin(), laws_.end(), [](const auto& law) { return !state_names(law).empty(); }))
    names.emplace_back("accumulated_plastic_strain");
  return names;
}

void FiniteBulkForm::for_each_batch(const State& state, const std::function<void(const PointBatch&)>& visit) {
  const std::size_t scalars = scalar_names().size();
  SpatialFields fields;
  each_block(state, [&](auto kernel, const Material& material, std::size_t) {
    using Kernel = decltype(kernel);
    each_batch<Kernel>(material, state.displacement, [&](const Batch<Kernel>& batch) {
      find_spatial_fields(batch, material.accepted.components, scalars, fields);
      visit({&material.block, batch.first, static_cast<std::int32_t>(batch.cells.size()), material.rule.table,
             fields.weights, fields.strain, fields.stress, fields.scalars});
    });
  });
}

} // namespace amontons
