// Where a point meets a facet: closest-point projection and projection along a direction, for straight and curved
// facets in 2D (segments) and 3D (triangles, quadrilaterals). Pure functions of numbers, one facet at a time.
#pragma once

#include "math/element_type.hpp"

#include <array>
#include <span>

namespace amontons {

/// The part of the facet that a projection landed on. An edge of a 3D facet; a vertex of any facet.
enum class Feature { Facet, Edge, Vertex };

struct Projection {
  bool found = false;
  Feature feature = Feature::Facet;
  std::array<double, 2> xi{};     // reference coordinates on the facet, inside or on its border
  std::array<double, 3> point{};  // ρ(ξ)
  std::array<double, 3> normal{}; // unit outward normal of the facet at ξ
  double distance = 0.0;          // |x − ρ(ξ)|
};

/// Unit outward normal of a facet at ξ and the surface measure |∂ρ/∂ξ₁ × ∂ρ/∂ξ₂| (|∂ρ/∂ξ| in 2D). Orientation as in
/// FacetSet: in 2D (t_y, −t_x), in 3D right-handed. `nodes`: num_nodes(type) × dim positions. dim is element_dim(type)
/// + 1.
double facet_normal(ElementType type, std::span<const double> nodes, std::span<const double> xi,
                    std::array<double, 3>& normal);

/// The point of the facet closest to x. Always found, except on a degenerate facet (area zero) or when Newton's method
/// on a curved facet does not converge from any of its starts (found = false).
Projection closest_point(ElementType type, std::span<const double> nodes, std::span<const double> x);

/// The intersection of the facet with the line x + s·direction (any sign of s) that has the smallest |s|; found is
/// false when the line misses the facet. `tolerance`: how far outside the reference cell still counts as inside, so
/// that no line slips through between two facets.
Projection project_along(ElementType type, std::span<const double> nodes, std::span<const double> x,
                         std::span<const double> direction, double tolerance = 1e-8);

/// Diameter of a facet: the largest distance between two of its corners in 2D, the square root of twice the area of a
/// triangle or of the area of a quadrilateral in 3D.
double facet_size(ElementType type, std::span<const double> nodes);

} // namespace amontons
