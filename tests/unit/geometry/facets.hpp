// Random facets and points for the tests of projections.
#pragma once

#include "geometry/projection.hpp"
#include "math/reference_element.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace amontons::testing {

inline const std::vector<ElementType>& facet_types() {
  static const std::vector<ElementType> types = {ElementType::Segment2,       ElementType::Segment3,
                                                 ElementType::Triangle3,      ElementType::Triangle6,
                                                 ElementType::Quadrilateral4, ElementType::Quadrilateral9};
  return types;
}

inline bool is_triangle(ElementType type) { return type == ElementType::Triangle3 || type == ElementType::Triangle6; }

/// The reference cell as a facet in the plane z = 0 (y = 0 in 2D), rotated, sheared and with each node moved at random
/// by up to `disorder` of the facet's side.
inline std::vector<double> random_facet(ElementType type, double disorder, std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const int d = element_dim(type), dim = d + 1;
  const auto reference = reference_nodes(type);
  const double side = is_triangle(type) ? 1.0 : 2.0; // of the reference cell
  Eigen::Matrix3d map = Eigen::Matrix3d::Zero();
  for (;;) {
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j)
        map(i, j) = number(random);
    const Eigen::MatrixXd block = map.topLeftCorner(dim, dim);
    if (std::abs(block.determinant()) > 0.2) break;
  }
  std::vector<double> nodes;
  for (int a = 0; a < num_nodes(type); ++a) {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    for (int i = 0; i < d; ++i)
      p[i] = reference[std::size_t(a) * d + i];
    for (int i = 0; i < dim; ++i)
      p[i] += disorder * side * number(random);
    const Eigen::Vector3d moved = map * p;
    for (int i = 0; i < dim; ++i)
      nodes.push_back(moved[i] + 3.0 * (i + 1));
  }
  return nodes;
}

/// ρ(ξ), from the shape functions.
inline Eigen::Vector3d position(ElementType type, const std::vector<double>& nodes, const double* xi) {
  const int dim = element_dim(type) + 1;
  std::vector<double> values(num_nodes(type));
  shape_values(type, std::span(xi, std::size_t(dim - 1)), values);
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  for (int a = 0; a < num_nodes(type); ++a)
    for (int i = 0; i < dim; ++i)
      result[i] += values[a] * nodes[std::size_t(a) * dim + i];
  return result;
}

/// ∂ρ/∂ξ_i as columns.
inline Eigen::Matrix<double, 3, 2> tangents(ElementType type, const std::vector<double>& nodes, const double* xi) {
  const int d = element_dim(type), dim = d + 1;
  std::vector<double> gradients(std::size_t(num_nodes(type)) * d);
  shape_gradients(type, std::span(xi, std::size_t(d)), gradients);
  Eigen::Matrix<double, 3, 2> result = Eigen::Matrix<double, 3, 2>::Zero();
  for (int a = 0; a < num_nodes(type); ++a)
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < d; ++j)
        result(i, j) += gradients[std::size_t(a) * d + j] * nodes[std::size_t(a) * dim + i];
  return result;
}

/// Is ξ in the reference cell, up to `slack`?
inline bool inside(ElementType type, const double* xi, double slack) {
  if (is_triangle(type)) return xi[0] >= -slack && xi[1] >= -slack && xi[0] + xi[1] <= 1.0 + slack;
  for (int i = 0; i < element_dim(type); ++i)
    if (std::abs(xi[i]) > 1.0 + slack) return false;
  return true;
}

/// A grid of reference points that covers the cell with its border.
inline std::vector<std::array<double, 2>> grid(ElementType type, int divisions) {
  std::vector<std::array<double, 2>> points;
  for (int i = 0; i <= divisions; ++i) {
    if (element_dim(type) == 1) {
      points.push_back({2.0 * i / divisions - 1.0, 0.0});
      continue;
    }
    for (int j = 0; j <= divisions; ++j) {
      if (is_triangle(type) && i + j > divisions) continue;
      if (is_triangle(type))
        points.push_back({double(i) / divisions, double(j) / divisions});
      else
        points.push_back({2.0 * i / divisions - 1.0, 2.0 * j / divisions - 1.0});
    }
  }
  return points;
}

} // namespace amontons::testing
