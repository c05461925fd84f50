// The part of ContactForm for finite kinematics: coupling that moves along, forces of the turning normal, tangent. With
// f_p the forces of a point on the vectors that it depends on (point_tangent) and N the shape values by which these
// come from nodes, the residual is Σ_p N^T f_p and the tangent Σ_p N^T (D f_p) N. Weights are current areas, so the
// tangent is unsymmetric also without friction: σ δg ⊗ D(weight) has no counterpart.
#include "contact/contact_form.hpp"

#include <Eigen/Geometry>

#include <algorithm>

namespace amontons {

namespace {

/// Points whose gap is below this many facet sizes get a place in the matrix before they touch.
constexpr double coupling_reach = 1.5;

/// The nodes of one facet (of its stencil): where their equations begin in a dense block, and which vectors of a point
/// the shape values of the table make of them, in rows and in columns (negative: none).
struct FacetPart {
  ShapeTable shape;
  std::ptrdiff_t first;
  std::array<int, 6> rows, columns;
};

constexpr std::array<int, 6> nothing = {-1, -1, -1, -1, -1, -1};
constexpr std::array<int, 6> of_slave = {contact_slot::x, contact_slot::s, contact_slot::s + 3, -1, -1, -1};
constexpr std::array<int, 6> of_master_columns = {contact_slot::rho, contact_slot::m, contact_slot::m + 3, -1, -1, -1};
constexpr std::array<int, 6> of_master_rows = {contact_slot::rho,   contact_slot::m,         contact_slot::m + 3,
                                               point_row::m_second, point_row::m_second + 3, point_row::m_second + 6};
constexpr std::array<int, 6> of_old = {contact_slot::old_rho, -1, -1, -1, -1, -1};

/// Derivatives with respect to a block's equations: of forces, sigma, shear and stretch, one below the other.
namespace spread_row {
constexpr int sigma = point_row::count, shear = sigma + 1, stretch = shear + 3, count = stretch + 1;
}
using Spread = Eigen::Matrix<double, spread_row::count, Eigen::Dynamic>;

Eigen::Vector3d vector(const std::array<double, 3>& v) { return Eigen::Vector3d(v[0], v[1], v[2]); }

} // namespace

std::vector<PetscInt> ContactForm::master_equations(std::int32_t facet) const {
  std::vector<PetscInt> equations;
  for (const auto node : points_.master()->stencil(facet)) {
    const auto of_node = points_.master()->equations(node);
    equations.insert(equations.end(), of_node.begin(), of_node.end());
  }
  return equations;
}

// --- coupling --------------------------------------------------------------------------------------------------------

/// A slave facet couples with the master facets that its near points meet, with where they come from and with the
/// facets around, so that the pattern lasts for a while. What has been left behind drops out.
void ContactForm::couple_near_now() {
  coupled_equations_.assign(points_.slave().size(), {});
  const auto& points = points_.points();
  const auto* path = tangential_ ? tangential_->path() : nullptr;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].master < 0 || (!active_[i] && gap_[i] > coupling_reach * points[i].size)) continue;
    auto& equations = coupled_equations_[points[i].facet];
    auto facets = points_.master()->neighbourhood(points[i].master);
    if (path && path->old_facet(i) >= 0) facets.push_back(path->old_facet(i));
    for (const auto facet : facets) {
      const auto of_facet = master_equations(facet);
      equations.insert(equations.end(), of_facet.begin(), of_facet.end());
    }
    std::sort(equations.begin(), equations.end());
    equations.erase(std::unique(equations.begin(), equations.end()), equations.end());
  }
}

