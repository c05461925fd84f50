// Quadrature over a facet that other facets break: areas, exactness on each piece, points that lie where they say.
#include "geometry/segment_quadrature.hpp"

#include "facets.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <doctest/doctest.h>
#include <map>

using namespace amontons;
using namespace amontons::testing;

namespace {

/// A square (line) of side 2 about the origin in the plane z = height (y = height), divided into n x n equal facets
/// that look up or down; nodes moved by `warp` of their squared distance from the axis.
struct Patch {
  ElementType type;
  std::vector<std::vector<double>> facets;
  std::vector<FacetNodes> views() const {
    std::vector<FacetNodes> all;
    for (const auto& nodes : facets)
      all.push_back({type, nodes});
    return all;
  }
};

Patch make_patch(ElementType type, int n, double height, bool upwards, double turn, double warp) {
  Patch patch{type, {}};
  const int d = element_dim(type);
  const auto reference = reference_nodes(type);
  const bool triangles = is_triangle(type);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < (d == 2 ? n : 1); ++j)
      for (int half = 0; half < (triangles ? 2 : 1); ++half) {
        std::vector<double> nodes;
        for (int a = 0; a < num_nodes(type); ++a) {
          double r[2] = {reference[std::size_t(a) * d], d == 2 ? reference[std::size_t(a) * d + 1] : 0.0};
          if (!triangles) // cells of [0, 1]
            for (double& x : r)
              x = 0.5 * (x + 1.0);
          if (half == 1) std::tie(r[0], r[1]) = std::make_pair(1.0 - r[0], 1.0 - r[1]);
          // (x, y) -> (y, x) turns the normal of a surface around, x -> −x that of a line: lines look down by
          // themselves.
          if (d == 2 && !upwards) std::swap(r[0], r[1]);
          if (d == 1 && upwards) r[0] = 1.0 - r[0];
          const double x = 2.0 * (i + r[0]) / n - 1.0, y = d == 2 ? 2.0 * (j + r[1]) / n - 1.0 : 0.0;
          const double c = std::cos(turn), s = d == 2 ? std::sin(turn) : 0.0;
          const double level = height + warp * (x * x + y * y);
          if (d == 2)
            nodes.insert(nodes.end(), {c * x - s * y, s * x + c * y, level});
          else
            nodes.insert(nodes.end(), {x, level});
        }
        patch.facets.push_back(std::move(nodes));
      }
  return patch;
}

double area(ElementType type, const std::vector<double>& nodes, int degree) {
  const auto& rule = quadrature(type, degree);
  double sum = 0.0;
  std::array<double, 3> normal{};
  for (int q = 0; q < rule.size(); ++q)
    sum += rule.weights[q] * facet_normal(type, nodes, rule.point(q), normal);
  return sum;
}

double sum_of_weights(const std::vector<SegmentPoint>& points) {
  double sum = 0.0;
  for (const auto& point : points)
    sum += point.weight;
  return sum;
}

} // namespace

TEST_CASE("pieces of plane facets: each other facet gets its own area and first moments, from both sides") {
  for (const auto type : facet_types())
    for (const auto other_type : facet_types()) {
      if (element_dim(type) != element_dim(other_type)) continue;
      CAPTURE(int(type));
      CAPTURE(int(other_type));
      const int dim = element_dim(type) + 1;
      // The same square on both sides, so that everything is covered; turned by a right angle for less symmetry.
      const auto slave = make_patch(type, 3, 0.1, false, 0.0, 0.0);
      const auto master = make_patch(other_type, 5, 0.0, true, M_PI / 2.0, 0.0);
      std::map<int, std::array<double, 4>> moments; // area and ∫ x per facet of the master
      double total = 0.0;
      for (const auto& nodes : slave.facets) {
        const auto points = segment_quadrature({type, nodes}, master.views(), 2);
        CHECK(sum_of_weights(points) == doctest::Approx(area(type, nodes, 2)).epsilon(1e-13));
        for (const auto& point : points) {
          REQUIRE(point.other != SegmentPoint::uncovered);
          CHECK(point.weight > 0.0);
          CHECK(inside(type, point.xi.data(), 1e-12));
          const Eigen::Vector3d x = position(type, nodes, point.xi.data());
          total += point.weight * x[0] * x[0];
          const double powers[4] = {1.0, x[0], x[1], x[2]};
          for (int k = 0; k < 4; ++k)
            moments[point.other][k] += point.weight * powers[k];
        }
      }
      CHECK(total == doctest::Approx(dim == 2 ? 2.0 / 3.0 : 4.0 / 3.0).epsilon(1e-12));
      REQUIRE(moments.size() == master.facets.size());
      for (const auto& [facet, sums] : moments) {
        const auto& nodes = master.facets[facet];
        const double size = area(other_type, nodes, 2);
        CHECK(sums[0] == doctest::Approx(size).epsilon(1e-12));
        const double centre[2] = {is_triangle(other_type) ? 1.0 / 3.0 : 0.0, is_triangle(other_type) ? 1.0 / 3.0 : 0.0};
        const Eigen::Vector3d middle = position(other_type, nodes, centre);
        for (int c = 0; c < dim - 1; ++c)
          CHECK(std::abs(sums[1 + c] / size - middle[c]) < 1e-12);
      }
    }
}

