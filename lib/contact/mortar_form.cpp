// Traction on the slave t = Σ_k (λ_k n_k + λ_t,k) ψ_k, λ_k <= 0: the force of node k on the slave is its vector times
// ∫ ψ_k N_k, at its place, because ∫ ψ_k N_a vanishes for the others; on the master the vector times P_kj D_k. Work is
// done on
//   gap_k = g_k + n_k · (c_k − Σ_j P_kj u_j),  P_kj = ∫ ψ_k N_j^master / D_k,
// and on the tangential part of that motion, whatever the number of ranks: each adds what its own points see.
//
// A node that cannot tell the contact force from that of a support is left out (leave_out): the other nodes of its
// facets take its function ψ over, and their multipliers with it. It then moves like a node of the master: with
// X_jk = ∫ ψ_j N_k / D_j, where k is left out,
//   gap_j · ∫ ψ_j / D_j = ... + n_j · (c_j + Σ_k X_jk c_k − Σ P_jm u_m),
// and the force λ_j ∫ ψ_j acts on both: the cross point modification of mortar methods (B. I. Wohlmuth, Discretization
// Methods and Iterative Solvers Based on Domain Decomposition, Springer 2001, section 1.2).
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
      constraint_space_(layout.mesh(), std::vector<NodeField>(9, nodes_)), gap_space_(layout.mesh(), {nodes_}) {
  for (std::size_t i = 0; i < nodes_.nodes.size(); ++i)
    place_[nodes_.nodes[i]] = static_cast<std::int32_t>(i);
  multipliers_.assign(nodes_.nodes.size(), 0.0);
  multipliers_old_ = multipliers_;
  left_out_.assign(nodes_.nodes.size(), 0);
  find_facets();
  divide_into_parts();
  find_constraints();
  if (pair_.friction)
    friction_ = std::make_unique<NodalFriction>(
        layout_, pair_, nodes_, points_.has_rigid_master() ? points_.rigid_shift() : std::array<double, 3>{});
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
  std::vector<std::vector<double>> sums(9, std::vector<double>(nodes_.nodes.size(), 0.0));
  for (std::int32_t f = 0; f < slave().size(); ++f) {
    const auto& facet = facets_[f];
    const auto nodes = slave().facet(f);
    const auto whole = whole_integrals(f);
    const auto shape = control_shape(f);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const auto at = place_[nodes[k]];
      sums[5][at] += whole[k];
      if (!facet.dual || left_out_[at]) continue;
      sums[0][at] += facet.dual->integral[k];
      for (std::size_t i = facet.begin; i < facet.end; ++i) {
        if (!is_covered(points[i])) continue;
        const auto row = static_cast<Eigen::Index>(i - facet.begin);
        const double part = points[i].weight * shape(row, k);
        for (int c = 0; c < 3; ++c)
          sums[1 + c][at] += part * points[i].normal[c];
        sums[6][at] += part * points[i].epsilon;
        sums[7][at] += part * facet.size;
        sums[4][at] += points[i].weight * facet.dual->values(row, k) * points[i].gap0;
      }
    }
  }
  for (const auto& part : parts_)
    sums[8][part.multiplier] += part.area;
  const auto global = constraint_space_.new_vector();
  constraint_space_.add(sums, global);
  constraint_space_.gather(global, sums);
  constraints_.assign(nodes_.nodes.size(), {});
  for (std::size_t i = 0; i < constraints_.size(); ++i) {
    const double length = std::hypot(sums[1][i], sums[2][i], sums[3][i]);
    if (sums[0][i] <= least_cover * sums[5][i] || length == 0.0) continue;
    constraints_[i] = {.weight = sums[0][i],
                       .area = sums[8][i],
                       .normal = {sums[1][i] / length, sums[2][i] / length, sums[3][i] / length},
                       .gap = sums[4][i] / sums[8][i],
                       .epsilon = sums[6][i] / sums[0][i],
                       .size = sums[7][i] / sums[0][i]};
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

void MortarForm::divide_into_parts() {
  parts_.clear();
  for (std::int32_t f = 0; f < slave().size(); ++f) {
    const auto nodes = slave().facet(f);
    std::vector<std::int32_t> left;
    for (const auto node : nodes)
      if (!left_out_[place_[node]]) left.push_back(place_[node]);
    for (std::int32_t k = 0; k < std::ssize(nodes); ++k) {
      const auto place = place_[nodes[k]];
      const double area = facets_[f].dual ? facets_[f].dual->integral[k] : 0.0;
      if (area == 0.0 || !left_out_[place])
        parts_.push_back({f, k, place, area});
      else
        for (const auto other : left)
          parts_.push_back({f, k, other, area / static_cast<double>(left.size())});
    }
  }
}

std::vector<std::int32_t> MortarForm::leave_out(const std::vector<std::uint8_t>& places) {
  left_out_ = places;
  std::vector<std::int32_t> bare;
  for (std::int32_t f = 0; f < slave().size(); ++f) {
    auto& facet = facets_[f];
    if (!facet.dual) continue;
    const auto nodes = slave().facet(f);
    std::vector<Eigen::Index> out, left;
    for (std::size_t k = 0; k < nodes.size(); ++k)
      (left_out_[place_[nodes[k]]] ? out : left).push_back(static_cast<Eigen::Index>(k));
    if (left.empty()) {
      facet.dual.reset();
      bare.push_back(f);
      continue;
    }
    const double share = 1.0 / static_cast<double>(left.size());
    for (const auto k : out) {
      for (const auto j : left)
        facet.dual->values.col(j) += share * facet.dual->values.col(k);
      facet.dual->values.col(k).setZero();
    }
  }
  divide_into_parts();
  find_constraints();
  return bare;
}

/// ∫ ψ_j N_k = share · ∫ N_k for a node k that is left out; its control in terms of nodal values.
std::vector<MortarForm::LeftOut> MortarForm::left_out_rows() const {
  std::vector<LeftOut> rows;
  for (std::int32_t f = 0; f < slave().size(); ++f) {
    const auto& dual = facets_[f].dual;
    if (!dual) continue;
    const auto nodes = slave().facet(f);
    const auto count = static_cast<double>(
        std::count_if(nodes.begin(), nodes.end(), [&](std::int32_t node) { return !left_out_[place_[node]]; }));
    const auto& controls = controls_from_nodes(slave().types[f]);
    for (const auto node : nodes) {
      const double weight = constraints_[place_[node]].weight;
      if (weight == 0.0) continue;
      for (std::size_t k = 0; k < nodes.size(); ++k)
        for (std::size_t a = 0; left_out_[place_[nodes[k]]] && a < nodes.size(); ++a)
          if (controls(k, a) != 0.0)
            rows.push_back({place_[node], nodes[a], dual->integral[k] / count / weight * controls(k, a)});
    }
  }
  return rows;
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
    if (constraints_[i].weight > 0.0) gaps[i] = constraints_[i].gap + sums[0][i] / constraints_[i].area;
  return gaps;
}

ContactHistory MortarForm::accepted() const {
  ContactHistory history;
  history.multipliers = multipliers_old_;
  if (friction_) friction_->save(history);
  return history;
}

void MortarForm::restore(const ContactHistory& history) {
  multipliers_ = multipliers_old_ = history.multipliers;
  if (friction_) friction_->restore(history);
}

void MortarForm::commit(const State& state) {
  multipliers_old_ = multipliers_;
  if (friction_) friction_->commit(state.time);
}

void MortarForm::roll_back() {
  multipliers_ = multipliers_old_;
  if (friction_) friction_->roll_back();
}

void MortarForm::hold_friction(const NodalFriction::Claim& claim) {
  std::vector<double> epsilon;
  for (const auto& constraint : constraints_)
    epsilon.push_back(constraint.epsilon);
  friction_->hold(claim, multipliers_, epsilon);
}

void MortarForm::release() {
  multipliers_.assign(multipliers_.size(), 0.0);
  if (friction_) friction_->release();
}

/// What a node's multipliers exert on the slave's motion.
std::array<double, 3> MortarForm::traction(std::size_t place) const {
  auto traction = constraints_[place].normal;
  for (int c = 0; c < 3; ++c)
    traction[c] = multipliers_[place] * traction[c] + (friction_ ? friction_->traction(place)[c] : 0.0);
  return traction;
}

bool MortarForm::is_loaded(std::int32_t facet) const {
  const auto nodes = slave().facet(facet);
  return facets_[facet].dual &&
         std::any_of(nodes.begin(), nodes.end(), [&](std::int32_t node) { return multipliers_[place_[node]] != 0.0; });
}

void MortarForm::add_residual(const State&, Residual& residual) {
  const int d = layout_.dim();
  std::vector<PetscInt> equations;
  std::vector<double> values;
  for (std::int32_t f = 0; f < slave().size(); ++f) {
    const auto& facet = facets_[f];
    const auto nodes = slave().facet(f);
    if (!is_loaded(f)) continue;
    for (std::size_t i = facet.begin; i < facet.end; ++i) {
      const auto& point = points_.points()[i];
      if (!is_covered(point)) continue;
      std::array<double, 3> force{};
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        const auto exerted = traction(place_[nodes[k]]);
        const double part = point.weight * facet.dual->values(static_cast<Eigen::Index>(i - facet.begin), k);
        for (int c = 0; c < 3; ++c)
          force[c] += part * exerted[c];
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

TangentialSums MortarForm::friction_sums() const {
  TangentialSums sums;
  if (!friction_) return sums;
  const auto shift = points_.has_rigid_master() ? points_.rigid_shift() : std::array<double, 3>{};
  for (const auto& part : parts_)
    friction_->add_to(part.multiplier, part.area, shift, sums);
  return sums;
}

double MortarForm::work_of_displacement(const State& state) {
  const auto gaps = nodal_gaps(state);
  double work = friction_sums().work;
  for (const auto& part : parts_) {
    const auto at = part.multiplier;
    if (multipliers_[at] < 0.0) work += part.area * multipliers_[at] * (gaps[at] - constraints_[at].gap);
  }
  MPI_Allreduce(MPI_IN_PLACE, &work, 1, MPI_DOUBLE, MPI_SUM, layout_.mesh().comm);
  return work;
}

// --- reports ---------------------------------------------------------------------------------------------------------

/// A sample is a part: a node of a slave facet with that facet's share of the node's area. Summed up the samples are
/// the nodal forces of the formulation, in sum and in moment (∫ ψ_k x = D_k x_k), and none is tensile; the dual
/// functions themselves change sign inside a facet and would show tension there.
ContactSamples MortarForm::samples(const State& state) {
  const auto gaps = nodal_gaps(state);
  ContactSamples samples;
  if (friction_) {
    const auto names = state_names(pair_.friction->law);
    samples.has_friction = true;
    samples.state_names.assign(names.begin(), names.end());
    samples.states.assign(names.size(), {});
  }
  for (const auto& [f, corner, at, area] : parts_) {
    const std::size_t e = element_dim(slave().types[f]), k = corner;
    const auto reference = reference_nodes(slave().types[f]);
    samples.facet.push_back(f);
    samples.xi.push_back({reference[k * e], e > 1 ? reference[k * e + 1] : 0.0});
    samples.place.push_back(facets_[f].places[k]);
    samples.normal.push_back(constraints_[at].normal);
    samples.weight.push_back(area);
    samples.facet_size.push_back(facets_[f].size);
    samples.pressure.push_back(multipliers_[at] < 0.0 ? -multipliers_[at] : 0.0);
    samples.gap.push_back(gaps[at]);
    samples.status.push_back(friction_                ? friction_->status(at)
                             : multipliers_[at] < 0.0 ? ContactStatus::Slip
                                                      : ContactStatus::Open);
    if (friction_) friction_->sample(at, samples);
  }
  const auto pressure = nodal_pressure();
  for (std::size_t i = 0; i < nodes_.nodes.size(); ++i)
    if (layout_.mesh().is_vertex[nodes_.nodes[i]]) {
      samples.nodes.push_back(nodes_.nodes[i]);
      samples.nodal_pressure.push_back(pressure[i]);
    }
  return samples;
}

/// A node's own, or the mean of what its neighbours carry for it. Collective.
std::vector<double> MortarForm::nodal_pressure() const {
  std::vector<std::vector<double>> sums(2, std::vector<double>(nodes_.nodes.size(), 0.0));
  for (const auto& part : parts_) {
    const auto at = place_[slave().facet(part.facet)[part.corner]];
    sums[0][at] -= part.area * multipliers_[part.multiplier];
    sums[1][at] += part.area;
  }
  const NodeSpace space(layout_.mesh(), std::vector<NodeField>(2, nodes_));
  const auto global = space.new_vector();
  space.add(sums, global);
  space.gather(global, sums);
  for (std::size_t i = 0; i < sums[0].size(); ++i)
    sums[0][i] = left_out_[i] && sums[1][i] > 0.0 ? sums[0][i] / sums[1][i] : -multipliers_[i];
  return sums[0];
}

ContactTotals MortarForm::totals(const State& state) {
  const auto gaps = nodal_gaps(state);
  double sums[16] = {}; // force, moment, area, open area; with friction its force and sums
  double largest[2] = {};
  for (const auto& [f, corner, at, area] : parts_) {
    if (constraints_[at].weight > 0.0) largest[1] = std::max(largest[1], -gaps[at] / facets_[f].size);
    if (multipliers_[at] >= 0.0) {
      sums[7] += area;
      continue;
    }
    const auto& place = facets_[f].places[corner];
    const auto exerted = traction(at);
    double force[3];
    for (int c = 0; c < 3; ++c)
      force[c] = -area * exerted[c];
    for (int c = 0; c < 3; ++c) {
      sums[c] += force[c];
      sums[3 + c] += place[(c + 1) % 3] * force[(c + 2) % 3] - place[(c + 2) % 3] * force[(c + 1) % 3];
      if (friction_) sums[8 + c] -= area * friction_->traction(at)[c];
    }
    sums[6] += area;
    largest[0] = std::max(largest[0], -multipliers_[at]);
  }
  const auto friction = friction_sums();
  sums[11] = friction.stick_area;
  sums[12] = friction.slip_area;
  sums[13] = friction.dissipation;
  sums[14] = friction.mismatch;
  sums[15] = friction.change;
  MPI_Allreduce(MPI_IN_PLACE, sums, 16, MPI_DOUBLE, MPI_SUM, layout_.mesh().comm);
  MPI_Allreduce(MPI_IN_PLACE, largest, 2, MPI_DOUBLE, MPI_MAX, layout_.mesh().comm);
  ContactTotals totals;
  for (int c = 0; c < 3; ++c) {
    totals.force[c] = sums[c];
    totals.moment[c] = sums[3 + c];
    totals.tangential_force[c] = sums[8 + c];
  }
  totals.area = sums[6];
  totals.max_pressure = largest[0];
  totals.largest_penetration = largest[1];
  if (!friction_) return totals;
  totals.open_area = sums[7];
  totals.stick_area = sums[11];
  totals.slip_area = sums[12];
  totals.dissipation = sums[13];
  totals.path_error = std::abs(sums[14]) + sums[15];
  return totals;
}

} // namespace amontons