bool ContactForm::all_coupled_now() const {
  const auto& points = points_.points();
  const auto* path = tangential_ ? tangential_->path() : nullptr;
  const auto is_in = [&](std::int32_t slave, std::int32_t master) {
    const auto& known = coupled_equations_[slave];
    const auto wanted = master_equations(master);
    return std::all_of(wanted.begin(), wanted.end(),
                       [&](PetscInt equation) { return std::binary_search(known.begin(), known.end(), equation); });
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!active_[i] || points[i].master < 0) continue;
    if (!is_in(points[i].facet, points[i].master)) return false;
    if (path && path->old_facet(i) >= 0 && !is_in(points[i].facet, path->old_facet(i))) return false;
  }
  return true;
}

void ContactForm::couple_now(Coupling& coupling) const {
  std::vector<PetscInt> equations;
  for (std::int32_t f = 0; f < points_.slave().size(); ++f) {
    gather_slave_equations(f, equations);
    equations.insert(equations.end(), coupled_equations_[f].begin(), coupled_equations_[f].end());
    coupling.add(equations);
  }
}

// --- forces and tangent ----------------------------------------------------------------------------------------------

/// Derivation: point_tangent.cpp. None without friction and where no facet turns the normal.
std::optional<ContactForm::TurningForces> ContactForm::turning_forces(std::size_t i) const {
  const auto& point = points_.points()[i];
  if (!tangential_ || !active_[i] || point.master < 0) return std::nullopt;
  const int d = layout_.dim();
  const auto& now = points_.now(i);
  const auto master = points_.master_at(point.master, now.xi);
  const auto turning = point_kinematics(now.slave, master, now.hold, vector(point.normal), gap_[i]).turning;
  if (turning.slot < 0) return std::nullopt;
  const PointTractions tractions{.normal = vector(point.normal),
                                 .gap = gap_[i],
                                 .weight = point.weight,
                                 .sigma = 0.0,
                                 .shear = vector(tangential_->traction(i))};
  const auto forces = point_forces(tractions, turning);
  TurningForces result{.on_slave = turning.slot == contact_slot::s, .values = {}};
  const auto shape = result.on_slave ? shape_table(points_.slave().types[point.facet], points_.xi(point))
                                     : points_.master()->shape_table(point.master, now.xi);
  result.values.assign(std::size_t(shape.cols()) * d, 0.0);
  for (int a = 0; a < shape.cols(); ++a)
    for (int c = 0; c < d; ++c)
      for (int k = 0; k < d - 1; ++k)
        result.values[a * d + c] += shape(1 + k, a) * forces[turning.slot + 3 * k + c];
  return result;
}

void ContactForm::add_turning_forces(const Group& group, Residual& residual) const {
  const std::size_t d = layout_.dim();
  const auto nodes = points_.slave().facet(group.facet);
  for (std::size_t i = group.begin; i < group.end; ++i) {
    const auto forces = turning_forces(i);
    if (!forces) continue;
    for (std::size_t k = 0; forces->on_slave && k < forces->values.size(); ++k)
      residual.nodal()[std::size_t(nodes[k / d]) * d + k % d] += forces->values[k];
    if (!forces->on_slave) residual.add(master_equations(group.master), forces->values);
  }
}

/// Work of the turning forces on the displacement itself.
double ContactForm::work_of_turning(const State& state) const {
  const std::size_t d = layout_.dim();
  double work = 0.0;
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const auto forces = turning_forces(i);
    if (!forces) continue;
    const auto& point = points_.points()[i];
    const auto slaves = points_.slave().facet(point.facet);
    const auto masters = points_.master()->stencil(point.master);
    for (std::size_t k = 0; k < forces->values.size(); ++k)
      work += forces->values[k] * (forces->on_slave ? state.displacement[std::size_t(slaves[k / d]) * d + k % d]
                                                    : points_.master()->displacement(masters[k / d])[k % d]);
  }
  return work;
}

