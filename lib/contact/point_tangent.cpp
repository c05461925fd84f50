// Virtual slip. The slave point feels the traction t = σ n + σ_t at x, the master −t at ρ = x − g n: a gap leaves these
// two with a moment −g n × σ_t. What δg_t has to be is given by frame indifference: with the turning of the normal
// taken off,
//   δg_t = δx − δρ − g δn,   δn = −t^α (n · δt_α) at fixed ξ
// (t_α tangents of the surface that the normal belongs to), a rigid rotation does no work, so moments balance for any
// gap. On a facet of the master it is m^α A_αβ δξ^β with the matrix A of the closest-point projection, whose own slip
// m_α δξ^α differs by the curvature times the gap. At edges and corners, where only points with next to no gap carry
// shear, the normal has no surface of its own and δg_t = δx − δρ.
//
// Conjugate forces, w the weight:  x: w t,  ρ: −w t,  t_α: w g (t^α · σ_t) n.
// Their derivative has three parts: that of w; that of t, n, g and of the components
//   D (t^α · σ_t) = t^α · Dσ_t − (σ_t · t^β) (t^α · D t_β)          (σ_t · n = 0)
// and that of δρ and δm_α, which move over the master with ξ: δρ → δρ + δm_α Dξ_α, δm_α → δm_α + δm_αβ Dξ_β.
#include "contact/point_tangent.hpp"

namespace amontons {

namespace {

namespace at = contact_slot;
using Eigen::Vector3d;

VectorDerivative widened(const VectorVariation& variation) {
  VectorDerivative derivative = VectorDerivative::Zero();
  derivative.leftCols<at::count>() = variation;
  return derivative;
}

ScalarDerivative widened(const ScalarVariation& variation) {
  ScalarDerivative derivative = ScalarDerivative::Zero();
  derivative.leftCols<at::count>() = variation;
  return derivative;
}

/// Row of m_αβ.
int second_row(int a, int b) { return point_row::m_second + 3 * (a + b); }

} // namespace

PointForces point_forces(const PointTractions& tractions, const TurningSurface& turning) {
  const Vector3d t = tractions.sigma * tractions.normal + tractions.shear;
  PointForces forces = PointForces::Zero();
  forces.segment<3>(at::x) = t;
  forces.segment<3>(at::rho) = -t;
  for (int a = 0; a < 2 && turning.slot >= 0; ++a)
    forces.segment<3>(turning.slot + 3 * a) =
        tractions.gap * turning.dual.col(a).dot(tractions.shear) * tractions.normal;
  return tractions.weight * forces;
}

PointTangent point_tangent(const PointTractions& tractions, const PointKinematics& kinematics) {
  const auto& [normal, gap, weight, sigma, shear, dsigma, dshear, stretch] = tractions;
  const auto& turning = kinematics.turning;
  const VectorDerivative dnormal = widened(kinematics.normal);
  const ScalarDerivative dgap = widened(kinematics.gap);
  Eigen::Matrix<double, 2, point_column::count> dxi = Eigen::Matrix<double, 2, point_column::count>::Zero();
  dxi.leftCols<at::count>() = kinematics.xi;

  PointTangent tangent{.tractions = tractions};
  auto& rows = tangent.forces;
  const Vector3d t = sigma * normal + shear;
  const VectorDerivative dt = normal * dsigma + sigma * dnormal + dshear;
  rows.middleRows<3>(at::x) = dt;
  rows.middleRows<3>(at::rho) = -dt;
  for (int a = 0; a < 2; ++a)
    rows.middleRows<3>(at::m + 3 * a) -= t * dxi.row(a);
  for (int a = 0; a < 2 && turning.slot >= 0; ++a) {
    const Vector3d dual = turning.dual.col(a);
    const double component = dual.dot(shear);
    ScalarDerivative dcomponent = dual.transpose() * dshear;
    for (int b = 0; b < 2; ++b)
      dcomponent -= shear.dot(turning.dual.col(b)) * (dual.transpose() * widened(turning.tangents[b]));
    rows.middleRows<3>(turning.slot + 3 * a) +=
        normal * (component * dgap + gap * dcomponent) + gap * component * dnormal;
    for (int b = 0; b < 2 && turning.slot == at::m; ++b)
      rows.middleRows<3>(second_row(a, b)) += gap * component * normal * dxi.row(b);
  }
  rows *= weight;
  rows += point_forces(tractions, turning) * stretch;
  return tangent;
}

} // namespace amontons
