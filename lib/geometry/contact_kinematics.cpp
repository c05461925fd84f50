// Derivation. D is the derivative with all ξ following, δ that at fixed ξ; P = 1 − n ⊗ n, r = x − ρ = g n.
//
// On a facet m_α · r = 0. Differentiated, with D m_α = δm_α + m_αβ Dξ_β and Dρ = δρ + m_α Dξ_α,
//   (m_α · m_β − g n · m_αβ) Dξ_β = m_α · (Dx − δρ) + g n · δm_α
//   Dg = n · (Dx − δρ),   Dn = −m^α (n · D m_α)
// On an edge ξ = ξ₀ + τ η with t = τ_α m_α, t' = τ_α τ_β m_αβ, and at a corner Dξ = 0; n is the direction of r:
//   (t · t − g n · t') Dη = t · (Dx − δρ) + g n · τ_α δm_α,   Dn = P (Dx − δρ − t Dη) / g
// Along the slave's normal, n = −n_s, Dn = −s^α (n · Ds_α), and r = g n gives three equations for Dξ and Dg:
//   m_α Dξ_α + n Dg = Dx − δρ − g Dn
//
// A surface element turns with the polar rotation of its tangents, F = s_α ⊗ s_old^α: it does not depend on how the
// facet's nodes are numbered. With an orthonormal old frame a₁, a₂ and b_i = F a_i, the rotation takes a₁ to the
// direction of d = b₁ + b₂ × n (the angle of the polar decomposition in the plane) and a₃ to n. Its spin is
//   n × Dn + n (e₂ · Dd) / |d|,   e₂ · Dd = e₂ · Db₁ − e₁ · Db₂
// for b₂ × Dn lies along n.
#include "geometry/contact_kinematics.hpp"

#include "geometry/facet_map.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace amontons {

namespace {

namespace at = contact_slot;
using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

TangentPair dual_of(const TangentPair& tangents) {
  return tangents * Matrix2d(tangents.transpose() * tangents).inverse();
}

Matrix3d across(const Vector3d& normal) { return Matrix3d::Identity() - normal * normal.transpose(); }

/// −t^α (n · dt_α).
VectorVariation normal_variation(const TurningSurface& turning, const Vector3d& normal) {
  VectorVariation variation = VectorVariation::Zero();
  for (int a = 0; a < 2; ++a)
    variation -= turning.dual.col(a) * (normal.transpose() * turning.tangents[a]);
  return variation;
}

/// n · (Dx − δρ).
void set_gap_on_master(PointKinematics& point, const Vector3d& normal) {
  point.gap.segment<3>(at::x) = normal.transpose();
  point.gap.segment<3>(at::rho) = -normal.transpose();
}

struct Kinematics {
  const SurfacePoint &slave, &master;
  const Vector3d& normal;
  double gap;

  void turn_with_slave(PointKinematics& point) const {
    point.turning.slot = at::s;
    point.turning.dual = dual_of(slave.tangents);
    for (int a = 0; a < 2; ++a)
      point.turning.tangents[a].middleCols<3>(at::s + 3 * a).setIdentity();
  }

  PointKinematics operator()(const OnFacet&) const {
    const auto& m = master.tangents;
    PointKinematics point;
    set_gap_on_master(point, normal);
    Matrix2d metric = m.transpose() * m, bent;
    const Vector3d curvature = master.second.transpose() * normal; // n · (m₁₁, m₁₂, m₂₂)
    bent << curvature[0], curvature[1], curvature[1], curvature[2];
    XiVariation side = XiVariation::Zero();
    side.middleCols<3>(at::x) = m.transpose();
    side.middleCols<3>(at::rho) = -m.transpose();
    for (int a = 0; a < 2; ++a)
      side.block<1, 3>(a, at::m + 3 * a) = gap * normal.transpose();
    point.xi = Matrix2d(metric - gap * bent).inverse() * side;
    point.turning.slot = at::m;
    point.turning.dual = m * metric.inverse();
    for (int a = 0; a < 2; ++a) {
      auto& tangent = point.turning.tangents[a];
      tangent.middleCols<3>(at::m + 3 * a).setIdentity();
      tangent += master.second.col(a) * point.xi.row(0) + master.second.col(a + 1) * point.xi.row(1);
    }
    point.normal = normal_variation(point.turning, normal);
    return point;
  }

