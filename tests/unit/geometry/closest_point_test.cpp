// Closest points against brute force, the conditions of optimality, and closed forms.
#include "facets.hpp"

#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::testing;

namespace {

Projection project(ElementType type, const std::vector<double>& nodes, const Eigen::Vector3d& x) {
  return closest_point(type, nodes, std::span(x.data(), std::size_t(element_dim(type) + 1)));
}

/// The fields of a projection belong together.
void check_consistent(ElementType type, const std::vector<double>& nodes, const Eigen::Vector3d& x,
                      const Projection& found) {
  REQUIRE(found.found);
  const Eigen::Vector3d point(found.point.data()), normal(found.normal.data());
  CHECK(inside(type, found.xi.data(), 0.0));
  CHECK((position(type, nodes, found.xi.data()) - point).norm() < 1e-13 * (1.0 + point.norm()));
  CHECK(found.distance == doctest::Approx((x - point).norm()).epsilon(1e-13));
  const auto t = tangents(type, nodes, found.xi.data());
  CHECK(std::abs(normal.norm() - 1.0) < 1e-14);
  CHECK((t.transpose() * normal).norm() < 1e-13 * t.norm());
}

/// No direction into the cell brings the point closer (Karush-Kuhn-Tucker): (ρ - x)·∂ρ/∂ξ·direction >= 0.
void check_optimal(ElementType type, const std::vector<double>& nodes, const Eigen::Vector3d& x,
                   const Projection& found) {
  const auto t = tangents(type, nodes, found.xi.data());
  const Eigen::Vector3d r = Eigen::Vector3d(found.point.data()) - x;
  const int directions = element_dim(type) == 1 ? 2 : 24;
  for (int i = 0; i < directions; ++i) {
    const double angle = 2.0 * M_PI * i / directions;
    const Eigen::Vector2d direction(std::cos(angle), element_dim(type) == 1 ? 0.0 : std::sin(angle));
    const Eigen::Vector2d ahead = Eigen::Vector2d(found.xi.data()) + 1e-6 * direction;
    if (!inside(type, ahead.data(), 1e-15)) continue;
    CHECK(r.dot(t * direction) >= -1e-11 * t.norm() * (r.norm() + t.norm()));
  }
}

Feature expected_feature(ElementType type, const std::array<double, 2>& xi) {
  int touched = 0;
  if (is_triangle(type))
    touched = (xi[0] < 1e-12) + (xi[1] < 1e-12) + (xi[0] + xi[1] > 1.0 - 1e-12);
  else
    for (int i = 0; i < element_dim(type); ++i)
      touched += std::abs(xi[i]) > 1.0 - 1e-12;
  if (touched == 0) return Feature::Facet;
  return element_dim(type) == 1 || touched == 2 ? Feature::Vertex : Feature::Edge;
}

} // namespace

TEST_CASE("closest_point: no sampled point of the facet is closer") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (const ElementType type : facet_types())
    for (const double disorder : {0.0, 0.06, 0.12})
      for (int repeat = 0; repeat < 200; ++repeat) {
        const auto nodes = random_facet(type, disorder, random);
        for (const double reach : {0.3, 1.0, 3.0, 100.0}) {
          Eigen::Vector3d x = Eigen::Vector3d::Zero();
          for (int i = 0; i <= element_dim(type); ++i)
            x[i] = 3.0 * (i + 1) + reach * number(random);
          const Projection found = project(type, nodes, x);
          CAPTURE(int(type));
          CAPTURE(disorder);
          CAPTURE(reach);
          check_consistent(type, nodes, x, found);
          check_optimal(type, nodes, x, found);
          CHECK(found.feature == expected_feature(type, found.xi));
          double least = 1e300;
          for (const auto& xi : grid(type, 24))
            least = std::min(least, (position(type, nodes, xi.data()) - x).norm());
          CHECK(found.distance <= least + 1e-12 * (1.0 + reach));
        }
      }
}

TEST_CASE("closest_point: a point lifted off the facet along its normal comes back") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (const ElementType type : facet_types())
    for (int repeat = 0; repeat < 50; ++repeat) {
      const auto nodes = random_facet(type, 0.05, random);
      std::array<double, 2> xi{number(random), element_dim(type) == 1 ? 0.0 : number(random)};
      if (is_triangle(type)) xi = {0.25 * (1.0 + xi[0]), 0.25 * (1.0 + xi[1])};
      std::array<double, 3> normal;
      facet_normal(type, nodes, std::span(xi).first(element_dim(type)), normal);
      for (const double lift : {0.0, 1e-9, 0.01, -0.01}) {
        const Eigen::Vector3d x = position(type, nodes, xi.data()) + lift * Eigen::Vector3d(normal.data());
        const Projection found = project(type, nodes, x);
        CAPTURE(int(type));
        CAPTURE(lift);
        check_consistent(type, nodes, x, found);
        CHECK(std::abs(found.xi[0] - xi[0]) < 1e-9);
        CHECK(std::abs(found.xi[1] - xi[1]) < 1e-9);
        CHECK(found.feature == Feature::Facet);
        CHECK((Eigen::Vector3d(found.normal.data()) - Eigen::Vector3d(normal.data())).norm() < 1e-8);
        CHECK(std::abs(found.distance - std::abs(lift)) < 1e-12);
      }
    }
}