/// Tractions, forces and their derivatives at a point in contact.
PointTangent ContactForm::tangent_at(std::size_t i, bool first_guess) const {
  namespace at = contact_slot;
  namespace column = point_column;
  const auto& point = points_.points()[i];
  const auto& now = points_.now(i);
  const Eigen::Vector3d normal = vector(point.normal);
  const auto master = point.master >= 0 ? points_.master_at(point.master, now.xi) : SurfacePoint{};
  const auto kinematics = point_kinematics(now.slave, master, now.hold, normal, gap_[i]);
  PointTractions tractions{.normal = normal, .gap = gap_[i], .weight = point.weight, .sigma = sigma(i)};
  tractions.stretch = stretch_at(i);
  tractions.dsigma.leftCols<at::count>() = point.epsilon * kinematics.gap;
  tractions.dsigma[column::lambda_n] = 1.0;
  if (!tangential_) return point_tangent(tractions, kinematics);

  const auto& response = tangential_->response(i);
  const auto& path = *tangential_->path();
  tractions.shear = vector(response.traction);
  const Eigen::Vector3d trial = vector(tangential_->carried(i)) + point.epsilon * path.moved(i);
  const Eigen::Vector3d kept = vector(tangential_->kept(i));
  VectorVariation dtrial = VectorVariation::Zero();
  const auto spin = path.rotation(i).spin;
  for (int j = 0; j < at::count; ++j)
    dtrial.col(j) = spin.col(j).cross(kept);
  if (path.old_facet(i) != ContactPoint::none) {
    dtrial.middleCols<3>(at::x) += point.epsilon * Eigen::Matrix3d::Identity();
    dtrial.middleCols<3>(at::old_rho) -= point.epsilon * Eigen::Matrix3d::Identity();
  }
  VectorDerivative dq = VectorDerivative::Zero();
  dq.leftCols<at::count>() = tangential_variation(trial, dtrial, normal, kinematics.normal);
  dq.middleCols<3>(column::lambda_t) = Eigen::Matrix3d::Identity() - normal * normal.transpose();
  const auto derivative = first_guess ? tangential_->guess(i) : response;
  Eigen::Matrix3d by_trial;
  for (int r = 0; r < 3; ++r)
    by_trial.row(r) = vector(derivative.dtraction_dq[r]).transpose();
  tractions.dshear = by_trial * dq;
  if (tangential_->is_pressed(i)) tractions.dshear -= vector(derivative.dtraction_dp) * tractions.dsigma;
  return point_tangent(tractions, kinematics);
}

/// Relative change of a point's weight: of its area and, around an axis, of its radius.
ScalarDerivative ContactForm::stretch_at(std::size_t i) const {
  const auto& slave = points_.now(i).slave;
  ScalarDerivative stretch = ScalarDerivative::Zero();
  stretch.leftCols<contact_slot::count>() = stretch_variation(slave.tangents);
  if (pair_.space == Space::Axisymmetric) stretch[contact_slot::x] += 1.0 / slave.place[0];
  return stretch;
}

void ContactForm::add_tangent_now(bool first_guess, Tangent& tangent) const {
  for (const auto& group : groups()) {
    const bool any_active =
        std::any_of(active_.begin() + static_cast<std::ptrdiff_t>(group.begin),
                    active_.begin() + static_cast<std::ptrdiff_t>(group.end), [](std::uint8_t a) { return a != 0; });
    if (!any_active && !is_unknown()) continue;
    DenseBlock block;
    gather_slave_equations(group.facet, block.equations);
    const auto type = points_.slave().types[group.facet];
    if (is_unknown()) {
      block.parts.normal_multipliers = std::ptrdiff_t(num_nodes(type)) * layout_.dim();
      if (tangential_) block.parts.tangential_multipliers = block.parts.normal_multipliers + num_vertices(type);
    }
    const auto append = [&](std::int32_t facet) -> std::ptrdiff_t {
      if (!any_active || facet < 0) return -1;
      const auto first = static_cast<std::ptrdiff_t>(block.equations.size());
      const auto of_facet = master_equations(facet);
      block.equations.insert(block.equations.end(), of_facet.begin(), of_facet.end());
      return first;
    };
    block.parts.master = append(group.master);
    block.old_master = append(group.old_master); // that may be the same facet: entries add up
    block.parts.size = block.equations.size();
    block.values.assign(block.parts.size * block.parts.size, 0.0);
    for (std::size_t i = group.begin; i < group.end; ++i)
      add_point_now(i, group, first_guess, block);
    tangent.add(block.equations, block.values);
  }
}

