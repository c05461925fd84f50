// Virtual slip. The slave point feels the traction t = σ n + σ_t at x, the master −t at ρ = x − g n: a gap leaves these
// two with a moment g n × σ_t. What δg_t has to be is given by frame indifference: with the spin ω of a surface (that
// which the normal belongs to; at edges and corners of the master, where several facets meet, the slave) taken off,
//   δg_t = δx − δρ − g ω × n,
// a rigid rotation does no work, so moments balance for any gap. With tangents t_α, duals t^α and the normal ν of that
// surface, a rotation ω makes S = Σ t^α × δt_α = ω + ν (ν · ω), so
//   ω = S − ½ ν (ν · S),   σ_t · (ω × n) = S · ĉ,   c = n × σ_t,   ĉ = c − ½ ν (ν · c)
// Where n = ±ν this is δg_t = δx − δρ − g δn with δn = −t^α (n · δt_α) at fixed ξ. On a facet of the master that is
// m^α A_αβ δξ^β with the matrix A of the closest-point projection, whose own slip m_α δξ^α differs by the curvature
// times the gap. At edges and corners the gap vector could be taken off with its own turning, too; but then shear
// across the edge would do no work at all, and forces would vanish where a point passes from the facet to its edge.
//
// Conjugate forces, w the weight:  x: w t,  ρ: −w t,  t_α: −w g ĉ × t^α   (w g (t^α · σ_t) n where n = ±ν).
// Their derivative has three parts: that of w; that of t, n, g and of the surface,
//   D ν = −t^α (ν · D t_α),   D t^α = −t^β (t^α · D t_β) + ν (t^α · t^β) (ν · D t_β),
//   D ĉ = D c − ½ D ν (ν · c) − ½ ν (D ν · c + ν · D c);
// and that of δρ and δm_α, which move over the master with ξ: δρ → δρ + δm_α Dξ_α, δm_α → δm_α + δm_αβ Dξ_β.
#include "contact/point_tangent.hpp"

#include <Eigen/Geometry>

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

/// u × v, column by column.
VectorDerivative cross(const Vector3d& u, const VectorDerivative& v) {
  VectorDerivative product;
  for (int j = 0; j < v.cols(); ++j)
    product.col(j) = u.cross(Vector3d(v.col(j)));
  return product;
}

Vector3d normal_of(const TurningSurface& turning) {
  return turning.dual.col(0).cross(turning.dual.col(1)).normalized();
}

/// ĉ.
Vector3d spin_couple(const PointTractions& tractions, const Vector3d& nu) {
  const Vector3d couple = tractions.normal.cross(tractions.shear);
  return couple - 0.5 * nu * nu.dot(couple);
}

/// Derivatives of −g ĉ × t^α, α = 1, 2.
std::array<VectorDerivative, 2> turning_derivatives(const PointTractions& tractions, const TurningSurface& turning,
                                                    const VectorDerivative& dnormal, const ScalarDerivative& dgap) {
  const Vector3d nu = normal_of(turning), couple = tractions.normal.cross(tractions.shear);
  const std::array dtangent = {widened(turning.tangents[0]), widened(turning.tangents[1])};
  VectorDerivative dnu = VectorDerivative::Zero();
  for (int a = 0; a < 2; ++a)
    dnu -= turning.dual.col(a) * (nu.transpose() * dtangent[a]);
  const VectorDerivative dcouple = cross(tractions.normal, tractions.dshear) - cross(tractions.shear, dnormal);
  const VectorDerivative dspin =
      dcouple - 0.5 * nu.dot(couple) * dnu - 0.5 * nu * (couple.transpose() * dnu + nu.transpose() * dcouple);
  const Vector3d spin = spin_couple(tractions, nu);
  std::array<VectorDerivative, 2> derivatives;
  for (int a = 0; a < 2; ++a) {
    const Vector3d dual = turning.dual.col(a);
    VectorDerivative ddual = VectorDerivative::Zero();
    for (int b = 0; b < 2; ++b)
      ddual += -turning.dual.col(b) * (dual.transpose() * dtangent[b]) +
               nu * (dual.dot(turning.dual.col(b)) * (nu.transpose() * dtangent[b]));
    derivatives[a] = -spin.cross(dual) * dgap + tractions.gap * (cross(dual, dspin) - cross(spin, ddual));
  }
  return derivatives;
}

/// Row of m_αβ.
int second_row(int a, int b) { return point_row::m_second + 3 * (a + b); }

} // namespace

PointForces point_forces(const PointTractions& tractions, const TurningSurface& turning) {
  const Vector3d t = tractions.sigma * tractions.normal + tractions.shear;
  PointForces forces = PointForces::Zero();
  forces.segment<3>(at::x) = t;
  forces.segment<3>(at::rho) = -t;
  if (turning.slot >= 0) {
    const Vector3d couple = spin_couple(tractions, normal_of(turning));
    for (int a = 0; a < 2; ++a)
      forces.segment<3>(turning.slot + 3 * a) = -tractions.gap * couple.cross(Vector3d(turning.dual.col(a)));
  }
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
  if (turning.slot >= 0) {
    const auto derivatives = turning_derivatives(tractions, turning, dnormal, dgap);
    const Vector3d couple = spin_couple(tractions, normal_of(turning));
    for (int a = 0; a < 2; ++a) {
      rows.middleRows<3>(turning.slot + 3 * a) += derivatives[a];
      const Vector3d force = -gap * couple.cross(Vector3d(turning.dual.col(a)));
      for (int b = 0; b < 2 && turning.slot == at::m; ++b)
        rows.middleRows<3>(second_row(a, b)) += force * dxi.row(b);
    }
  }
  rows *= weight;
  rows += point_forces(tractions, turning) * stretch;
  return tangent;
}

} // namespace amontons