TEST_CASE("curved and warped facets: the area of the true facet, whatever breaks it") {
  for (const auto type : facet_types()) {
    CAPTURE(int(type));
    const auto slave = make_patch(type, 3, 0.2, false, 0.0, 0.1);
    const auto master = make_patch(type, 4, 0.0, true, 0.0, 0.1);
    double previous = 0.0;
    for (const int degree : {4, 12}) {
      double worst = 0.0;
      for (const auto& nodes : slave.facets) {
        const auto points = segment_quadrature({type, nodes}, master.views(), degree);
        const double exact = area(type, nodes, 30);
        worst = std::max(worst, std::abs(sum_of_weights(points) / exact - 1.0));
        for (const auto& point : points)
          CHECK(inside(type, point.xi.data(), 1e-12));
      }
      CHECK(worst < (degree == 4 ? 1e-5 : 1e-10));
      if (degree == 12) CHECK(worst <= previous);
      previous = worst + 1e-14;
    }
  }
}

TEST_CASE("a facet that sticks out of the others: what is uncovered is known and nothing is lost") {
  for (const auto type : facet_types()) {
    CAPTURE(int(type));
    const bool line = element_dim(type) == 1;
    const auto slave = make_patch(type, 1, 0.0, false, 0.0, 0.0);
    auto master = make_patch(type, 4, -0.1, true, 0.0, 0.0);
    for (auto& nodes : master.facets)
      for (std::size_t i = 0; i < nodes.size(); i += line ? 2 : 3)
        nodes[i] += 0.7; // covers 0.65 of the square
    double covered = 0.0, all = 0.0;
    for (const auto& nodes : slave.facets)
      for (const auto& point : segment_quadrature({type, nodes}, master.views(), 3)) {
        const double x = position(type, nodes, point.xi.data())[0];
        CHECK((point.other == SegmentPoint::uncovered) == (x < -0.3));
        all += point.weight;
        if (point.other != SegmentPoint::uncovered) covered += point.weight;
      }
    CHECK(all == doctest::Approx(line ? 2.0 : 4.0).epsilon(1e-13));
    CHECK(covered == doctest::Approx(0.65 * all).epsilon(1e-12));

    // Nothing over it at all: its own rule.
    const auto& rule = quadrature(type, 3);
    const auto alone = segment_quadrature({type, slave.facets[0]}, {}, 3);
    REQUIRE(alone.size() == std::size_t(rule.size()));
    for (int q = 0; q < rule.size(); ++q)
      CHECK(alone[q].xi[0] == rule.point(q)[0]);
  }
}

TEST_CASE("facets that lie over one another: the nearer one gets the place, once") {
  for (const auto type : facet_types()) {
    CAPTURE(int(type));
    const auto slave = make_patch(type, 2, 0.0, false, 0.0, 0.0);
    auto others = make_patch(type, 1, -0.3, true, 0.0, 0.0);
    const auto far = others.facets.size();
    auto near = make_patch(type, 3, -0.1, true, 0.0, 0.0);
    for (auto& nodes : near.facets) {
      if (nodes[0] > 0.34) continue; // a third is missing
      others.facets.push_back(nodes);
    }
    double sum = 0.0, on_near = 0.0;
    for (const auto& nodes : slave.facets)
      for (const auto& point : segment_quadrature({type, nodes}, others.views(), 2)) {
        REQUIRE(point.other != SegmentPoint::uncovered);
        sum += point.weight;
        if (std::size_t(point.other) >= far) on_near += point.weight;
      }
    const double whole = element_dim(type) == 1 ? 2.0 : 4.0;
    double nearer = 0.0;
    for (std::size_t i = far; i < others.facets.size(); ++i)
      nearer += area(type, others.facets[i], 2);
    CHECK(nearer > 0.5 * whole);
    CHECK(nearer < whole);
    CHECK(sum == doctest::Approx(whole).epsilon(1e-12));
    CHECK(on_near == doctest::Approx(nearer).epsilon(1e-12));
  }
}

TEST_CASE("random plane facets over random others: the parts add up in any position in space") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (int trial = 0; trial < 300; ++trial) {
    const auto type = trial % 2 == 0 ? ElementType::Quadrilateral4 : ElementType::Triangle6;
    auto slave = make_patch(type, 1, 0.0, false, 0.0, 0.0);
    auto master = make_patch(ElementType::Triangle3, 4, -0.05, true, number(random), 0.0);
    const Eigen::Quaterniond turn(Eigen::Vector4d(number(random), number(random), number(random), 1.0).normalized());
    const Eigen::Vector3d shift(100.0 * number(random), 10.0, 1.0);
    for (auto* patch : {&slave, &master})
      for (auto& nodes : patch->facets)
        for (std::size_t i = 0; i < nodes.size(); i += 3) {
          Eigen::Map<Eigen::Vector3d> x(&nodes[i]);
          x = (turn * x + shift).eval();
        }
    double sum = 0.0;
    for (const auto& nodes : slave.facets) {
      const auto points = segment_quadrature({type, nodes}, master.views(), 1);
      sum += sum_of_weights(points);
      for (const auto& point : points) {
        if (point.other == SegmentPoint::uncovered) continue;
        const Eigen::Vector3d x = position(type, nodes, point.xi.data()), up = turn * Eigen::Vector3d::UnitZ();
        const auto seen =
            project_along(ElementType::Triangle3, master.facets[point.other], {x.data(), 3}, {up.data(), 3});
        CHECK(seen.found);
        CHECK(seen.distance == doctest::Approx(0.05).epsilon(1e-9));
      }
    }
    CHECK(sum == doctest::Approx(4.0).epsilon(1e-12));
  }
}
