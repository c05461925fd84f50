// Shape functions and quadrature of the elements of math/element_type.hpp on their reference cells: segments,
// quadrilaterals and hexahedra on [-1, 1]^d, triangles and tetrahedra on the unit simplex. Pure functions of numbers.
#pragma once

#include "math/element_type.hpp"

#include <Eigen/Core>
#include <span>
#include <vector>

namespace amontons {

/// N_a(ξ): `values` receives num_nodes(type) numbers.
void shape_values(ElementType type, std::span<const double> xi, std::span<double> values);

/// dN_a/dξ_i at `gradients[a * element_dim(type) + i]`.
void shape_gradients(ElementType type, std::span<const double> xi, std::span<double> gradients);

/// d²N_a/dξ_i dξ_j at `hessians[(a * d + i) * d + j]`, d = element_dim(type).
void shape_hessians(ElementType type, std::span<const double> xi, std::span<double> hessians);

/// Reference coordinates of node a: `element_dim(type)` numbers each, node by node.
std::span<const double> reference_nodes(ElementType type);

/// The element with the same corners and order 1 (the basis of multipliers).
ElementType linear_element(ElementType type);

struct Quadrature {
  int dim = 0;
  std::vector<double> points; // size() x dim
  std::vector<double> weights;
  int size() const { return static_cast<int>(weights.size()); }
  std::span<const double> point(int q) const { return std::span(points).subspan(std::size_t(q) * dim, dim); }
};

/// A rule on the reference cell of `type` exact for polynomials of total degree `degree` on simplices and of degree
/// `degree` in each variable on segments, quadrilaterals and hexahedra; all weights positive, all points inside.
/// Symmetric rules up to degree 5 on triangles and tetrahedra, collapsed Gauss-Jacobi products above. Made once for
/// each (type, degree) and kept.
const Quadrature& quadrature(ElementType type, int degree);

/// Values and reference gradients of an element tabulated at the points of a rule.
struct Tabulation {
  ElementType type;
  const Quadrature* rule;
  std::vector<double> values;    // size() x num_nodes
  std::vector<double> gradients; // size() x num_nodes x dim
  std::span<const double> value(int q) const {
    return std::span(values).subspan(std::size_t(q) * num_nodes(type), num_nodes(type));
  }
  std::span<const double> gradient(int q) const {
    const std::size_t stride = std::size_t(num_nodes(type)) * element_dim(type);
    return std::span(gradients).subspan(q * stride, stride);
  }
};

/// Made once for each (type, degree) and kept.
const Tabulation& tabulation(ElementType type, int degree);

} // namespace amontons