void ContactForm::add_point_now(std::size_t i, const Group& group, bool first_guess, DenseBlock& block) const {
  if (!active_[i] && !is_unknown()) return;
  const int d = layout_.dim();
  const auto& point = points_.points()[i];
  std::vector<FacetPart> parts = {
      {shape_table(points_.slave().types[point.facet], points_.xi(point)), 0, of_slave, of_slave}};
  PointTangent derivatives;
  if (active_[i]) {
    derivatives = tangent_at(i, first_guess);
    const auto* master = points_.master();
    if (group.master >= 0)
      parts.push_back({master->shape_table(group.master, points_.now(i).xi), block.parts.master, of_master_rows,
                       of_master_columns});
    if (group.old_master >= 0)
      parts.push_back(
          {master->shape_table(group.old_master, tangential_->path()->old(i).xi), block.old_master, nothing, of_old});
  } else {
    derivatives.tractions.stretch = stretch_at(i);
  }
  const auto& tractions = derivatives.tractions;
  Eigen::Matrix<double, spread_row::count, point_column::count> compact;
  compact << derivatives.forces, tractions.dsigma, tractions.dshear, tractions.stretch;

  Spread spread = Spread::Zero(spread_row::count, static_cast<Eigen::Index>(block.parts.size));
  for (const auto& part : parts)
    for (int a = 0; a < part.shape.cols(); ++a)
      for (int k = 0; k < 6; ++k)
        for (int c = 0; c < d && part.columns[k] >= 0; ++c)
          spread.col(part.first + a * d + c) += part.shape(k, a) * compact.col(part.columns[k] + c);
  const auto shape = points_.multiplier_shape(point);
  for (std::size_t a = 0; is_sought() && a < shape.size(); ++a) {
    spread.col(block.parts.normal_multipliers + a) += scale_ * shape[a] * compact.col(point_column::lambda_n);
    for (int c = 0; tangential_ && c < d; ++c)
      spread.col(block.parts.tangential_multipliers + a * d + c) +=
          scale_ * shape[a] * compact.col(point_column::lambda_t + c);
  }

  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> values(
      block.values.data(), spread.cols(), spread.cols());
  for (const auto& part : parts)
    for (int a = 0; active_[i] && a < part.shape.cols(); ++a)
      for (int k = 0; k < 6; ++k)
        for (int c = 0; c < d && part.rows[k] >= 0; ++c)
          values.row(part.first + a * d + c) += part.shape(k, a) * spread.row(part.rows[k] + c);
  if (!is_unknown()) return;
  // δμ_i: (s / ε) w N_i (σ − λ_i), likewise the components of the shear; held: (s / ε) w N_i (λ_i − s μ_i).
  const auto nodes = points_.slave().facet(point.facet);
  const double factor = scale_ / point.epsilon * point.weight;
  for (std::size_t a = 0; a < shape.size(); ++a) {
    const auto node = position_[nodes[a]];
    const auto add_row = [&](std::ptrdiff_t row, int source, double difference) {
      values.row(row) += factor * shape[a] * difference * spread.row(spread_row::stretch);
      if (is_sought()) values.row(row) += factor * shape[a] * spread.row(source);
      values(row, row) -= factor * scale_ * shape[a];
    };
    add_row(block.parts.normal_multipliers + a, spread_row::sigma, multiplier_defect_at(i, node));
    for (int c = 0; tangential_ && c < d; ++c)
      add_row(block.parts.tangential_multipliers + a * d + c, spread_row::shear + c,
              tangential_->multiplier_defect_at(i, c, node));
  }
}

} // namespace amontons
