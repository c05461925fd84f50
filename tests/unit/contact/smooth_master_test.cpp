// The smoothed master: order of its shape, continuous normals, creases, and that contact on it has everything that
// contact on facets has (tangent, balance, frame indifference, independence of ranks).
#include "moving_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <map>

using namespace amontons;
using namespace amontons::test;

namespace {

/// Takes the master to where the deformation has it.
const MasterSurface& master_of(Fixture& fixture, const Deformation& deformation) {
  fixture.set(fixture.u, deformation);
  fixture.problem->begin_increment(1.0, fixture.u);
  fixture.form->samples(fixture.problem->state_at(fixture.u));
  return *fixture.form->points().master();
}

/// Facets none of whose nodes is on the rim.
bool is_inner(const MasterSurface& master, std::int32_t facet) {
  const auto nodes = master.nodes(facet);
  return std::all_of(nodes.begin(), nodes.end(),
                     [&](std::int32_t node) { return master.facets_at(node).size() == (master.dim() == 2 ? 2u : 4u); });
}

/// x becomes the angle on a circle of radius 1 (in 3D the other side is kept).
Vector3d arc(const Vector3d& X, int dim) {
  const double angle = 1.5 * (X[0] - 0.5), radius = X[dim - 1];
  Vector3d x = X;
  x[0] = radius * std::sin(angle);
  x[dim - 1] = radius * std::cos(angle);
  return x;
}

/// Largest distance of inner facets' interiors from the circle.
double error_on_arc(int dim, int cells, const MasterSmoothing& smoothing) {
  Fixture fixture(
      {.dim = dim, .comm = PETSC_COMM_SELF, .search_distance = 3.0, .smoothing = smoothing, .cells = cells});
  const auto& master = master_of(fixture, [=](const Vector3d& X, bool) { return arc(X, dim); });
  double worst = 0.0;
  for (std::int32_t f = 0; f < master.num_facets(); ++f)
    for (const double s : {-0.8, -0.5, 0.0, 0.3, 0.7}) {
      if (!is_inner(master, f)) continue;
      const auto place = master.at(f, std::array{s, 0.4 * s}).place;
      worst = std::max(worst, std::abs(std::hypot(place[0], place[dim - 1]) - 1.0));
    }
  return worst;
}

/// A bumpy surface on a grid that is distorted already in the reference configuration.
Scene bumpy(int dim, const MasterSmoothing& smoothing) {
  return {.dim = dim,
          .comm = PETSC_COMM_SELF,
          .search_distance = 3.0,
          .smoothing = smoothing,
          .cells = 4,
          .shape = [dim](const Vector3d& X) {
            Vector3d x = X;
            for (int c = 0; c < dim - 1; ++c)
              x[c] += 0.03 * noise(X, c, 9);
            return x;
          }};
}

double largest_of_all(double mine) {
  MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  return mine;
}

/// Largest angle between normals of two facets at the nodes and edge points that they share, on any rank. Collective.
double largest_kink(const MasterSurface& master) {
  // By where the point lies among the nodes: one node, or the middle of two.
  std::map<std::vector<std::int32_t>, std::vector<Vector3d>> normals;
  const int corners = master.dim() == 2 ? 2 : 4;
  const double xi[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (std::int32_t f = 0; f < master.num_facets(); ++f)
    for (int v = 0; v < corners; ++v)
      for (const int w : {v, (v + 1) % corners}) {
        if (master.dim() == 2 && w != v) continue;
        std::vector<std::int32_t> key = {master.nodes(f)[v], master.nodes(f)[w]};
        std::sort(key.begin(), key.end());
        const std::array<double, 2> place = {0.5 * (xi[v][0] + xi[w][0]), 0.5 * (xi[v][1] + xi[w][1])};
        const auto at = master.at(f, place);
        normals[key].push_back(at.tangents.col(0).cross(at.tangents.col(1)).normalized());
      }
  double worst = 0.0;
  for (const auto& [key, all] : normals)
    for (const auto& n : all)
      worst = std::max(worst, n.cross(all[0]).norm());
  return largest_of_all(worst);
}

} // namespace

TEST_CASE("smoothed master: off an arc by the fourth power of the facets' size, facets by the second") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    const double smooth[] = {error_on_arc(dim, 6, CubicMaster{}), error_on_arc(dim, 12, CubicMaster{})};
    const double facets[] = {error_on_arc(dim, 6, FacetedMaster{}), error_on_arc(dim, 12, FacetedMaster{})};
    CHECK(facets[0] / facets[1] == doctest::Approx(4.0).epsilon(0.05));
    CHECK(smooth[0] / smooth[1] == doctest::Approx(16.0).epsilon(0.05));
    CHECK(smooth[0] < 0.02 * facets[0]);
  }
}

