// Traction on the slave t = Σ_k λ_k n_k ψ_k, λ_k <= 0: the force of node k on the slave is λ_k n_k ∫ ψ_k N_k, at its
// place, because ∫ ψ_k N_a vanishes for the others; on the master λ_k n_k P_kj D_k. Work is done on
//   gap_k = g_k + n_k · (c_k − Σ_j P_kj u_j),  P_kj = ∫ ψ_k N_j^master / D_k,
// whatever the number of ranks: each adds what its own points see.
#include "contact/mortar_form.hpp"

#include "geometry/projection.hpp"
#include "math/reference_element.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

namespace {

/// A node of whose weight less than this share is covered has no constraint: it would be held by a few points at the
/// far end of its facets, and its force, which acts at the node, stand for a pressure beyond the rim of the master. A
/// facet covered over the part c at its other end covers c² / 2 of a facet: 0.05 of the weight of a node between two
/// facets is a third of a facet covered.
constexpr double least_cover = 0.05;
/// Gap of a node without constraint, as of a point without master.
constexpr double no_gap = 1e300;

NodeField slave_nodes(const Mesh& mesh, const ContactPair& pair) {
  return {.name = pair.name, .nodes = mesh.node_groups.at(pair.slave)};
}

} // namespace

MortarForm::MortarForm(const DofLayout& layout, ContactPair pair)
    : layout_(layout), pair_(std::move(pair)), nodes_(slave_nodes(layout.mesh(), pair_)),
      place_(layout.mesh().num_local(), -1), points_(layout, pair_),
      constraint_space_(layout.mesh(), std::vector<NodeField>(6, nodes_)), gap_space_(layout.mesh(), {nodes_}) {
  for (std::size_t i = 0; i < nodes_.nodes.size(); ++i)
    place_[nodes_.nodes[i]] = static_cast<std::int32_t>(i);
  multipliers_.assign(nodes_.nodes.size(), 0.0);
  multipliers_old_ = multipliers_;
  find_facets();
  find_constraints();
}

void MortarForm::find_facets() {
  const auto& mesh = layout_.mesh();
  const auto& points = points_.points();
  facets_.resize(slave().size());
  std::size_t next = 0;
  for (std::int32_t f = 0; f < slave().size(); ++f) {
    auto& facet = facets_[f];
    const auto type = slave().types[f];
    const auto nodes = slave().facet(f);
    std::vector<double> positions;
    for (const auto node : nodes)
      positions.insert(positions.end(), mesh.position(node).begin(), mesh.position(node).end());
    facet.size = facet_size(type, positions);
    facet.places.assign(nodes.size(), {});
    const auto& controls = controls_from_nodes(type);
    for (std::size_t k = 0; k < nodes.size(); ++k)
      for (std::size_t a = 0; a < nodes.size(); ++a)
        for (int c = 0; c < mesh.dim; ++c)
          facet.places[k][c] += controls(k, a) * positions[a * mesh.dim + c];

    facet.begin = next;
    while (next < points.size() && points[next].facet == f)
      ++next;
    facet.end = next;
    const auto shape = control_shape(f);
    std::vector<double> weights;
    for (std::size_t i = facet.begin; i < facet.end; ++i)
      weights.push_back(is_covered(points[i]) ? points[i].weight : 0.0);
    facet.dual = dual_basis(shape, weights);
    for (std::size_t i = facet.begin; facet.dual && i < facet.end; ++i)
      if (!is_covered(points[i])) facet.dual->values.row(static_cast<Eigen::Index>(i - facet.begin)).setZero();
  }
}

/// Values of the facet's non-negative basis at its points.
PointTable MortarForm::control_shape(std::int32_t f) const {
  const auto& facet = facets_[f];
  const auto n = static_cast<Eigen::Index>(slave().facet(f).size());
  PointTable nodal(facet.end - facet.begin, n);
  for (std::size_t i = facet.begin; i < facet.end; ++i)
    nodal.row(static_cast<Eigen::Index>(i - facet.begin)) =
        Eigen::Map<const Eigen::RowVectorXd>(points_.slave_shape(points_.points()[i]).data(), n);
  return nodal * nodes_from_controls(slave().types[f]);
}

