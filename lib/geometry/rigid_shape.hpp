// Rigid obstacles given by formula: signed distance and normal of a plane, a ball, a cylinder, a rounded corner, a
// rounded box.
#pragma once

#include "geometry/rounded_box.hpp"

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
/// Two half-spaces' common part, convex, its edge rounded: the profile of a die or a punch. In 2D the edge is a point.
struct RigidCorner {
  std::array<double, 3> centre{};                 // of the rounding
  std::array<std::array<double, 3>, 2> normals{}; // of the two faces (unit, not parallel), out of the rigid body
  double radius = 0.0;
};
using RigidShape = std::variant<RigidPlane, RigidSphere, RigidCylinder, RigidCorner, RigidRoundedBox>;

/// The corner whose faces go through `apex`, a point of the edge that they would have without the rounding.
RigidCorner rounded_corner(const std::array<double, 3>& apex, const std::array<std::array<double, 3>, 2>& normals,
                           double radius);

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