TEST_CASE("smoothed master: normals are continuous; nodes stay where they are") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    const auto rough_surface = rough(dim, 0.0, 0.0, 0.05, 2);
    Fixture faceted(bumpy(dim, FacetedMaster{})), smooth(bumpy(dim, CubicMaster{}));
    CHECK(largest_kink(master_of(faceted, rough_surface)) > 0.1);
    const auto& master = master_of(smooth, rough_surface);
    CHECK(largest_kink(master) < 1e-12);
    for (std::int32_t f = 0; f < master.num_facets(); ++f)
      for (int c = 0; c < dim; ++c)
        CHECK(std::abs(master.at(f, std::array{-1.0, -1.0}).place[c] - master.positions(f)[c]) < 1e-13);
  }
}

TEST_CASE("smoothed master: a roof keeps its ridge below the crease's angle and loses it above") {
  for (const int dim : {2, 3})
    for (const double crease : {40.0, 60.0}) { // the roof has 53 degrees
      CAPTURE(dim);
      CAPTURE(crease);
      Fixture fixture({.dim = dim,
                       .comm = PETSC_COMM_SELF,
                       .search_distance = 3.0,
                       .smoothing = CubicMaster{crease},
                       .cells = 4,
                       .shape = [=](const Vector3d& X) {
                         return Vector3d(X - 0.5 * std::abs(X[0] - 0.5) * (X[dim - 1] < 1.005) * X[dim - 1] *
                                                 Vector3d::Unit(dim - 1));
                       }});
      const auto& master = master_of(fixture, [](const Vector3d& X, bool) { return X; });
      double off = 0.0;
      for (std::int32_t f = 0; f < master.num_facets(); ++f)
        for (const double s : {-0.6, 0.1, 0.5}) {
          const auto x = master.at(f, std::array{s, s}).place;
          off = std::max(off, std::abs(x[dim - 1] - 1.0 + 0.5 * std::abs(x[0] - 0.5)));
        }
      off = largest_of_all(off);
      if (crease < 53.0)
        CHECK(off < 1e-13);
      else
        CHECK(off > 0.01);
    }
}

TEST_CASE("smoothed master: tangent of the whole contact residual") {
  for (const int dim : {2, 3})
    for (const auto& enforcement : all_enforcements)
      for (const ProjectionKind& projection : {ProjectionKind(ClosestPoint{}), ProjectionKind(SlaveNormal{})})
        for (const auto motion : {Motion::Slip, Motion::Mixed}) {
          CAPTURE(dim);
          CAPTURE(enforcement.index());
          CAPTURE(projection.index());
          CAPTURE(int(motion));
          const auto fixture = prepared({.dim = dim,
                                         .enforcement = enforcement,
                                         .projection = projection,
                                         .law = Coulomb{.mu = 0.3, .cohesion = 0.5},
                                         .smoothing = CubicMaster{}},
                                        motion, turn_of(dim));
          check_tangent(*fixture);
        }
}

TEST_CASE("smoothed master: forces turn with a rigid motion and balance") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    check_rigid_motion({.dim = dim, .law = Coulomb{.mu = 0.3}, .smoothing = CubicMaster{}}, Motion::Slip, 1e-10, 1e-10);
  }
}

