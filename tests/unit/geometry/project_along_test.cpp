// Lines through facets: against points known to lie on them, and without leaks between neighbours.
#include "facets.hpp"

#include <Eigen/Geometry>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::testing;

namespace {

Eigen::Vector3d random_vector(int dim, std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  for (int i = 0; i < dim; ++i)
    v[i] = number(random);
  return v;
}

Projection meet(ElementType type, const std::vector<double>& nodes, const Eigen::Vector3d& x,
                const Eigen::Vector3d& d) {
  const std::size_t dim = element_dim(type) + 1;
  return project_along(type, nodes, std::span(x.data(), dim), std::span(d.data(), dim));
}

} // namespace

TEST_CASE("project_along: a line through a known point of the facet meets it there or closer") {
  std::mt19937 random(4);
  for (const ElementType type : facet_types())
    for (const double disorder : {0.0, 0.1})
      for (int repeat = 0; repeat < 60; ++repeat) {
        const auto nodes = random_facet(type, disorder, random);
        const auto places = grid(type, 6);
        const auto& xi = places[std::size_t(random()) % places.size()];
        std::array<double, 3> normal;
        facet_normal(type, nodes, std::span(xi).first(element_dim(type)), normal);
        Eigen::Vector3d d = random_vector(element_dim(type) + 1, random);
        if (std::abs(d.dot(Eigen::Vector3d(normal.data()))) < 0.2 * d.norm()) continue; // grazing
        const Eigen::Vector3d target = position(type, nodes, xi.data());
        for (const double s : {0.0, 0.3, -0.7, 50.0}) {
          const Eigen::Vector3d x = target - s * d;
          const Projection found = meet(type, nodes, x, d);
          CAPTURE(int(type));
          CAPTURE(s);
          REQUIRE(found.found);
          const Eigen::Vector3d r = Eigen::Vector3d(found.point.data()) - x;
          CHECK(inside(type, found.xi.data(), 0.0));
          CHECK((position(type, nodes, found.xi.data()) - Eigen::Vector3d(found.point.data())).norm() < 1e-12);
          CHECK(r.cross(d).norm() <
                1e-7 * d.norm() * (1.0 + r.norm())); // on the line, up to the tolerance at the border
          CHECK(found.distance <= std::abs(s) * d.norm() * (1.0 + 1e-12) + 1e-7);
        }
      }
}

TEST_CASE("project_along: straight facets are met where the plane equation says") {
  std::mt19937 random(5);
  int met = 0, missed = 0;
  for (int repeat = 0; repeat < 2000; ++repeat) {
    const auto nodes = random_facet(ElementType::Triangle3, 0.1, random);
    const Eigen::Vector3d p(nodes.data()), q(nodes.data() + 3), r(nodes.data() + 6);
    const Eigen::Vector3d n = (q - p).cross(r - p), d = random_vector(3, random);
    const Eigen::Vector3d x = (p + q + r) / 3.0 + random_vector(3, random);
    const Eigen::Vector3d hit = x + d * (n.dot(p - x) / n.dot(d));
    const bool in =
        n.dot((q - p).cross(hit - p)) > 0 && n.dot((r - q).cross(hit - q)) > 0 && n.dot((p - r).cross(hit - r)) > 0;
    const Projection found = meet(ElementType::Triangle3, nodes, x, d);
    CHECK(found.found == in);
    (in ? met : missed) += 1;
    if (in && found.found) CHECK((Eigen::Vector3d(found.point.data()) - hit).norm() < 1e-10 * (1.0 + (hit - x).norm()));
  }
  CHECK(met > 50);
  CHECK(missed > 50);
}

TEST_CASE("project_along: of two intersections the nearer is taken") {
  const std::vector<double> parabola = {-1, 1, 1, 1, 0, 0}; // y = x²
  const Projection right = meet(ElementType::Segment3, parabola, {0.1, 0.25, 0}, {1, 0, 0});
  REQUIRE(right.found);
  CHECK(right.point[0] == doctest::Approx(0.5));
  const Projection left = meet(ElementType::Segment3, parabola, {-0.1, 0.25, 0}, {1, 0, 0});
  REQUIRE(left.found);
  CHECK(left.point[0] == doctest::Approx(-0.5));
  // z = xy: twisted square; the line along (1, 1, 0) at height 1/4 meets it at ±(1/2, 1/2).
  const std::vector<double> twisted = {-1, -1, 1, 1, -1, -1, 1, 1, 1, -1, 1, -1};
  const Projection near = meet(ElementType::Quadrilateral4, twisted, {0.1, 0.1, 0.25}, {1, 1, 0});
  REQUIRE(near.found);
  CHECK(near.point[0] == doctest::Approx(0.5));
  CHECK(near.point[1] == doctest::Approx(0.5));
}

TEST_CASE("project_along: lines parallel to the facet and beside it miss") {
  CHECK_FALSE(meet(ElementType::Segment2, {0, 0, 1, 0}, {0.5, 1, 0}, {1, 0, 0}).found);
  CHECK_FALSE(meet(ElementType::Segment2, {0, 0, 1, 0}, {1.001, 1, 0}, {0, 1, 0}).found);
  CHECK_FALSE(meet(ElementType::Triangle3, {0, 0, 0, 1, 0, 0, 0, 1, 0}, {0.2, 0.2, 1}, {1, 1, 0}).found);
  CHECK_FALSE(meet(ElementType::Quadrilateral4, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, {0.2, 0.2, 1}, {1, 1, 0}).found);
  CHECK_FALSE(meet(ElementType::Quadrilateral4, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, {1.2, 0.2, 1}, {0, 0, 1}).found);
}

TEST_CASE("project_along: no line slips through a shared edge") {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> number(0.0, 1.0);
  for (const bool triangle : {true, false})
    for (int repeat = 0; repeat < 2000; ++repeat) {
      // Two facets that share the edge p-q, with corners on either side of it.
      const Eigen::Vector3d p = random_vector(3, random),
                            q = p + Eigen::Vector3d(1.0, 0.3, 0.2) + 0.1 * random_vector(3, random);
      const Eigen::Vector3d up(0.0, 1.0, 0.1 * number(random)), out(-0.2, 0.3, 1.0);
      std::array<std::vector<double>, 2> facets;
      for (int side = 0; side < 2; ++side) {
        const Eigen::Vector3d shift = side == 0 ? up : Eigen::Vector3d(-up);
        const std::vector<Eigen::Vector3d> corners = triangle
                                                         ? std::vector<Eigen::Vector3d>{p, q, q + shift}
                                                         : std::vector<Eigen::Vector3d>{p, q, q + shift, p + shift};
        for (const auto& corner : corners)
          facets[side].insert(facets[side].end(), corner.data(), corner.data() + 3);
      }
      const double s = number(random);
      const Eigen::Vector3d on_edge = (1.0 - s) * p + s * q, d = out + 0.2 * random_vector(3, random);
      const Eigen::Vector3d x = on_edge - 10.0 * number(random) * d;
      const ElementType type = triangle ? ElementType::Triangle3 : ElementType::Quadrilateral4;
      CHECK((meet(type, facets[0], x, d).found || meet(type, facets[1], x, d).found));
    }
}