TEST_CASE("closest_point: nodes and points on edges are their own projection") {
  std::mt19937 random(3);
  for (const ElementType type : facet_types())
    for (int repeat = 0; repeat < 20; ++repeat) {
      const auto nodes = random_facet(type, 0.1, random);
      for (const auto& xi : grid(type, 4)) {
        const Eigen::Vector3d x = position(type, nodes, xi.data());
        const Projection found = project(type, nodes, x);
        CAPTURE(int(type));
        check_consistent(type, nodes, x, found);
        CHECK(found.distance < 1e-12);
        CHECK(std::hypot(found.xi[0] - xi[0], found.xi[1] - xi[1]) < 1e-9);
      }
    }
}

TEST_CASE("closest_point: facet, edge and vertex of the unit triangle and the square, in closed form") {
  const std::vector<double> triangle = {0, 0, 0, 1, 0, 0, 0, 1, 0}, square = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  for (const bool tri : {true, false}) {
    const ElementType type = tri ? ElementType::Triangle3 : ElementType::Quadrilateral4;
    const auto& nodes = tri ? triangle : square;
    const Projection over = project(type, nodes, {0.25, 0.25, 2.0});
    CHECK(over.feature == Feature::Facet);
    CHECK(over.distance == doctest::Approx(2.0));
    CHECK(over.normal[2] == doctest::Approx(1.0));
    const Projection beside = project(type, nodes, {0.5, -3.0, 4.0});
    CHECK(beside.feature == Feature::Edge);
    CHECK(beside.distance == doctest::Approx(5.0));
    CHECK(beside.point[0] == doctest::Approx(0.5));
    const Projection corner = project(type, nodes, {-2.0, -2.0, 1.0});
    CHECK(corner.feature == Feature::Vertex);
    CHECK(corner.distance == doctest::Approx(3.0));
  }
  const std::vector<double> segment = {0, 0, 2, 0};
  const Projection foot = project(ElementType::Segment2, segment, {0.5, -1.0, 0.0});
  CHECK(foot.feature == Feature::Facet);
  CHECK(foot.xi[0] == doctest::Approx(-0.5));
  CHECK(foot.normal[1] == doctest::Approx(-1.0)); // (t_y, -t_x) with t = (1, 0)
  const Projection end = project(ElementType::Segment2, segment, {5.0, 4.0, 0.0});
  CHECK(end.feature == Feature::Vertex);
  CHECK(end.distance == doctest::Approx(5.0));
}

TEST_CASE("closest_point: a parabola has two equally close points above its focus side, and either is right") {
  // y = x² on [-1, 1]; from (0, h) with h > 1/2 the closest points are x² = h - 1/2 at distance sqrt(h - 1/4).
  const std::vector<double> parabola = {-1, 1, 1, 1, 0, 0};
  for (const double h : {0.6, 0.8, 1.2}) {
    const Projection found = project(ElementType::Segment3, parabola, {0.0, h, 0.0});
    REQUIRE(found.found);
    CHECK(std::abs(found.xi[0]) == doctest::Approx(std::sqrt(h - 0.5)));
    CHECK(found.distance == doctest::Approx(std::sqrt(h - 0.25)));
  }
}

TEST_CASE("closest_point: degenerate facets are not found, slivers are") {
  const auto refused = [](ElementType type, const std::vector<double>& nodes) {
    return !project(type, nodes, {0.3, 0.4, 0.5}).found;
  };
  CHECK(refused(ElementType::Segment2, {1, 1, 1, 1}));
  CHECK(refused(ElementType::Segment3, {1, 1, 1, 1, 1, 1}));
  CHECK(refused(ElementType::Triangle3, {0, 0, 0, 1, 1, 1, 2, 2, 2}));
  CHECK(refused(ElementType::Triangle3, {1, 2, 3, 1, 2, 3, 1, 2, 3}));
  CHECK(refused(ElementType::Quadrilateral4, {0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0}));
  const std::vector<double> sliver = {0, 0, 0, 1, 0, 0, 0.5, 1e-7, 0};
  const Projection found = project(ElementType::Triangle3, sliver, {0.5, 0.5e-7, 0.25});
  REQUIRE(found.found);
  CHECK(found.distance == doctest::Approx(0.25).epsilon(1e-12));
}
