#include "geometry/facet_map.hpp"

#include "math/reference_element.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace amontons::facet {

namespace {

/// Relative size below which a length or an area counts as zero.
constexpr double degenerate = 1e-14;
/// Distance relative to the facet's size within which a node lies where the linear facet has it.
constexpr double straight_tolerance = 1e-12;
/// Distance in reference coordinates within which a point lies on an edge or a vertex.
constexpr double on_border = 1e-12;

/// Points of a lattice strictly inside the reference cell; finer for curved facets.
std::vector<Xi> lattice(bool triangle, int divisions) {
  std::vector<Xi> points;
  if (triangle) {
    for (int i = 1; i < divisions; ++i)
      for (int j = 1; i + j < divisions; ++j)
        points.emplace_back(double(i) / divisions, double(j) / divisions);
  } else {
    for (int i = 0; i < divisions; ++i)
      for (int j = 0; j < divisions; ++j)
        points.emplace_back((2.0 * i + 1.0) / divisions - 1.0, (2.0 * j + 1.0) / divisions - 1.0);
  }
  return points;
}

Feature feature_at(ElementType type, const Xi& xi) {
  if (element_dim(type) == 1) return 1.0 - std::abs(xi[0]) <= on_border ? Feature::Vertex : Feature::Facet;
  std::array<double, 4> sides{1.0 - xi[0], 1.0 + xi[0], 1.0 - xi[1], 1.0 + xi[1]};
  if (is_triangle(type)) sides = {xi[0], xi[1], 1.0 - xi[0] - xi[1], 1.0};
  const auto touched = std::count_if(sides.begin(), sides.end(), [](double side) { return side <= on_border; });
  return touched == 0 ? Feature::Facet : touched == 1 ? Feature::Edge : Feature::Vertex;
}

/// Of the parabola through these values at -1, 0 and 1: the coefficients of 1, s and s².
std::array<Eigen::Vector3d, 3> powers(const Eigen::Vector3d& before, const Eigen::Vector3d& middle,
                                      const Eigen::Vector3d& after) {
  return {middle, 0.5 * (after - before), 0.5 * (after + before) - middle};
}

} // namespace

double outside(ElementType type, const Xi& xi) {
  if (is_triangle(type)) return std::max({-xi[0], -xi[1], xi[0] + xi[1] - 1.0});
  return std::max(std::abs(xi[0]), std::abs(xi[1])) - 1.0;
}

Xi clamped(ElementType type, Xi xi) {
  if (!is_triangle(type)) return xi.cwiseMax(-1.0).cwiseMin(1.0);
  xi = xi.cwiseMax(0.0);
  const double sum = xi.sum();
  if (sum > 1.0) xi = {xi[0] / sum, 1.0 - xi[0] / sum}; // the two then add up to 1 exactly
  return xi;
}

Surface::Surface(ElementType type_of_facet, std::span<const double> nodes_of_facet)
    : type(type_of_facet), nodes(nodes_of_facet) {
  for (auto& row : k)
    row.fill(Eigen::Vector3d::Zero());
  switch (type) {
  case ElementType::Triangle6: {
    const auto from_first = [&](int a) { return Eigen::Vector3d(node(a) - node(0)); };
    k[0][0] = node(0);
    k[1][0] = 4.0 * from_first(3) - from_first(1);
    k[2][0] = 2.0 * from_first(1) - 4.0 * from_first(3);
    k[0][1] = 4.0 * from_first(5) - from_first(2);
    k[0][2] = 2.0 * from_first(2) - 4.0 * from_first(5);
    k[1][1] = 4.0 * (from_first(4) - from_first(3) - from_first(5));
    break;
  }
  case ElementType::Quadrilateral4: {
    const Eigen::Vector3d p = node(0), q = node(1), r = node(2), s = node(3);
    k[0][0] = 0.25 * (p + q + r + s);
    k[1][0] = 0.25 * (q + r - p - s);
    k[0][1] = 0.25 * (r + s - p - q);
    k[1][1] = 0.25 * (p + r - q - s);
    break;
  }
  case ElementType::Quadrilateral9: {
    // Nodes with ξ₂ = -1, 0, 1, in each row those with ξ₁ = -1, 0, 1, relative to the one in the middle.
    constexpr std::array<std::array<int, 3>, 3> grid{{{0, 4, 1}, {7, 8, 5}, {3, 6, 2}}};
    std::array<std::array<Eigen::Vector3d, 3>, 3> row;
    for (std::size_t j = 0; j < 3; ++j) {
      const auto at = [&](std::size_t i) { return Eigen::Vector3d(node(grid[j][i]) - node(8)); };
      row[j] = powers(at(0), at(1), at(2));
    }
    for (std::size_t i = 0; i < 3; ++i)
      k[i] = powers(row[0][i], row[1][i], row[2][i]);
    k[0][0] += node(8);
    break;
  }
  default: // Triangle3
    k[0][0] = node(0);
    k[1][0] = node(1) - node(0);
    k[0][1] = node(2) - node(0);
  }
}

