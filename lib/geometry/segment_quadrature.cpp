#include "geometry/segment_quadrature.hpp"

#include "geometry/clipping.hpp"
#include "geometry/facet_map.hpp"
#include "geometry/projection.hpp"
#include "math/reference_element.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace amontons {

namespace {

/// Overlaps whose areas add up to the facet's within this part of it cover it completely.
constexpr double cover_tolerance = 1e-12;
/// Rounding in taking a point of a piece back to the facet, in reference coordinates.
constexpr double outside_tolerance = 1e-6;

template <int dim>
using Shape = std::conditional_t<dim == 2, Interval, Polygon>;

/// A linear facet: a whole one, or a part of one of order 2.
template <int dim>
struct Cell {
  ElementType type;
  int count;                             // corners
  std::array<double, 4 * dim> corners{}; // positions
  std::array<double, 8> xi{};            // the corners' reference coordinates on the whole facet, dim - 1 each
  double share;                          // its part of the whole facet's area in reference coordinates over its own
  Point<dim> corner(int i) const { return Eigen::Map<const Point<dim>>(&corners[std::size_t(i) * dim]); }
  std::span<const double> positions() const { return std::span(corners).first(std::size_t(count) * dim); }
  Point<dim> centre() const {
    Point<dim> sum = Point<dim>::Zero();
    for (int i = 0; i < count; ++i)
      sum += corner(i);
    return sum / count;
  }
};

/// Nodes of the linear cells that make up a facet of order 2.
std::vector<std::vector<int>> subdivision(ElementType type) {
  switch (type) {
  case ElementType::Segment3:
    return {{0, 2}, {2, 1}};
  case ElementType::Triangle6:
    return {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
  case ElementType::Quadrilateral9:
    return {{0, 4, 8, 7}, {4, 1, 5, 8}, {8, 5, 2, 6}, {7, 8, 6, 3}};
  default:
    return {};
  }
}

template <int dim>
std::vector<Cell<dim>> linear_cells(const FacetNodes& facet) {
  std::vector<int> corners(num_vertices(facet.type));
  std::iota(corners.begin(), corners.end(), 0);
  const bool whole = facet::is_straight(facet.type, facet.nodes);
  const auto parts = whole ? std::vector<std::vector<int>>{corners} : subdivision(facet.type);
  const auto reference = reference_nodes(facet.type);
  std::vector<Cell<dim>> cells;
  for (const auto& part : parts) {
    Cell<dim> cell{.type = linear_element(facet.type),
                   .count = static_cast<int>(part.size()),
                   .share = whole ? 1.0 : std::pow(0.5, dim - 1)};
    for (std::size_t i = 0; i < part.size(); ++i) {
      std::copy_n(&facet.nodes[std::size_t(part[i]) * dim], dim, &cell.corners[i * dim]);
      std::copy_n(&reference[std::size_t(part[i]) * (dim - 1)], dim - 1, &cell.xi[i * (dim - 1)]);
    }
    cells.push_back(cell);
  }
  return cells;
}

/// The plane (2D: line) in which a linear facet is clipped.
template <int dim>
struct AuxiliaryPlane {
  Point<dim> origin, normal;
  Eigen::Matrix<double, dim, dim - 1> axes;

  explicit AuxiliaryPlane(const Cell<dim>& cell) : origin(cell.centre()) {
    const Point<dim> along = cell.corner(1) - cell.corner(0);
    if constexpr (dim == 2) {
      axes = along.normalized();
      normal = {axes(1), -axes(0)};
    } else {
      const int last = cell.count - 1;
      normal = (cell.count == 3 ? along.cross(cell.corner(2) - cell.corner(0))
                                : (cell.corner(2) - cell.corner(0)).cross(cell.corner(last) - cell.corner(1)))
                   .normalized();
      axes.col(0) = (along - along.dot(normal) * normal).normalized();
      axes.col(1) = normal.cross(axes.col(0));
    }
  }
  Point<dim - 1> shadow(const Point<dim>& x) const { return axes.transpose() * (x - origin); }
  Point<dim> place(const Point<dim - 1>& y) const { return origin + axes * y; }
};

std::vector<Interval> shadows(const AuxiliaryPlane<2>& plane, const Cell<2>& cell) {
  const double first = plane.shadow(cell.corner(0))[0], last = plane.shadow(cell.corner(1))[0];
  return {{std::min(first, last), std::max(first, last)}};
}

std::vector<Polygon> shadows(const AuxiliaryPlane<3>& plane, const Cell<3>& cell) {
  Polygon polygon;
  for (int i = 0; i < cell.count; ++i)
    polygon.push_back(plane.shadow(cell.corner(i)));
  return convex_parts(std::move(polygon));
}

/// A part of the auxiliary plane and the facet that covers it.
template <int dim>
struct Piece {
  Shape<dim> shape;
  std::int32_t other;
};

/// Divides `whole` between the others, each overlap cut out of what those before it left, and nobody.
template <int dim>
std::vector<Piece<dim>> divide(const Shape<dim>& whole, std::span<const Piece<dim>> others) {
  const double no_measure = cover_tolerance * measure(whole);
  std::vector<Shape<dim>> rest = {whole};
  std::vector<Piece<dim>> pieces;
  for (const auto& other : others) {
    std::vector<Shape<dim>> left;
    for (const auto& part : rest) {
      if (auto common = overlap(part, other.shape); measure(common) > 0.0)
        pieces.push_back({std::move(common), other.other});
      auto outside = difference(part, other.shape);
      left.insert(left.end(), outside.begin(), outside.end());
    }
    rest = std::move(left);
  }
  for (auto& part : rest)
    if (measure(part) > no_measure) pieces.push_back({std::move(part), SegmentPoint::uncovered});
  return pieces;
}

template <int dim>
double covered_measure(std::span<const Piece<dim>> pieces) {
  double sum = 0.0;
  for (const auto& piece : pieces)
    if (piece.other != SegmentPoint::uncovered) sum += measure(piece.shape);
  return sum;
}

/// The pieces of a linear facet in its auxiliary plane. Where none of the others lie over one another, overlaps with
/// the whole facet are taken: they have fewer corners than what is cut out bit by bit.
template <int dim>
std::vector<Piece<dim>> pieces_of(const Shape<dim>& whole, const AuxiliaryPlane<dim>& plane,
                                  std::span<const std::vector<Cell<dim>>> others) {
  struct Candidate {
    Piece<dim> piece;
    double height;
  };
  std::vector<Candidate> candidates;
  std::vector<Piece<dim>> overlaps, in_turn;
  for (std::size_t i = 0; i < others.size(); ++i)
    for (const auto& cell : others[i])
      for (auto& shadow : shadows(plane, cell)) {
        auto common = overlap(whole, shadow);
        if (measure(common) <= 0.0) continue;
        const auto other = static_cast<std::int32_t>(i);
        overlaps.push_back({std::move(common), other});
        candidates.push_back({{std::move(shadow), other}, std::abs(plane.normal.dot(cell.centre() - plane.origin))});
      }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.height < b.height; });
  for (auto& candidate : candidates)
    in_turn.push_back(std::move(candidate.piece));
  auto pieces = divide<dim>(whole, in_turn);
  const double once = covered_measure<dim>(pieces), each = covered_measure<dim>(overlaps);
  if (each - once > cover_tolerance * measure(whole)) return pieces;
  for (auto& piece : pieces)
    if (piece.other == SegmentPoint::uncovered) overlaps.push_back(std::move(piece));
  return overlaps;
}

