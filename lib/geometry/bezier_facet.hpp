// A facet whose map is cubic: the smoothed shape of a linear segment (4 control points) or quadrilateral (4 x 4). Place
// and derivatives, the closest point, the point along a direction. Where the control points come from is for the
// caller.
#pragma once

#include "geometry/contact_kinematics.hpp"
#include "geometry/projection.hpp"

#include <Eigen/Core>
#include <span>

namespace amontons {

/// ρ(ξ) = Σ_k B_k(ξ) c_k with Bernstein polynomials of degree 3 in (1 + ξ_α) / 2 (products of two in 3D, that of ξ₁
/// running fastest), ξ in [-1, 1] as on the facet of order 1. Control points c_k of dim coordinates; views the
/// caller's.
struct BezierFacet {
  int dim;
  std::span<const double> control;
};

/// Values of the Bernstein polynomials (row 0), first derivatives (1, 2) and second ones (3: 11, 4: 12, 5: 22) by ξ, a
/// column for each control point: 4 for dim 2, 16 for dim 3.
using BernsteinTable = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 16>;
BernsteinTable bernstein_table(int dim, std::span<const double> xi);

SurfacePoint surface_point(const BezierFacet& facet, std::span<const double> xi);

/// As the functions of the same names for elements (projection.hpp). In 2D the closest point is the global one; in 3D
/// that of the descent from the nearest of 25 samples, which is the global one unless the facet bends by more than the
/// distance of the point.
Projection closest_point(const BezierFacet& facet, std::span<const double> x);
Projection project_along(const BezierFacet& facet, std::span<const double> x, std::span<const double> direction,
                         double tolerance = 1e-8);

} // namespace amontons