/// ∫ N over the whole facet, covered or not.
Eigen::VectorXd MortarForm::whole_integrals(std::int32_t f) const {
  const auto& mesh = layout_.mesh();
  const auto type = slave().types[f];
  const auto nodes = slave().facet(f);
  const auto n = static_cast<Eigen::Index>(nodes.size());
  std::vector<double> positions;
  for (const auto node : nodes)
    positions.insert(positions.end(), mesh.position(node).begin(), mesh.position(node).end());
  const auto& table = tabulation(type, 2 * element_order(type));
  Eigen::VectorXd integral = Eigen::VectorXd::Zero(n);
  for (int q = 0; q < table.rule->size(); ++q) {
    const Eigen::Map<const Eigen::VectorXd> shape(table.value(q).data(), n);
    std::array<double, 3> normal{};
    const double measure = facet_normal(type, positions, table.rule->point(q), normal);
    double x = 0.0;
    for (Eigen::Index a = 0; a < n; ++a)
      x += shape[a] * positions[std::size_t(a) * mesh.dim];
    integral += table.rule->weights[q] * measure * circumference(pair_.space, x) * shape;
  }
  return nodes_from_controls(type).transpose() * integral;
}

/// Collective.
void MortarForm::find_constraints() {
  const auto& points = points_.points();
  std::vector<std::vector<double>> sums(6, std::vector<double>(nodes_.nodes.size(), 0.0));
  for (std::int32_t f = 0; f < slave().size(); ++f) {
    const auto& facet = facets_[f];
    const auto nodes = slave().facet(f);
    const auto whole = whole_integrals(f);
    const auto shape = control_shape(f);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const auto at = place_[nodes[k]];
      sums[5][at] += whole[k];
      if (!facet.dual) continue;
      sums[0][at] += facet.dual->integral[k];
      for (std::size_t i = facet.begin; i < facet.end; ++i) {
        if (!is_covered(points[i])) continue;
        const auto row = static_cast<Eigen::Index>(i - facet.begin);
        for (int c = 0; c < 3; ++c)
          sums[1 + c][at] += points[i].weight * shape(row, k) * points[i].normal[c];
        sums[4][at] += points[i].weight * facet.dual->values(row, k) * points[i].gap0;
      }
    }
  }
  const auto global = constraint_space_.new_vector();
  constraint_space_.add(sums, global);
  constraint_space_.gather(global, sums);
  constraints_.assign(nodes_.nodes.size(), {});
  for (std::size_t i = 0; i < constraints_.size(); ++i) {
    const double length = std::hypot(sums[1][i], sums[2][i], sums[3][i]);
    if (sums[0][i] <= least_cover * sums[5][i] || length == 0.0) continue;
    constraints_[i] = {.weight = sums[0][i],
                       .normal = {sums[1][i] / length, sums[2][i] / length, sums[3][i] / length},
                       .gap = sums[4][i] / sums[0][i]};
  }
}

bool MortarForm::move_rigid_master(double time) {
  if (!points_.has_rigid_master() || time == rigid_time_) return false;
  rigid_time_ = time;
  const auto& moves = std::get<RigidMaster>(pair_.master).displacement;
  if (std::none_of(moves.begin(), moves.end(), [](const auto& move) { return move.has_value(); })) return false;
  points_.move_rigid_master(time);
  find_constraints();
  return true;
}

double MortarForm::share(std::int32_t facet, std::size_t corner) const {
  const auto& dual = facets_[facet].dual;
  return dual ? dual->integral[static_cast<Eigen::Index>(corner)] : 0.0;
}