/// The point of the facet that is seen at y in the auxiliary plane of its cell, with the area there per area of the
/// plane. Nothing where the cell is folded over.
template <int dim>
std::optional<SegmentPoint> carried_over(const FacetNodes& facet, const Cell<dim>& cell,
                                         const AuxiliaryPlane<dim>& plane, const Point<dim - 1>& y) {
  const Point<dim> place = plane.place(y);
  const auto landed =
      project_along(cell.type, cell.positions(), {place.data(), dim}, {plane.normal.data(), dim}, outside_tolerance);
  if (!landed.found) return std::nullopt;
  const std::span<const double> local(landed.xi.data(), dim - 1);
  std::array<double, 4> shape{};
  shape_values(cell.type, local, std::span(shape).first(cell.count));
  SegmentPoint point;
  for (int i = 0; i < cell.count; ++i)
    for (int c = 0; c < dim - 1; ++c)
      point.xi[c] += shape[i] * cell.xi[std::size_t(i) * (dim - 1) + c];
  std::array<double, 3> normal{};
  const double on_cell = facet_normal(cell.type, cell.positions(), local, normal);
  const double steepness = plane.normal.dot(Eigen::Map<const Point<dim>>(normal.data()));
  if (steepness <= 0.0) return std::nullopt;
  point.weight =
      cell.share * facet_normal(facet.type, facet.nodes, {point.xi.data(), dim - 1}, normal) / (on_cell * steepness);
  return point;
}