TEST_CASE("smoothed master: histories do not depend on the number of ranks") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    const Scene scene{
        .dim = dim, .law = Coulomb{.mu = 0.3}, .search_distance = 0.15, .smoothing = CubicMaster{}, .cells = 5};
    auto alone = scene;
    alone.comm = PETSC_COMM_SELF;
    std::vector<Deformation> path;
    for (int step = 0; step <= 8; ++step)
      path.push_back(rough(dim, 0.11 * step, 0.03, 0.01, 5));
    Fixture many(scene), one(alone);
    const auto a = ride(many, path), b = ride(one, path);
    double scale = 0.0;
    for (const auto& record : b)
      scale = std::max(scale, record.force[dim - 1]);
    CHECK(scale > 1.0);
    for (std::size_t step = 0; step < path.size(); ++step)
      for (int c = 0; c < 3; ++c) {
        CAPTURE(step);
        CHECK(std::abs(a[step].force[c] - b[step].force[c]) < 1e-11 * scale);
        CHECK(std::abs(a[step].shear[c] - b[step].shear[c]) < 1e-11 * scale);
      }
  }
}

TEST_CASE("smoothed master: a flat surface stays flat, with the forces of facets") {
  for (const int dim : {2, 3})
    for (const int step : {0, 2, 4, 8}) { // whole slave facets off the end
      CAPTURE(dim);
      CAPTURE(step);
      Fixture fixture({.dim = dim, .search_distance = 0.1, .smoothing = CubicMaster{}});
      const auto records = ride(fixture, {[=](const Vector3d& X, bool upper) {
                                  Vector3d x = X;
                                  if (upper) x += 0.125 * step * Vector3d::UnitX() - 0.03 * Vector3d::Unit(dim - 1);
                                  return x;
                                }});
      const double overlap = 1.0 - 0.125 * step;
      CHECK(records[0].area == doctest::Approx(overlap).epsilon(1e-9));
      CHECK(std::abs(records[0].force[dim - 1] - 3.0 * 150.0 / 0.25 * 0.02 * overlap) < 1e-7);
      CHECK(std::abs(records[0].force[0]) < 1e-9);
    }
}

TEST_CASE("smoothed master: the force on a point that passes a corner of the master does not jump") {
  // The lower block is bent to an arc of 4 facets and the upper one is turned about its centre, pressed in. How far
  // apart are the forces of two neighbouring places, at most? In proportion to the way between them, where nothing
  // jumps.
  const auto largest_step = [](const MasterSmoothing& smoothing, int steps) {
    Fixture fixture({.dim = 2, .comm = PETSC_COMM_SELF, .search_distance = 0.3, .smoothing = smoothing, .cells = 4});
    std::vector<Deformation> path;
    for (int step = 0; step <= steps; ++step)
      path.push_back([=](const Vector3d& X, bool upper) {
        if (!upper) return arc(X, 2);
        const double angle = 0.2 * (X[0] - 0.5) + 0.3 * step / steps, radius = X[1] - 0.05;
        return Vector3d(radius * std::sin(angle), radius * std::cos(angle), 0.0);
      });
    const auto records = ride(fixture, path);
    double largest = 0.0, scale = 0.0;
    for (std::size_t i = 1; i < records.size(); ++i) {
      largest = std::max(largest, std::hypot(records[i].force[0] - records[i - 1].force[0],
                                             records[i].force[1] - records[i - 1].force[1]));
      scale = std::max(scale, records[i].force[1]);
    }
    return largest / scale;
  };
  const double faceted[] = {largest_step(FacetedMaster{}, 40), largest_step(FacetedMaster{}, 400)};
  const double smooth[] = {largest_step(CubicMaster{}, 40), largest_step(CubicMaster{}, 400)};
  CHECK(faceted[1] > 0.5 * faceted[0]);
  CHECK(smooth[1] < 0.15 * smooth[0]);
}
