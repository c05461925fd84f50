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

/// A place relative to the centre of a corner's rounding, across the edge: a n1 + b n2 with a = parts[0], b = parts[1].
/// Where both are positive the nearest point is on the rounding, elsewhere on the face that is farther in front.
struct AcrossEdge {
  std::array<double, 2> ahead; // n1 · r, n2 · r
  std::array<double, 2> parts;
  bool on_rounding() const { return parts[0] > 0.0 && parts[1] > 0.0; }
};

AcrossEdge across_edge(const RigidCorner& corner, const Vector& r) {
  const auto& [first, second] = corner.normals;
  const double k = dot(first, second), a = dot(first, r), b = dot(second, r), scale = 1.0 / (1.0 - k * k);
  return {{a, b}, {scale * (a - k * b), scale * (b - k * a)}};
}

RigidContact distance_to(const RigidCorner& corner, std::span<const double> shift, std::span<const double> x) {
  const auto place = across_edge(corner, relative(x, shift, corner.centre));
  const auto& [first, second] = corner.normals;
  if (!place.on_rounding()) {
    const std::size_t face = place.ahead[0] >= place.ahead[1] ? 0 : 1;
    return {place.ahead[face] - corner.radius, corner.normals[face]};
  }
  Vector r{};
  for (std::size_t i = 0; i < 3; ++i)
    r[i] = place.parts[0] * first[i] + place.parts[1] * second[i];
  return around(r, corner.radius, first);
}

RigidContact distance_to(const RigidRoundedBox& box, std::span<const double> shift, std::span<const double> x) {
  const auto place = place_at(box, relative(x, shift, box.point));
  return {place.gap, place.normal};
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

/// Direction of the edge (unit).
Vector edge(const RigidCorner& corner) {
  const auto& [a, b] = corner.normals;
  Vector result{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  const double length = std::hypot(result[0], result[1], result[2]);
  for (double& component : result)
    component /= length;
  return result;
}

/// ∂normal/∂x of each shape at x, where the contact is the given one.
struct NormalGradient {
  std::span<const double> shift, x;
  const RigidContact& contact;

  std::array<Vector, 3> operator()(const RigidPlane&) const { return {}; }
  std::array<Vector, 3> operator()(const RigidSphere& sphere) const { return turning(contact, sphere.radius, {}); }
  std::array<Vector, 3> operator()(const RigidCylinder& cylinder) const {
    return turning(contact, cylinder.radius, cylinder.axis);
  }
  std::array<Vector, 3> operator()(const RigidCorner& corner) const {
    if (!across_edge(corner, relative(x, shift, corner.centre)).on_rounding()) return {};
    return turning(contact, corner.radius, edge(corner));
  }
  std::array<Vector, 3> operator()(const RigidRoundedBox& box) const {
    return place_at(box, relative(x, shift, box.point)).normal_gradient;
  }
};

} // namespace

RigidCorner rounded_corner(const Vector& apex, const std::array<Vector, 2>& normals, double radius) {
  // n1 · (centre − apex) = n2 · (centre − apex) = −radius.
  const double depth = radius / (1.0 + dot(normals[0], normals[1]));
  RigidCorner corner{apex, normals, radius};
  for (std::size_t i = 0; i < 3; ++i)
    corner.centre[i] -= depth * (normals[0][i] + normals[1][i]);
  return corner;
}

std::array<std::array<double, 3>, 3> normal_gradient(const RigidShape& shape, std::span<const double> shift,
                                                     std::span<const double> x) {
  const auto contact = signed_distance(shape, shift, x);
  return std::visit(NormalGradient{shift, x, contact}, shape);
}

RigidContact signed_distance(const RigidShape& shape, std::span<const double> shift, std::span<const double> x) {
  return std::visit([&](const auto& kind) { return distance_to(kind, shift, x); }, shape);
}

} // namespace amontons
