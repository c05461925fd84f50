#include "geometry/rigid_shape.hpp"

#include <cmath>
#include <cstddef>

namespace amontons {

namespace {

using Vector = std::array<double, 3>;

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// x - shift - origin: the position relative to a point of the moved shape, missing coordinates zero.
Vector relative(std::span<const double> x, std::span<const double> shift, const Vector& origin) {
  Vector result{};
  for (std::size_t i = 0; i < x.size(); ++i)
    result[i] = x[i] - (i < shift.size() ? shift[i] : 0.0) - origin[i];
  return result;
}

/// Distance |r| - radius and its gradient r/|r|. Where r vanishes the gradient does not exist; `fallback` stands in.
RigidContact around(const Vector& r, double radius, const Vector& fallback) {
  const double length = std::hypot(r[0], r[1], r[2]);
  if (length == 0.0) return {-radius, fallback};
  return {length - radius, {r[0] / length, r[1] / length, r[2] / length}};
}

/// A unit vector orthogonal to `axis`.
Vector across(const Vector& axis) {
  // The coordinate direction least aligned with the axis keeps the difference away from zero.
  std::size_t least = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (std::abs(axis[i]) < std::abs(axis[least])) least = i;
  Vector result{};
  for (std::size_t i = 0; i < 3; ++i)
    result[i] = (i == least ? 1.0 : 0.0) - axis[least] * axis[i];
  const double length = std::hypot(result[0], result[1], result[2]);
  for (double& component : result)
    component /= length;
  return result;
}

RigidContact distance_to(const RigidPlane& plane, std::span<const double> shift, std::span<const double> x) {
  return {dot(relative(x, shift, plane.point), plane.normal), plane.normal};
}

RigidContact distance_to(const RigidSphere& sphere, std::span<const double> shift, std::span<const double> x) {
  return around(relative(x, shift, sphere.centre), sphere.radius, {1.0, 0.0, 0.0});
}

RigidContact distance_to(const RigidCylinder& cylinder, std::span<const double> shift, std::span<const double> x) {
  Vector r = relative(x, shift, cylinder.centre);
  const double along = dot(r, cylinder.axis);
  for (std::size_t i = 0; i < 3; ++i)
    r[i] -= along * cylinder.axis[i];
  return around(r, cylinder.radius, across(cylinder.axis));
}

/// Distance from the centre or the axis, with `axis` zero for a ball: the normal turns by (1 − n ⊗ n − a ⊗ a) / r.
std::array<Vector, 3> turning(const RigidContact& contact, double radius, const Vector& axis) {
  const double r = contact.gap + radius;
  std::array<Vector, 3> gradient{};
  if (r <= 0.0) return gradient;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      gradient[i][j] = ((i == j ? 1.0 : 0.0) - contact.normal[i] * contact.normal[j] - axis[i] * axis[j]) / r;
  return gradient;
}

std::array<Vector, 3> gradient_of(const RigidPlane&, const RigidContact&) { return {}; }
std::array<Vector, 3> gradient_of(const RigidSphere& sphere, const RigidContact& contact) {
  return turning(contact, sphere.radius, {});
}
std::array<Vector, 3> gradient_of(const RigidCylinder& cylinder, const RigidContact& contact) {
  return turning(contact, cylinder.radius, cylinder.axis);
}

} // namespace

std::array<std::array<double, 3>, 3> normal_gradient(const RigidShape& shape, std::span<const double> shift,
                                                     std::span<const double> x) {
  const auto contact = signed_distance(shape, shift, x);
  return std::visit([&](const auto& kind) { return gradient_of(kind, contact); }, shape);
}

RigidContact signed_distance(const RigidShape& shape, std::span<const double> shift, std::span<const double> x) {
  return std::visit([&](const auto& kind) { return distance_to(kind, shift, x); }, shape);
}

} // namespace amontons
