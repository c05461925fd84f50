// The cell bubble of triangles and tetrahedra, b = (d + 1)^(d + 1) L_0 L_1 ... L_d: zero on the boundary, one at the
// centroid; cubic in two dimensions, quartic in three. Pure functions of numbers.
#pragma once

#include "math/element_type.hpp"

#include <span>
#include <vector>

namespace amontons {

/// b(ξ); `type` is a triangle or a tetrahedron of any order, `xi` has element_dim(type) numbers.
double bubble_value(ElementType type, std::span<const double> xi);

/// db/dξ_i at `gradient[i]`.
void bubble_gradient(ElementType type, std::span<const double> xi, std::span<double> gradient);

/// The bubble at the points of a rule that is made for lower polynomials than the bubble's. A rule of degree 2 m sees
/// the L2 projection of ∇b on the reference cell onto polynomials of degree m, whose products it integrates exactly:
/// that is gradient(q). `unseen[i * dim + j]` is the mean over the reference cell of what is left of ∂_i b ∂_j b; with
/// m = dim it is zero.
struct BubbleTable {
  int dim;
  std::vector<double> values;    // one number a point
  std::vector<double> gradients; // dim numbers a point
  std::vector<double> unseen;    // dim x dim
  std::span<const double> gradient(int q) const { return std::span(gradients).subspan(std::size_t(q) * dim, dim); }
};

/// For quadrature(type, degree). Made once for each (type, degree) and kept.
const BubbleTable& bubble_table(ElementType type, int degree);

} // namespace amontons
