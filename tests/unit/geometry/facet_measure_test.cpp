// Normals and measures of facets by finite differences and exact areas; orientation; facet_size.
#include "facets.hpp"

#include <Eigen/Geometry>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::testing;

TEST_CASE("facet_normal: equals the cross product of finite-difference tangents") {
  std::mt19937 random(7);
  for (const ElementType type : facet_types())
    for (int repeat = 0; repeat < 20; ++repeat) {
      const auto nodes = random_facet(type, 0.1, random);
      const std::array<double, 2> xi{0.21, element_dim(type) == 1 ? 0.0 : 0.34};
      const double step = 1e-5;
      std::array<Eigen::Vector3d, 2> t{Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0, 1)};
      for (int i = 0; i < element_dim(type); ++i) {
        auto ahead = xi, behind = xi;
        ahead[i] += step;
        behind[i] -= step;
        t[i] = (position(type, nodes, ahead.data()) - position(type, nodes, behind.data())) / (2.0 * step);
      }
      // In 2D t × e_z = (t_y, -t_x, 0): the outward normal of FacetSet.
      const Eigen::Vector3d area = t[0].cross(t[1]);
      std::array<double, 3> normal;
      const double measure = facet_normal(type, nodes, std::span(xi).first(element_dim(type)), normal);
      CAPTURE(int(type));
      CHECK(measure == doctest::Approx(area.norm()).epsilon(1e-8));
      CHECK((Eigen::Vector3d(normal.data()) - area.normalized()).norm() < 1e-8);
    }
}

TEST_CASE("facet_normal: points out of the reference square and cube for boundaries oriented as in FacetSet") {
  std::array<double, 3> normal;
  const std::array<double, 2> centre{0.0, 0.0};
  // Bottom edge of a square run counterclockwise; bottom and top faces of a cube.
  facet_normal(ElementType::Segment2, std::vector<double>{0, 0, 1, 0}, std::span(centre).first(1), normal);
  CHECK(normal[1] == doctest::Approx(-1.0));
  facet_normal(ElementType::Quadrilateral4, std::vector<double>{0, 0, 0, 0, 1, 0, 1, 1, 0, 1, 0, 0}, centre, normal);
  CHECK(normal[2] == doctest::Approx(-1.0));
  facet_normal(ElementType::Triangle3, std::vector<double>{0, 0, 1, 1, 0, 1, 0, 1, 1}, centre, normal);
  CHECK(normal[2] == doctest::Approx(1.0));
}

TEST_CASE("facet_normal: the measure integrates to the area") {
  // y = x²/2 on [-1, 1] has length sqrt(2) + asinh(1).
  const std::vector<double> parabola = {-1, 0.5, 1, 0.5, 0, 0};
  const Quadrature& rule = quadrature(ElementType::Segment3, 31);
  double length = 0.0;
  std::array<double, 3> normal;
  for (int q = 0; q < rule.size(); ++q)
    length += rule.weights[q] * facet_normal(ElementType::Segment3, parabola, rule.point(q), normal);
  CHECK(length == doctest::Approx(std::sqrt(2.0) + std::asinh(1.0)).epsilon(1e-9));
}

TEST_CASE("facet_size: the side of unit facets, and proportional to the scale") {
  const std::vector<double> segment = {0, 0, 3, 4}, triangle = {0, 0, 0, 1, 0, 0, 0, 1, 0},
                            square = {0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0};
  CHECK(facet_size(ElementType::Segment2, segment) == doctest::Approx(5.0));
  CHECK(facet_size(ElementType::Triangle3, triangle) == doctest::Approx(1.0));
  CHECK(facet_size(ElementType::Quadrilateral4, square) == doctest::Approx(2.0));
  std::mt19937 random(8);
  for (const ElementType type : facet_types()) {
    auto nodes = random_facet(type, 0.1, random);
    const double size = facet_size(type, nodes);
    for (double& value : nodes)
      value *= 7.0;
    CHECK(facet_size(type, nodes) == doctest::Approx(7.0 * size));
  }
}
