// Quadrature over a facet that is broken where the facets of another surface begin and end, so that functions which are
// smooth on each of those are integrated as well as smooth functions are. Pure functions of numbers.
#pragma once

#include "math/element_type.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace amontons {

/// A facet by type and node positions (num_nodes(type) x dim); views the caller's nodes.
struct FacetNodes {
  ElementType type;
  std::span<const double> nodes;
};

/// A quadrature point of a facet.
struct SegmentPoint {
  std::array<double, 2> xi{};     // on the facet
  double weight = 0.0;            // area: the weights of a facet sum up to its area
  std::int32_t other = uncovered; // index of the facet of the other surface that covers the point
  static constexpr std::int32_t uncovered = -1;
};

/// Quadrature points of `facet`, piece by piece: its overlaps with each of `others`, in their order, then what none of
/// them covers. Polynomials of total degree `degree` in place are integrated exactly over every piece of a plane facet
/// (with bilinear shape functions on other than parallelograms, which are no polynomials in place, as well as a rule of
/// that degree does). The points of a facet that nothing covers are those of its quadrature rule.
///
/// Pieces are clipped in an auxiliary plane (2D: line) through the facet's centre across its mean normal, on which the
/// other facets are projected along that normal: M. A. Puso, A 3D mortar method for solid mechanics, Int. J. Numer.
/// Meth. Engng. 59 (2004) 315-336. Curved facets of order 2 are divided into linear ones for it, as by M. A. Puso, T.
/// A. Laursen, J. Solberg, A segment-to-segment mortar contact method for quadratic elements and large deformations,
/// Comput. Methods Appl. Mech. Engrg. 197 (2008) 555-566; points and weights are then carried over to the curved facet.
/// Where several others lie over the same place, it goes to the one that is nearest to the plane in the mean: nothing
/// is counted twice.
std::vector<SegmentPoint> segment_quadrature(const FacetNodes& facet, std::span<const FacetNodes> others, int degree);

} // namespace amontons
