// Rigid obstacles given by formula: signed distance and normal of a plane, a ball, a cylinder.
#pragma once

#include <array>
#include <span>
#include <variant>

namespace amontons {

/// Half-space; `normal` (unit) points out of the rigid body.
struct RigidPlane {
  std::array<double, 3> point{};
  std::array<double, 3> normal{};
};
/// Ball (a disc in 2D).
struct RigidSphere {
  std::array<double, 3> centre{};
  double radius = 0.0;
};
/// Infinite circular cylinder along `axis` (unit); in 2D use RigidSphere.
struct RigidCylinder {
  std::array<double, 3> centre{};
  std::array<double, 3> axis{};
  double radius = 0.0;
};
using RigidShape = std::variant<RigidPlane, RigidSphere, RigidCylinder>;

struct RigidContact {
  double gap;                   // signed distance of x, positive outside the rigid body
  std::array<double, 3> normal; // unit, out of the rigid body: ∂gap/∂x
};

/// `shift`: the shape's displacement. x has dim coordinates.
RigidContact signed_distance(const RigidShape& shape, std::span<const double> shift, std::span<const double> x);

/// ∂normal/∂x, row by row: the second derivative of the gap. Not defined at the centre or on the axis, where it is
/// zero.
std::array<std::array<double, 3>, 3> normal_gradient(const RigidShape& shape, std::span<const double> shift,
                                                     std::span<const double> x);

} // namespace amontons
