// Cubic facets: derivatives by differences, projections by brute force.
#include "geometry/bezier_facet.hpp"

#include "facets.hpp"

#include <Eigen/Geometry>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::testing;

namespace {

using Eigen::Vector3d;

/// A random facet of order 1 whose control points are moved off it by up to `disorder` of a third of the side.
std::vector<double> random_control(int dim, double disorder, std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const auto type = dim == 2 ? ElementType::Segment2 : ElementType::Quadrilateral4;
  const auto nodes = random_facet(type, 0.1, random);
  std::vector<double> control;
  for (int j = 0; j < (dim == 2 ? 1 : 4); ++j)
    for (int i = 0; i < 4; ++i) {
      const std::array<double, 2> xi = {2.0 * i / 3.0 - 1.0, 2.0 * j / 3.0 - 1.0};
      const auto at = surface_point(type, nodes, xi);
      for (int c = 0; c < dim; ++c)
        control.push_back(at.place[c] + disorder / 3.0 * number(random));
    }
  return control;
}

} // namespace

TEST_CASE("cubic facets: tangents and second derivatives are those of the place; corners are control points") {
  std::mt19937 random(3);
  for (const int dim : {2, 3}) {
    const auto control = random_control(dim, 0.5, random);
    const BezierFacet facet{dim, control};
    const auto corner = surface_point(facet, std::array{-1.0, -1.0});
    for (int c = 0; c < dim; ++c)
      CHECK(corner.place[c] == doctest::Approx(control[c]).epsilon(1e-14));
    const std::array<double, 2> xi = {0.3, -0.2};
    constexpr double h = 1e-5;
    const auto at = surface_point(facet, xi);
    for (int k = 0; k < dim - 1; ++k) {
      auto up = xi, down = xi;
      up[k] += h;
      down[k] -= h;
      const auto plus = surface_point(facet, up), minus = surface_point(facet, down);
      CHECK((at.tangents.col(k) - (plus.place - minus.place) / (2.0 * h)).norm() < 1e-9);
      CHECK((at.second.col(2 * k) - (plus.tangents.col(k) - minus.tangents.col(k)) / (2.0 * h)).norm() < 1e-9);
      if (dim == 3)
        CHECK((at.second.col(1) - (plus.tangents.col(1 - k) - minus.tangents.col(1 - k)) / (2.0 * h)).norm() < 1e-9);
    }
  }
}

TEST_CASE(
    "cubic facets: the closest point is the nearest of many, and what lies over the facet is found along its normal") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (const int dim : {2, 3})
    for (int round = 0; round < 60; ++round) {
      CAPTURE(dim);
      CAPTURE(round);
      const auto control = random_control(dim, 0.3, random);
      const BezierFacet facet{dim, control};
      std::array<double, 2> xi = {0.9 * number(random), dim == 3 ? 0.9 * number(random) : 0.0};
      const auto at = surface_point(facet, xi);
      const Vector3d n = at.tangents.col(0).cross(at.tangents.col(1)).normalized();
      const double height = 0.2 * number(random);
      const Vector3d x = at.place + height * n;
      const std::span<const double> place(x.data(), dim), direction(n.data(), dim);
      const auto closest = closest_point(facet, place);
      REQUIRE(closest.found);
      double nearest = 1e300;
      const int lines = dim == 2 ? 2000 : 60;
      for (int i = 0; i <= lines; ++i)
        for (int j = 0; j <= (dim == 2 ? 0 : lines); ++j)
          nearest = std::min(
              nearest,
              (surface_point(facet, std::array{2.0 * i / lines - 1.0, 2.0 * j / lines - 1.0}).place - x).norm());
      CHECK(closest.distance <= nearest + 1e-12);
      CHECK(closest.distance == doctest::Approx((surface_point(facet, closest.xi).place - x).norm()).epsilon(1e-12));
      if (closest.feature == Feature::Facet) {
        const auto found = surface_point(facet, closest.xi);
        CHECK((found.tangents.leftCols(dim - 1).transpose() * (x - found.place)).norm() < 1e-11);
      }
      const auto along = project_along(facet, place, direction);
      REQUIRE(along.found);
      CHECK(along.distance <= std::abs(height) + 1e-12);
      CHECK((Vector3d::Map(along.point.data()) - x).cross(n).norm() < 1e-11);
    }
}

TEST_CASE("cubic facets: features, and lines that miss") {
  const std::vector<double> straight = {0.0, 0.0, 1.0, 0.0, 2.0, 0.0, 3.0, 0.0};
  const BezierFacet segment{2, straight};
  CHECK(closest_point(segment, std::array{1.2, 0.4}).feature == Feature::Facet);
  CHECK(closest_point(segment, std::array{1.2, 0.4}).distance == doctest::Approx(0.4));
  CHECK(closest_point(segment, std::array{-1.0, 0.4}).feature == Feature::Vertex);
  CHECK_FALSE(project_along(segment, std::array{-1.0, 0.4}, std::array{0.0, 1.0}).found);
  std::vector<double> plane;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      plane.insert(plane.end(), {double(i), double(j), 0.0});
  const BezierFacet patch{3, plane};
  CHECK(closest_point(patch, std::array{1.0, 2.0, 0.5}).feature == Feature::Facet);
  CHECK(closest_point(patch, std::array{4.0, 2.0, 0.5}).feature == Feature::Edge);
  CHECK(closest_point(patch, std::array{4.0, 5.0, 0.5}).feature == Feature::Vertex);
  CHECK_FALSE(project_along(patch, std::array{4.0, 2.0, 0.5}, std::array{0.0, 0.0, 1.0}).found);
}
