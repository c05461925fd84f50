// Gaps to a master with ridges, valleys and rims, in closed form; distances to cones against brute force.
#include "accuracy/gap_search.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <doctest/doctest.h>
#include <random>

using namespace amontons;
using namespace amontons::accuracy;

namespace {

/// A chain of segments in 2D through the given points; outward is to the right of the direction of travel. Each rank
/// holds every num_ranks-th segment.
struct Chain {
  Mesh mesh;
  FacetSet facets;
  std::vector<double> displacement;

  explicit Chain(const std::vector<std::array<double, 2>>& points) {
    int rank = 0, ranks = 1;
    mesh.comm = MPI_COMM_WORLD;
    MPI_Comm_rank(mesh.comm, &rank);
    MPI_Comm_size(mesh.comm, &ranks);
    mesh.dim = 2;
    for (const auto& point : points)
      mesh.coordinates.insert(mesh.coordinates.end(), point.begin(), point.end());
    for (std::int32_t i = rank; i + 1 < static_cast<std::int32_t>(points.size()); i += ranks) {
      facets.types.push_back(ElementType::Segment2);
      facets.nodes.insert(facets.nodes.end(), {i, i + 1});
      facets.offsets.push_back(static_cast<std::int32_t>(facets.nodes.size()));
      facets.bodies.push_back(0);
    }
    displacement.assign(mesh.coordinates.size(), 0.0);
  }

  MasterHit hit(std::array<double, 3> place, std::array<double, 3> displacement_of_point,
                std::array<double, 3> normal) const {
    const SlavePoint point{place, displacement_of_point, normal, 1.0};
    const auto points = std::span(&point, 1);
    return find_on_master(mesh, displacement, facets, points, reach_of(mesh, displacement, facets, points)).front();
  }
};

const double s = std::sqrt(0.5);

} // namespace

TEST_CASE("find_on_master: flat surface, its rim, and points behind it") {
  const Chain flat({{2, 0}, {1, 0}, {0, 0}}); // travelling to the left: outward is up
  const auto above = flat.hit({0.3, 0.2, 0}, {0.0, -0.5, 0}, {0, -1, 0});
  CHECK(above.found);
  CHECK(above.gap == doctest::Approx(-0.3));
  CHECK(above.beyond == 0.0);
  const auto on_node = flat.hit({1.0, 0.2, 0}, {0.0, -0.5, 0}, {0, -1, 0});
  CHECK(on_node.gap == doctest::Approx(-0.3));
  CHECK(on_node.beyond == 0.0);
  const auto over_rim = flat.hit({0.0, 0.2, 0}, {0.0, -0.5, 0}, {0, -1, 0});
  CHECK(over_rim.gap == doctest::Approx(-0.3));
  CHECK(over_rim.beyond == 0.0);
  const auto beyond = flat.hit({-0.3, 0.2, 0}, {0.0, -0.5, 0}, {0, -1, 0});
  CHECK(beyond.found);
  CHECK(beyond.beyond == doctest::Approx(0.3));
  CHECK(beyond.gap == doctest::Approx(-0.3));
  CHECK_FALSE(flat.hit({0.3, 0.2, 0}, {0, 0, 0}, {0, 1, 0}).found);   // looks away
  CHECK_FALSE(flat.hit({0.3, -1.5, 0}, {0, 0, 0}, {0, -1, 0}).found); // far behind
  CHECK_FALSE(flat.hit({0.3, 50.0, 0}, {0, 0, 0}, {0, -1, 0}).found); // out of reach
  CHECK(flat.hit({0.3, 50.0, 0}, {0, -60.0, 0}, {0, -1, 0}).gap == doctest::Approx(-10.0));
}

TEST_CASE("find_on_master: from a turned and moved start, everything is as seen from there") {
  // The flat master turned by 90 degrees counter-clockwise and moved by (3, 1): (x, y) -> (3 - y, 1 + x), up is -x now.
  Chain flat({{2, 0}, {1, 0}, {0, 0}});
  std::vector<double> start;
  for (std::size_t node = 0; node < 3; ++node) {
    const double x = flat.mesh.coordinates[2 * node], y = flat.mesh.coordinates[2 * node + 1];
    start.insert(start.end(), {3.0 - y - x, 1.0 + x - y});
    flat.displacement[2 * node + 1] = 0.1; // and from there along itself
  }
  const SlavePoint point{{2.8, 1.3, 0}, {-0.05, 0.4, 0}, {1, 0, 0}, 1.0}; // (0.3, 0.2) before
  const auto points = std::span(&point, 1);
  const double reach = reach_of(flat.mesh, flat.displacement, flat.facets, points, start);
  const auto hit = find_on_master(flat.mesh, flat.displacement, flat.facets, points, reach, start).front();
  REQUIRE(hit.found);
  CHECK(hit.gap == doctest::Approx(0.25));
  CHECK(hit.away[0] == doctest::Approx(-0.2));
  CHECK(std::abs(hit.away[1]) < 1e-12);
  CHECK(hit.jump[0] == doctest::Approx(-0.05));
  CHECK(hit.jump[1] == doctest::Approx(0.3));
}