  PointKinematics operator()(const OnEdge& edge) const {
    const auto& tau = edge.along;
    const Vector3d t = master.tangents * tau;
    const Vector3d bend = master.second * Vector3d(tau[0] * tau[0], 2.0 * tau[0] * tau[1], tau[1] * tau[1]);
    ScalarVariation side = ScalarVariation::Zero();
    side.segment<3>(at::x) = t.transpose();
    side.segment<3>(at::rho) = -t.transpose();
    for (int a = 0; a < 2; ++a)
      side.segment<3>(at::m + 3 * a) = gap * tau[a] * normal.transpose();
    PointKinematics point;
    set_gap_on_master(point, normal);
    point.xi = tau * (side / (t.squaredNorm() - gap * normal.dot(bend)));
    turn_with_slave(point);
    VectorVariation moved = -master.tangents * point.xi;
    moved.middleCols<3>(at::x) += Matrix3d::Identity();
    moved.middleCols<3>(at::rho) -= Matrix3d::Identity();
    point.normal = across(normal) * moved / gap;
    return point;
  }

  PointKinematics operator()(const OnCorner&) const {
    PointKinematics point;
    set_gap_on_master(point, normal);
    turn_with_slave(point);
    point.normal.middleCols<3>(at::x) = across(normal) / gap;
    point.normal.middleCols<3>(at::rho) = -across(normal) / gap;
    return point;
  }

  PointKinematics operator()(const AlongSlaveNormal&) const {
    PointKinematics point;
    turn_with_slave(point);
    point.normal = normal_variation(point.turning, normal);
    VectorVariation side = -gap * point.normal;
    side.middleCols<3>(at::x) += Matrix3d::Identity();
    side.middleCols<3>(at::rho) -= Matrix3d::Identity();
    Matrix3d directions;
    directions << master.tangents, normal;
    const VectorVariation solution = directions.inverse() * side;
    point.xi = solution.topRows<2>();
    point.gap = solution.row(2);
    return point;
  }

  PointKinematics operator()(const OnRigidShape& shape) const {
    PointKinematics point;
    point.gap.segment<3>(at::x) = normal.transpose();
    point.normal.middleCols<3>(at::x) = shape.curvature;
    return point;
  }
};

} // namespace

SurfacePoint surface_point(ElementType type, std::span<const double> nodes, std::span<const double> xi) {
  SurfacePoint point;
  if (element_dim(type) == 1) {
    const auto curve = facet::segment_curve(type, nodes);
    point.place.head<2>() = curve.position(xi[0]);
    point.tangents.col(0).head<2>() = curve.tangent(xi[0]);
    point.tangents(2, 1) = 1.0;
    point.second.col(0).head<2>() = 2.0 * curve.c;
    return point;
  }
  const facet::Surface surface(type, nodes);
  const facet::Xi place(xi[0], xi[1]);
  return {surface.position(place), surface.tangents(place), surface.second_derivatives(place)};
}

PointKinematics point_kinematics(const SurfacePoint& slave, const SurfacePoint& master, const ProjectionHold& hold,
                                 const Eigen::Vector3d& normal, double gap) {
  return std::visit(Kinematics{slave, master, normal, gap}, hold);
}

ScalarVariation stretch_variation(const TangentPair& slave) {
  const TangentPair dual = dual_of(slave);
  ScalarVariation variation = ScalarVariation::Zero();
  for (int a = 0; a < 2; ++a)
    variation.segment<3>(at::s + 3 * a) = dual.col(a).transpose();
  return variation;
}

Eigen::Vector3d tangential_part(const Eigen::Vector3d& v, const Eigen::Vector3d& normal) {
  return v - normal * normal.dot(v);
}

VectorVariation tangential_variation(const Eigen::Vector3d& v, const VectorVariation& dv, const Eigen::Vector3d& normal,
                                     const VectorVariation& dnormal) {
  return across(normal) * dv - normal.dot(v) * dnormal - normal * (v.transpose() * dnormal);
}

SurfaceRotation surface_rotation(const TangentPair& old, const TangentPair& now) {
  Matrix3d before, after;
  before.col(0) = old.col(0).normalized();
  before.col(2) = old.col(0).cross(old.col(1)).normalized();
  before.col(1) = before.col(2).cross(before.col(0));
  const Matrix2d parts = dual_of(old).transpose() * before.leftCols<2>(); // b_i = Σ s_α parts(α, i)
  const TangentPair b = now * parts;
  const Vector3d n = now.col(0).cross(now.col(1)).normalized();
  const Vector3d b1 = b.col(0), b2 = b.col(1), d = b1 + b2.cross(n);
  const Vector3d e1 = d.normalized(), e2 = n.cross(e1);
  after << e1, e2, n;
  SurfaceRotation result{after * before.transpose(), VectorVariation::Zero()};
  const TangentPair dual = dual_of(now);
  for (int a = 0; a < 2; ++a) {
    const Vector3d dual_a = dual.col(a);
    const Vector3d in_plane = (parts(a, 0) * e2 - parts(a, 1) * e1) / d.norm();
    result.spin.middleCols<3>(at::s + 3 * a) = -n.cross(dual_a) * n.transpose() + n * in_plane.transpose();
  }
  return result;
}

} // namespace amontons