template <int dim>
std::vector<SegmentPoint> rule_points(const FacetNodes& facet, int degree) {
  const auto& rule = quadrature(facet.type, degree);
  std::vector<SegmentPoint> points(rule.size());
  for (int q = 0; q < rule.size(); ++q) {
    std::array<double, 3> normal{};
    std::copy_n(rule.point(q).begin(), dim - 1, points[q].xi.begin());
    points[q].weight = rule.weights[q] * facet_normal(facet.type, facet.nodes, rule.point(q), normal);
  }
  return points;
}

/// Adds the points of one cell; false when it is folded over in its auxiliary plane.
template <int dim>
bool add_points(const FacetNodes& facet, const Cell<dim>& cell, std::span<const std::vector<Cell<dim>>> others,
                int degree, std::vector<SegmentPoint>& points) {
  const AuxiliaryPlane<dim> plane(cell);
  const auto wholes = shadows(plane, cell);
  if (wholes.size() != 1) return false;
  const auto& rule = quadrature(dim == 2 ? ElementType::Segment2 : ElementType::Triangle3, degree);
  const double reference = std::accumulate(rule.weights.begin(), rule.weights.end(), 0.0);
  for (const auto& piece : pieces_of<dim>(wholes[0], plane, others))
    for (const auto& simplex : simplices(piece.shape)) {
      const double size = measure(simplex);
      for (int q = 0; q < rule.size(); ++q) {
        std::array<double, dim> shape;
        shape_values(dim == 2 ? ElementType::Segment2 : ElementType::Triangle3, rule.point(q), shape);
        Point<dim - 1> y = Point<dim - 1>::Zero();
        for (int i = 0; i < dim; ++i)
          y += shape[i] * simplex[i];
        auto point = carried_over<dim>(facet, cell, plane, y);
        if (!point) return false;
        point->weight *= size * rule.weights[q] / reference;
        point->other = piece.other;
        points.push_back(*point);
      }
    }
  return true;
}

template <int dim>
std::vector<SegmentPoint> broken_rule(const FacetNodes& facet, std::span<const FacetNodes> others, int degree) {
  std::vector<std::vector<Cell<dim>>> cells;
  for (const auto& other : others)
    cells.push_back(linear_cells<dim>(other));
  std::vector<SegmentPoint> points;
  for (const auto& cell : linear_cells<dim>(facet))
    if (!add_points<dim>(facet, cell, cells, degree, points)) return rule_points<dim>(facet, degree);
  const bool is_covered = std::any_of(points.begin(), points.end(),
                                      [](const SegmentPoint& point) { return point.other != SegmentPoint::uncovered; });
  return is_covered ? points : rule_points<dim>(facet, degree);
}

} // namespace

std::vector<SegmentPoint> segment_quadrature(const FacetNodes& facet, std::span<const FacetNodes> others, int degree) {
  return element_dim(facet.type) == 1 ? broken_rule<2>(facet, others, degree) : broken_rule<3>(facet, others, degree);
}

} // namespace amontons
