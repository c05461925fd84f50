#include "geometry/rounded_box.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace amontons {

namespace {

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

/// Signed distance from a rounded rectangle in its plane, negative inside, with its derivatives.
struct Outline {
  double distance;
  Vector gradient;
  Matrix hessian;
};

/// The rectangle is that of the corners' centres, grown by the corner radius. Where a side of it has no length, as in a
/// circle, every place belongs to a corner: hence `<`, not `<=`, where a corner begins.
Outline outline_at(const RigidRoundedBox& box, const Vector& r) {
  const Vector first(box.side.data()), second = Vector(box.normal.data()).cross(first);
  const double u = r.dot(first), v = r.dot(second);
  const double along = std::abs(u) - (box.half_width[0] - box.corner_radius);
  const double across = std::abs(v) - (box.half_width[1] - box.corner_radius);
  const Vector one = std::copysign(1.0, u) * first, other = std::copysign(1.0, v) * second;
  const double length = std::hypot(along, across);
  if (along < 0.0 || across < 0.0 || length == 0.0) {
    const bool is_first = along >= across;
    return {std::max(along, across) - box.corner_radius, is_first ? one : other, Matrix::Zero()};
  }
  const Vector out = (along * one + across * other) / length, around = (along * other - across * one) / length;
  return {length - box.corner_radius, out, around * around.transpose() / length};
}

RoundedBoxPlace packed(double gap, const Vector& normal, const Matrix& gradient) {
  RoundedBoxPlace place{gap, {normal[0], normal[1], normal[2]}, {}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      place.normal_gradient[i][j] = gradient(i, j);
  return place;
}

} // namespace

RoundedBoxPlace place_at(const RigidRoundedBox& box, const std::array<double, 3>& r) {
  const Vector place(r.data()), n(box.normal.data());
  const double s = box.part == BoxPart::Punch ? 1.0 : -1.0, height = place.dot(n);
  const Outline outline = outline_at(box, place);
  const double beyond = s * outline.distance, a = beyond + box.edge_radius, b = height + box.edge_radius;
  const Vector g = s * outline.gradient;
  const Matrix turning = s * outline.hessian;
  if (a > 0.0 && b > 0.0) {
    const double length = std::hypot(a, b);
    const Vector normal = (a * g + b * n) / length;
    const Matrix gradient =
        (g * g.transpose() + n * n.transpose() - normal * normal.transpose() + a * turning) / length;
    return packed(length - box.edge_radius, normal, gradient);
  }
  if (beyond >= height) return packed(beyond, g, turning);
  return packed(height, n, Matrix::Zero());
}

} // namespace amontons
