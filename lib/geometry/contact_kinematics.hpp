// How gap, normal, place of the projection, slip and measure of one contact point change with the two surfaces that
// meet there, in their current configuration. Pure functions of a few vectors: those of the slave and the master at the
// point, whatever elements they come from. In 2D the second tangents are e_z and do not vary, so that one code serves
// both dimensions.
#pragma once

#include "math/element_type.hpp"

#include <Eigen/Core>
#include <span>
#include <variant>

namespace amontons {

/// The vectors on which a point depends, three rows or columns each: places and tangents of slave (x, s₁, s₂) and
/// master (ρ, m₁, m₂) at fixed ξ, and the present place of the old projection (ρ_old).
namespace contact_slot {
constexpr int x = 0, s = 3, rho = 9, m = 12, old_rho = 18, count = 21;
}

/// Derivatives with respect to those vectors.
using ScalarVariation = Eigen::Matrix<double, 1, contact_slot::count>;
using VectorVariation = Eigen::Matrix<double, 3, contact_slot::count>;
using XiVariation = Eigen::Matrix<double, 2, contact_slot::count>;
using TangentPair = Eigen::Matrix<double, 3, 2>;

/// A facet at ξ.
struct SurfacePoint {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  TangentPair tangents = TangentPair::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero(); // columns ∂²ρ/∂ξ₁², ∂²ρ/∂ξ₁∂ξ₂, ∂²ρ/∂ξ₂²
};
/// `nodes`: num_nodes(type) x dim positions.
SurfacePoint surface_point(ElementType type, std::span<const double> nodes, std::span<const double> xi);

/// What holds a projection in place, and so how it moves.
struct OnFacet {};
/// On an edge that runs along this direction in reference coordinates.
struct OnEdge {
  Eigen::Vector2d along;
};
struct OnCorner {};
/// Where the slave's normal meets the facet.
struct AlongSlaveNormal {};
/// A rigid shape, whose normal changes by `curvature` times the motion of the slave point.
struct OnRigidShape {
  Eigen::Matrix3d curvature;
};
using ProjectionHold = std::variant<OnFacet, OnEdge, OnCorner, AlongSlaveNormal, OnRigidShape>;

/// The surface with which the gap vector turns at fixed ξ, by δn = −Σ t^α (n · δt_α) where n is its normal: its dual
/// tangents t^α, where its tangents stand among the vectors, and their whole variation (with that of ξ).
struct TurningSurface {
  int slot = -1; // contact_slot::m or s; negative: none
  TangentPair dual = TangentPair::Zero();
  std::array<VectorVariation, 2> tangents{VectorVariation::Zero(), VectorVariation::Zero()};
};

struct PointKinematics {
  ScalarVariation gap = ScalarVariation::Zero();
  VectorVariation normal = VectorVariation::Zero();
  XiVariation xi = XiVariation::Zero(); // of the projection on the master
  TurningSurface turning;
};

/// Derivatives at a projection that has been found: x − ρ = gap · normal.
PointKinematics point_kinematics(const SurfacePoint& slave, const SurfacePoint& master, const ProjectionHold& hold,
                                 const Eigen::Vector3d& normal, double gap);

/// Relative change of the area |s₁ × s₂|.
ScalarVariation stretch_variation(const TangentPair& slave);

/// (1 − n ⊗ n) v and its derivative.
Eigen::Vector3d tangential_part(const Eigen::Vector3d& v, const Eigen::Vector3d& normal);
VectorVariation tangential_variation(const Eigen::Vector3d& v, const VectorVariation& dv, const Eigen::Vector3d& normal,
                                     const VectorVariation& dnormal);

/// The rotation with which a surface element has gone from old tangents to new ones, and the derivative of its spin: a
/// vector v = R v_old that goes with the element changes by spin × v.
struct SurfaceRotation {
  Eigen::Matrix3d rotation;
  VectorVariation spin; // of the slave: with respect to s₁, s₂
};
SurfaceRotation surface_rotation(const TangentPair& old, const TangentPair& now);

} // namespace amontons