TEST_CASE("find_on_master: the master's own displacement counts") {
  Chain flat({{2, 0}, {1, 0}, {0, 0}});
  for (std::size_t node = 0; node < 3; ++node)
    flat.displacement[2 * node + 1] = 0.1 * flat.mesh.coordinates[2 * node];
  CHECK(flat.hit({0.5, 0.2, 0}, {0, 0, 0}, {0, -1, 0}).gap == doctest::Approx(0.15));
}

TEST_CASE("find_on_master: over a ridge the gap is the distance from it") {
  const Chain roof({{1, -1}, {0, 0}, {-1, -1}});
  const auto over = roof.hit({0.1, 0.3, 0}, {0, -0.2, 0}, {0, -1, 0});
  const double r = std::hypot(0.1, 0.3);
  CHECK(over.beyond == 0.0);
  CHECK(over.gap == doctest::Approx(r - 0.2 * 0.3 / r));
  const auto beside = roof.hit({0.5, 0.0, 0}, {0, 0, 0}, {0, -1, 0});
  CHECK(beside.gap == doctest::Approx(0.5 * s));
}

TEST_CASE("find_on_master: under a valley the depth is the distance from it; above, from the nearer flank") {
  const Chain valley({{1, 1}, {0, 0}, {-1, 1}});
  const auto above = valley.hit({0.1, 0.5, 0}, {0, 0, 0}, {0, -1, 0});
  CHECK(above.gap == doctest::Approx(0.4 * s));
  const auto below = valley.hit({0.02, -0.1, 0}, {0, 0, 0}, {0, -1, 0});
  CHECK(below.gap == doctest::Approx(-std::hypot(0.02, 0.1)));
  CHECK(below.beyond == 0.0);
}

TEST_CASE("find_on_master: through a thin plate the far side is not an obstacle") {
  // A plate 0.1 thick, run around counterclockwise: its lower face looks down, its upper face up.
  const Chain plate({{0, 0}, {1, 0}, {1, 0.1}, {0, 0.1}, {0, 0}});
  // A point under the plate that looks down has its back to it.
  CHECK_FALSE(plate.hit({0.5, -0.05, 0}, {0, 0, 0}, {0, -1, 0}).found);
  CHECK(plate.hit({0.5, -0.05, 0}, {0, 0, 0}, {0, 1, 0}).gap == doctest::Approx(0.05));
}

TEST_CASE("distance_to_cone: agrees with sampling the cone") {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    Eigen::Vector3d v(normal(random), normal(random), 2.0 + normal(random));
    v.normalize();
    return std::array<double, 3>{v[0], v[1], v[2]};
  };
  for (const int count : {1, 2, 3, 4})
    for (int repeat = 0; repeat < 20; ++repeat) {
      std::vector<std::array<double, 3>> normals;
      for (int i = 0; i < count; ++i)
        normals.push_back(direction());
      const Eigen::Vector3d r(normal(random), normal(random), normal(random));
      const double distance = distance_to_cone({r[0], r[1], r[2]}, normals);
      // Projected coordinate descent on |r - Σ a n|², a >= 0: convex, so it converges to the same distance.
      std::vector<double> a(count, 0.0);
      Eigen::Vector3d rest = r;
      for (int sweep = 0; sweep < 20000; ++sweep)
        for (int i = 0; i < count; ++i) {
          const Eigen::Vector3d n(normals[i].data());
          const double step = std::max(-a[i], rest.dot(n));
          a[i] += step;
          rest -= step * n;
        }
      CHECK(distance == doctest::Approx(rest.norm()).epsilon(1e-6));
    }
  const std::vector<std::array<double, 3>> up = {{0, 0, 1}, {0, 0, 1}};
  CHECK(distance_to_cone({3, 4, 7}, up) == doctest::Approx(5.0));
  CHECK(distance_to_cone({0, 0, -2}, up) == doctest::Approx(2.0));
}
