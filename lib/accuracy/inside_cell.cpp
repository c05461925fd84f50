#include "accuracy/inside_cell.hpp"

#include "math/reference_element.hpp"
#include "math/tensor.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>

namespace amontons::accuracy {

namespace {

constexpr bool is_simplex(ElementType type) { return num_vertices(type) == element_dim(type) + 1; }

/// How far ξ lies outside the reference cell, negative inside.
template <int dim>
double outside(ElementType type, const Point<dim>& xi) {
  if (is_simplex(type)) return std::max(-xi.minCoeff(), xi.sum() - 1.0);
  return xi.cwiseAbs().maxCoeff() - 1.0;
}

/// Newton's method for Σ N_a(ξ) x_a = x from the middle of the cell; on straight simplices the first step is exact.
template <int dim>
bool is_inside(ElementType type, std::span<const double> nodes, std::span<const double> x) {
  const std::size_t count = num_nodes(type);
  std::array<double, 27> values;
  std::array<double, 27 * dim> gradients;
  Point<dim> xi = Point<dim>::Constant(is_simplex(type) ? 1.0 / (dim + 1) : 0.0);
  for (int iteration = 0; iteration < 25; ++iteration) {
    shape_values(type, std::span(xi.data(), dim), std::span(values).first(count));
    shape_gradients(type, std::span(xi.data(), dim), std::span(gradients).first(count * dim));
    Point<dim> residual = -Eigen::Map<const Point<dim>>(x.data());
    Eigen::Matrix<double, dim, dim> jacobian = Eigen::Matrix<double, dim, dim>::Zero();
    for (std::size_t a = 0; a < count; ++a) {
      const Eigen::Map<const Point<dim>> node(nodes.data() + a * dim);
      residual += values[a] * node;
      jacobian += node * Eigen::Map<const Point<dim>>(gradients.data() + a * dim).transpose();
    }
    const Point<dim> step = -jacobian.inverse() * residual;
    xi += step;
    if (!(outside<dim>(type, xi) < 5.0)) return false; // also when the cell is degenerate
    if (step.template lpNorm<Eigen::Infinity>() < 1e-12) return outside<dim>(type, xi) <= 1e-12;
  }
  return false;
}

} // namespace

bool is_inside(ElementType type, std::span<const double> nodes, std::span<const double> x) {
  return element_dim(type) == 2 ? is_inside<2>(type, nodes, x) : is_inside<3>(type, nodes, x);
}

} // namespace amontons::accuracy