Eigen::Vector3d Surface::position(const Xi& xi) const {
  const double s = xi[0], t = xi[1];
  if (is_linear()) return k[0][0] + s * k[1][0] + t * (k[0][1] + s * k[1][1]);
  const auto along = [&](std::size_t i) { return Eigen::Vector3d(k[i][0] + t * (k[i][1] + t * k[i][2])); };
  return along(0) + s * (along(1) + s * along(2));
}

Tangents Surface::tangents(const Xi& xi) const {
  const double s = xi[0], t = xi[1];
  Tangents result;
  if (is_linear()) {
    result << k[1][0] + t * k[1][1], k[0][1] + s * k[1][1];
    return result;
  }
  result.col(0) = k[1][0] + t * (k[1][1] + t * k[1][2]) + 2.0 * s * (k[2][0] + t * (k[2][1] + t * k[2][2]));
  result.col(1) = k[0][1] + s * (k[1][1] + s * k[2][1]) + 2.0 * t * (k[0][2] + s * (k[1][2] + s * k[2][2]));
  return result;
}

Eigen::Matrix3d Surface::second_derivatives(const Xi& xi) const {
  const double s = xi[0], t = xi[1];
  Eigen::Matrix3d result = Eigen::Matrix3d::Zero();
  result.col(1) = k[1][1];
  if (is_linear()) return result;
  result.col(0) = 2.0 * (k[2][0] + t * (k[2][1] + t * k[2][2]));
  result.col(1) += 2.0 * (s * k[2][1] + t * k[1][2] + 2.0 * s * t * k[2][2]);
  result.col(2) = 2.0 * (k[0][2] + s * (k[1][2] + s * k[2][2]));
  return result;
}

double Surface::extent() const {
  Eigen::Vector3d low = node(0), high = node(0);
  for (int i = 1; i < num_vertices(type); ++i) {
    low = low.cwiseMin(node(i));
    high = high.cwiseMax(node(i));
  }
  return (high - low).maxCoeff();
}

Curve<2> segment_curve(ElementType type, std::span<const double> nodes) {
  const auto node = [&](std::size_t a) { return Point<2>(nodes[2 * a], nodes[2 * a + 1]); };
  if (type == ElementType::Segment2) return curve_through<2>(node(0), node(1), nullptr);
  const Point<2> middle = node(2);
  return curve_through<2>(node(0), node(1), &middle);
}

bool is_straight(ElementType type, std::span<const double> nodes) {
  if (element_order(type) == 1) return true;
  const auto linear = linear_element(type);
  const auto reference = reference_nodes(type);
  const std::size_t d = element_dim(type), dim = d + 1;
  const int corners = num_vertices(type);
  const double allowed = straight_tolerance * facet_size(type, nodes);
  std::array<double, 4> shape{};
  for (std::size_t a = corners; a < std::size_t(num_nodes(type)); ++a) {
    shape_values(linear, reference.subspan(a * d, d), std::span(shape).first(corners));
    for (std::size_t c = 0; c < dim; ++c) {
      double apart = -nodes[a * dim + c];
      for (int b = 0; b < corners; ++b)
        apart += shape[b] * nodes[std::size_t(b) * dim + c];
      if (std::abs(apart) > allowed) return false;
    }
  }
  return true;
}

Projection landed(ElementType type, std::span<const double> nodes, std::span<const double> x, const Xi& xi) {
  Projection result;
  result.xi = {xi[0], xi[1]};
  result.feature = feature_at(type, xi);
  double size = 0.0; // of the measure of a facet with this extent
  if (element_dim(type) == 1) {
    const Curve<2> curve = segment_curve(type, nodes);
    const Point<2> point = curve.position(xi[0]);
    result.point = {point[0], point[1], 0.0};
    size = curve.b.norm() + curve.c.norm();
  } else {
    const Surface surface{type, nodes};
    const Eigen::Vector3d point = surface.position(xi);
    result.point = {point[0], point[1], point[2]};
    size = surface.extent() * surface.extent();
  }
  double distance2 = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    distance2 += (x[i] - result.point[i]) * (x[i] - result.point[i]);
  result.distance = std::sqrt(distance2);
  const std::span<const double> place(result.xi.data(), std::size_t(element_dim(type)));
  result.found = facet_normal(type, nodes, place, result.normal) > degenerate * size;
  return result;
}

std::span<const Xi> starts(ElementType type) {
  static const std::vector<Xi> coarse = lattice(false, 3), fine = lattice(false, 6), triangle = lattice(true, 9);
  if (is_triangle(type)) return triangle;
  return type == ElementType::Quadrilateral4 ? coarse : fine;
}

} // namespace amontons::facet