std::vector<std::map<std::int32_t, double>> MortarForm::master_rows() const {
  std::vector<std::map<std::int32_t, double>> rows(nodes_.nodes.size());
  for (std::int32_t f = 0; f < slave().size(); ++f) {
    const auto& facet = facets_[f];
    const auto nodes = slave().facet(f);
    for (std::size_t i = facet.begin; facet.dual && i < facet.end; ++i) {
      const auto& point = points_.points()[i];
      if (point.master < 0) continue;
      const auto masters = points_.master()->nodes(point.master);
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        const double weight = constraints_[place_[nodes[k]]].weight;
        if (weight == 0.0) continue;
        const double part = point.weight * facet.dual->values(static_cast<Eigen::Index>(i - facet.begin), k) / weight;
        for (std::size_t b = 0; b < masters.size(); ++b)
          rows[place_[nodes[k]]][masters[b]] += part * point.master_shape[b];
      }
    }
  }
  return rows;
}

// --- at a state ------------------------------------------------------------------------------------------------------

/// Collective.
std::vector<double> MortarForm::nodal_gaps(const State& state) {
  if (points_.master()) points_.master()->refresh(state.unknowns);
  std::vector<std::vector<double>> sums(1, std::vector<double>(nodes_.nodes.size(), 0.0));
  for (std::int32_t f = 0; f < slave().size(); ++f) {
    const auto& facet = facets_[f];
    const auto nodes = slave().facet(f);
    for (std::size_t i = facet.begin; facet.dual && i < facet.end; ++i) {
      const auto& point = points_.points()[i];
      if (!is_covered(point)) continue;
      const auto jump = points_.displacement_jump(point, state);
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        const auto& normal = constraints_[place_[nodes[k]]].normal;
        const double along = jump[0] * normal[0] + jump[1] * normal[1] + jump[2] * normal[2];
        sums[0][place_[nodes[k]]] +=
            point.weight * facet.dual->values(static_cast<Eigen::Index>(i - facet.begin), k) * along;
      }
    }
  }
  const auto global = gap_space_.new_vector();
  gap_space_.add(sums, global);
  gap_space_.gather(global, sums);
  std::vector<double> gaps(nodes_.nodes.size(), no_gap);
  for (std::size_t i = 0; i < gaps.size(); ++i)
    if (constraints_[i].weight > 0.0) gaps[i] = constraints_[i].gap + sums[0][i] / constraints_[i].weight;
  return gaps;
}

ContactHistory MortarForm::accepted() const {
  ContactHistory history;
  history.multipliers = multipliers_old_;
  return history;
}

void MortarForm::add_residual(const State&, Residual& residual) {
  const int d = layout_.dim();
  std::vector<PetscInt> equations;
  std::vector<double> values;
  for (std::int32_t f = 0; f < slave().size(); ++f) {
    const auto& facet = facets_[f];
    const auto nodes = slave().facet(f);
    const bool is_loaded =
        std::any_of(nodes.begin(), nodes.end(), [&](std::int32_t node) { return multipliers_[place_[node]] != 0.0; });
    for (std::size_t i = facet.begin; is_loaded && facet.dual && i < facet.end; ++i) {
      const auto& point = points_.points()[i];
      if (!is_covered(point)) continue;
      std::array<double, 3> force{};
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        const auto at = place_[nodes[k]];
        const double part =
            point.weight * multipliers_[at] * facet.dual->values(static_cast<Eigen::Index>(i - facet.begin), k);
        for (int c = 0; c < 3; ++c)
          force[c] += part * constraints_[at].normal[c];
      }
      const auto shape = points_.slave_shape(point);
      for (std::size_t a = 0; a < nodes.size(); ++a)
        for (int c = 0; c < d; ++c)
          residual.nodal()[std::size_t(nodes[a]) * d + c] += force[c] * shape[a];
      if (point.master < 0) continue;
      equations.clear();
      values.clear();
      for (const auto node : points_.master()->nodes(point.master))
        for (int c = 0; c < d; ++c) {
          values.push_back(-force[c] * point.master_shape[equations.size() / d]);
          equations.push_back(points_.master()->equations(node)[c]);
        }
      residual.add(equations, values);
    }
  }
}

