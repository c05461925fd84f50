// The map ξ -> ρ(ξ) of one facet and its derivatives, and the border of its reference cell: what the two projections
// share. For lib/geometry only.
#pragma once

#include "geometry/projection.hpp"
#include "math/element_type.hpp"
#include "math/tensor.hpp"

#include <Eigen/Geometry>
#include <array>
#include <span>

namespace amontons::facet {

using Xi = Eigen::Vector2d;
using Tangents = Eigen::Matrix<double, 3, 2>;

constexpr bool is_triangle(ElementType type) {
  return type == ElementType::Triangle3 || type == ElementType::Triangle6;
}

/// How far ξ lies outside the reference cell of a surface facet: the largest violation of a side, negative inside.
double outside(ElementType type, const Xi& xi);
/// ξ moved onto the reference cell of a surface facet, for points that are outside by rounding or a small tolerance.
Xi clamped(ElementType type, Xi xi);

/// A facet of a 3D body. Views the caller's nodes.
struct Surface {
  ElementType type;
  std::span<const double> nodes;
  /// ρ = Σ k[i][j] ξ₁ⁱ ξ₂ʲ. Shape functions at every iterate took most of a projection's time.
  std::array<std::array<Eigen::Vector3d, 3>, 3> k;

  Surface(ElementType type_of_facet, std::span<const double> nodes_of_facet);
  bool is_linear() const { return element_order(type) == 1; } // k[i][j] = 0 for i or j = 2
  Eigen::Vector3d node(int a) const { return Eigen::Map<const Eigen::Vector3d>(nodes.data() + 3 * std::size_t(a)); }
  Eigen::Vector3d position(const Xi& xi) const;
  /// Columns ∂ρ/∂ξ₁, ∂ρ/∂ξ₂.
  Tangents tangents(const Xi& xi) const;
  /// Columns ∂²ρ/∂ξ₁², ∂²ρ/∂ξ₁∂ξ₂, ∂²ρ/∂ξ₂².
  Eigen::Matrix3d second_derivatives(const Xi& xi) const;
  /// Largest extent of the corners along a coordinate: a length to compare rounding errors with.
  double extent() const;
};

/// ρ(s) = a + b s + c s², s in [-1, 1]: a segment facet, or an edge of a surface facet.
template <int dim>
struct Curve {
  Point<dim> a, b, c;
  Point<dim> position(double s) const { return a + s * (b + s * c); }
  Point<dim> tangent(double s) const { return b + 2.0 * s * c; }
};

/// The curve through its ends and, when there is one, the node at s = 0.
template <int dim>
Curve<dim> curve_through(const Point<dim>& first, const Point<dim>& last, const Point<dim>* middle) {
  const Point<dim> mean = 0.5 * (first + last);
  if (middle == nullptr) return {mean, 0.5 * (last - first), Point<dim>::Zero()};
  return {*middle, 0.5 * (last - first), mean - *middle};
}

/// Segment facet of a 2D body.
Curve<2> segment_curve(ElementType type, std::span<const double> nodes);

/// Is a facet of order 2 the linear facet of its corners, node by node to rounding? Those of order 1 are.
bool is_straight(ElementType type, std::span<const double> nodes);

/// The projection of x that landed on ξ, with all its fields; not found where the facet has no normal.
Projection landed(ElementType type, std::span<const double> nodes, std::span<const double> x, const Xi& xi);

/// Interior sample points of the reference cell of a surface facet, from which iterations start.
std::span<const Xi> starts(ElementType type);

} // namespace amontons::facet
