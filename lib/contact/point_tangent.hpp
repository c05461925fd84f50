// The forces of one contact point in finite kinematics, and how they change with everything they depend on: the vectors
// of geometry/contact_kinematics and the interpolated multipliers.
#pragma once

#include "geometry/contact_kinematics.hpp"

#include <Eigen/Core>

namespace amontons {

/// Columns behind those of contact_slot: λ_n, three components of λ_t.
namespace point_column {
constexpr int lambda_n = contact_slot::count, lambda_t = lambda_n + 1, count = lambda_t + 3;
}
/// Rows: what is conjugate to δx, δs₁, δs₂, δρ, δm₁, δm₂, δm₁₁, δm₁₂, δm₂₂. (Second derivatives of the master's place
/// by ξ enter the variation of forces when the projection moves.)
namespace point_row {
constexpr int m_second = contact_slot::m + 6, count = m_second + 9;
}

using ScalarDerivative = Eigen::Matrix<double, 1, point_column::count>;
using VectorDerivative = Eigen::Matrix<double, 3, point_column::count>;
using PointForces = Eigen::Matrix<double, point_row::count, 1>;

/// Tractions at a point, on the sign convention of the virtual work ∫ σ δg + σ_t · δg_t, with derivatives. `weight`: of
/// its derivative only the relative one is kept.
struct PointTractions {
  Eigen::Vector3d normal;
  double gap = 0.0, weight = 0.0, sigma = 0.0;
  Eigen::Vector3d shear = Eigen::Vector3d::Zero();
  ScalarDerivative dsigma = ScalarDerivative::Zero();
  VectorDerivative dshear = VectorDerivative::Zero();
  ScalarDerivative stretch = ScalarDerivative::Zero(); // D weight / weight
};

struct PointTangent {
  PointTractions tractions;
  Eigen::Matrix<double, point_row::count, point_column::count> forces =
      Eigen::Matrix<double, point_row::count, point_column::count>::Zero();
};

/// Virtual work w (σ δg + σ_t · δg_t) with δg = n · (δx − δρ), δg_t = δx − δρ − g ω × n (derivation in the source
/// file).
PointForces point_forces(const PointTractions& tractions, const TurningSurface& turning);
PointTangent point_tangent(const PointTractions& tractions, const PointKinematics& kinematics);

} // namespace amontons