double MortarForm::work_of_displacement(const State& state) {
  const auto gaps = nodal_gaps(state);
  double work = 0.0;
  for (std::int32_t f = 0; f < slave().size(); ++f)
    for (std::size_t k = 0; k < slave().facet(f).size(); ++k) {
      const auto at = place_[slave().facet(f)[k]];
      if (multipliers_[at] < 0.0) work += share(f, k) * multipliers_[at] * (gaps[at] - constraints_[at].gap);
    }
  MPI_Allreduce(MPI_IN_PLACE, &work, 1, MPI_DOUBLE, MPI_SUM, layout_.mesh().comm);
  return work;
}

// --- reports ---------------------------------------------------------------------------------------------------------

/// A sample is a node of a slave facet with that facet's share of the node's weight. Summed up the samples are the
/// nodal forces of the formulation, in sum and in moment (∫ ψ_k x = D_k x_k), and none is tensile; the dual functions
/// themselves change sign inside a facet and would show tension there.
ContactSamples MortarForm::samples(const State& state) {
  const auto gaps = nodal_gaps(state);
  ContactSamples samples;
  for (std::int32_t f = 0; f < slave().size(); ++f) {
    const auto nodes = slave().facet(f);
    const std::size_t e = element_dim(slave().types[f]);
    const auto reference = reference_nodes(slave().types[f]);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const auto at = place_[nodes[k]];
      samples.facet.push_back(f);
      samples.xi.push_back({reference[k * e], e > 1 ? reference[k * e + 1] : 0.0});
      samples.place.push_back(facets_[f].places[k]);
      samples.normal.push_back(constraints_[at].normal);
      samples.weight.push_back(share(f, k));
      samples.facet_size.push_back(facets_[f].size);
      samples.pressure.push_back(multipliers_[at] < 0.0 ? -multipliers_[at] : 0.0);
      samples.gap.push_back(gaps[at]);
      samples.status.push_back(multipliers_[at] < 0.0 ? ContactStatus::Slip : ContactStatus::Open);
    }
  }
  for (std::size_t i = 0; i < nodes_.nodes.size(); ++i)
    if (layout_.mesh().is_vertex[nodes_.nodes[i]]) {
      samples.nodes.push_back(nodes_.nodes[i]);
      samples.nodal_pressure.push_back(-multipliers_[i]);
    }
  return samples;
}

ContactTotals MortarForm::totals(const State& state) {
  const auto gaps = nodal_gaps(state);
  double sums[7] = {}; // force, moment, area
  double largest[2] = {};
  for (std::int32_t f = 0; f < slave().size(); ++f)
    for (std::size_t k = 0; k < slave().facet(f).size(); ++k) {
      const auto at = place_[slave().facet(f)[k]];
      if (constraints_[at].weight > 0.0) largest[1] = std::max(largest[1], -gaps[at] / facets_[f].size);
      if (multipliers_[at] >= 0.0) continue;
      const auto& place = facets_[f].places[k];
      double force[3];
      for (int c = 0; c < 3; ++c)
        force[c] = -multipliers_[at] * share(f, k) * constraints_[at].normal[c];
      for (int c = 0; c < 3; ++c) {
        sums[c] += force[c];
        sums[3 + c] += place[(c + 1) % 3] * force[(c + 2) % 3] - place[(c + 2) % 3] * force[(c + 1) % 3];
      }
      sums[6] += share(f, k);
      largest[0] = std::max(largest[0], -multipliers_[at]);
    }
  MPI_Allreduce(MPI_IN_PLACE, sums, 7, MPI_DOUBLE, MPI_SUM, layout_.mesh().comm);
  MPI_Allreduce(MPI_IN_PLACE, largest, 2, MPI_DOUBLE, MPI_MAX, layout_.mesh().comm);
  ContactTotals totals;
  for (int c = 0; c < 3; ++c) {
    totals.force[c] = sums[c];
    totals.moment[c] = sums[3 + c];
  }
  totals.area = sums[6];
  totals.max_pressure = largest[0];
  totals.largest_penetration = largest[1];
  return totals;
}

} // namespace amontons
