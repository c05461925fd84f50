// Contact in the current configuration: the tangent of the whole contact residual, frame indifference, balance, sliding
// over facets, ranks and ends, slip on curved surfaces against closed forms.
#include "moving_blocks.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

using Eigen::Vector3d;

TEST_CASE("finite kinematics: tangent of the whole contact residual, without friction") {
  for (const int dim : {2, 3})
    for (const int order : {1, 2})
      for (const auto& enforcement : all_enforcements)
        for (const ProjectionKind& projection : {ProjectionKind(ClosestPoint{}), ProjectionKind(SlaveNormal{})}) {
          CAPTURE(dim);
          CAPTURE(order);
          CAPTURE(enforcement.index());
          CAPTURE(projection.index());
          Fixture fixture({.dim = dim, .order = order, .enforcement = enforcement, .projection = projection});
          fixture.set(fixture.u, rough(dim, 0.03, 0.03, 0.012, 5));
          fixture.problem->begin_increment(1.0, fixture.u);
          check_tangent(fixture);
        }
}

TEST_CASE("finite kinematics: tangent of the whole contact residual in stick, slip and both, under large rotation") {
  for (const int dim : {2, 3})
    for (const int order : {1, 2})
      for (const auto& enforcement : all_enforcements)
        for (const auto motion : {Motion::Stick, Motion::Slip, Motion::Mixed}) {
          CAPTURE(dim);
          CAPTURE(order);
          CAPTURE(enforcement.index());
          CAPTURE(int(motion));
          // Held multipliers carry shear that is far from what slides: cohesion keeps stuck points stuck.
          const auto fixture = prepared({.dim = dim,
                                         .order = order,
                                         .enforcement = enforcement,
                                         .law = Coulomb{.mu = 0.3, .cohesion = motion == Motion::Stick ? 30.0 : 0.5}},
                                        motion, turn_of(dim));
          const auto totals = fixture->form->totals(fixture->problem->state_at(fixture->u));
          CHECK((totals.stick_area > 0.05) == (motion != Motion::Slip));
          CHECK((totals.slip_area > 0.05) == (motion != Motion::Stick));
          check_tangent(*fixture);
        }
}

TEST_CASE("finite kinematics: tangent where unknown multipliers are held elsewhere") {
  for (const int dim : {2, 3})
    for (const auto motion : {Motion::Stick, Motion::Slip, Motion::Mixed}) {
      CAPTURE(dim);
      CAPTURE(int(motion));
      const auto fixture = prepared(
          {.dim = dim, .enforcement = Semismooth{0}, .law = Coulomb{.mu = 0.3, .cohesion = 0.5}}, motion, turn_of(dim));
      fixture->hold_any_multipliers(turn_of(dim));
      check_tangent(*fixture);
    }
}

TEST_CASE("finite kinematics: tangent with the slave's normal, around an axis, and over rigid shapes") {
  const FrictionLaw law = Coulomb{.mu = 0.3, .cohesion = 0.5};
  for (const int dim : {2, 3})
    for (const auto motion : {Motion::Slip, Motion::Mixed}) {
      const auto fixture = prepared({.dim = dim, .projection = SlaveNormal{}, .law = law}, motion, turn_of(dim));
      check_tangent(*fixture);
    }
  check_tangent(*prepared({.enforcement = Semismooth{0}, .law = law, .space = Space::Axisymmetric}, Motion::Mixed,
                          Matrix3d::Identity()));
  const RigidShape shapes[] = {
      RigidPlane{{0.0, 1.0, 1.0}, {0.0, 0.0, 1.0}},
      RigidSphere{{0.5, 0.5, -0.3}, 1.3},
      RigidCylinder{{0.5, 0.5, 0.2}, {1.0, 0.0, 0.0}, 0.8},
      rounded_corner({0.5, 0.5, 1.1}, {{{0.0, -0.6, 0.8}, {0.0, 0.8, 0.6}}}, 0.4),
      RigidRoundedBox{BoxPart::Punch, {-0.1, -0.1, 1.1}, {0, 0, 1}, {1, 0, 0}, {0.7, 0.7}, 0.5, 0.4},
      RigidRoundedBox{BoxPart::Die, {-0.2, -0.2, 1.1}, {0, 0, 1}, {1, 0, 0}, {0.7, 0.7}, 0.3, 0.4}};
  for (const auto& shape : shapes) {
    CAPTURE(shape.index());
    const auto fixture =
        prepared({.dim = 3,
                  .enforcement = Semismooth{0},
                  .law = law,
                  .master = RigidMaster{shape, {Expression("0.02*t", {}), std::nullopt, Expression("0.01*t", {})}}},
                 Motion::Mixed, Matrix3d::Identity());
    check_tangent(*fixture);
  }
}

namespace {

/// Pressed by held multipliers over a gap above ridges, so that points hang over edges and corners.
std::unique_ptr<Fixture> hung_over_ridges(int dim, int seed) {
  auto fixture = std::make_unique<Fixture>(Scene{.dim = dim, .enforcement = Uzawa{}, .law = Coulomb{.mu = 0.3}});
  const auto ridges = [=](const Vector3d& X, bool upper) {
    Vector3d x = X;
    if (!upper && X[dim - 1] > 0.9)
      x[dim - 1] -=
          0.9 * (std::pow(X[0] - 0.5, 2) + (dim == 3 ? std::pow(X[1] - 0.5, 2) : 0.0)) + 0.01 * noise(X, 1, seed);
    if (upper) x += Vector3d(0.02 * seed, 0.0, 0.0) + 0.05 * Vector3d::Unit(dim - 1);
    return x;
  };
  fixture->set(fixture->u, ridges);
  fixture->hold_multipliers(Matrix3d::Identity());
  auto multipliers = fixture->form->multipliers();
  for (double& value : multipliers)
    value -= 400.0;
  fixture->form->hold_multipliers(multipliers);
  fixture->accept(0.5);
  fixture->set(fixture->u, [=](const Vector3d& X, bool upper) {
    return Vector3d(ridges(X, upper) + (upper ? 0.01 : 0.0) * Vector3d(1.0, dim == 3 ? 0.5 : 0.0, 0.0));
  });
  fixture->problem->begin_increment(1.0, fixture->u);
  return fixture;
}

/// Points in contact at edges and at corners, of all ranks.
std::array<int, 2> points_at_edges(Fixture& fixture) {
  std::array<int, 2> count{};
  const auto samples = fixture.form->samples(fixture.problem->state_at(fixture.u));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples.status[i] == ContactStatus::Open) continue;
    count[0] += std::holds_alternative<OnEdge>(fixture.form->points().now(i).hold);
    count[1] += std::holds_alternative<OnCorner>(fixture.form->points().now(i).hold);
  }
  MPI_Allreduce(MPI_IN_PLACE, count.data(), 2, MPI_INT, MPI_SUM, PETSC_COMM_WORLD);
  return count;
}

/// Force and moment, and the sum of the sizes of the forces; of all ranks.
using Wrench = Eigen::Matrix<double, 7, 1>;

void add_force(Wrench& wrench, const Vector3d& place, const Vector3d& force) {
  wrench.head<3>() += force;
  wrench.segment<3>(3) += place.cross(force);
  wrench[6] += force.norm();
}

/// Of the nodal forces of contact on one of the blocks.
Wrench nodal_wrench(const Fixture& fixture, bool upper) {
  const auto residual = fixture.layout->new_vector();
  fixture.problem->residual(fixture.u, residual);
  Wrench wrench = Wrench::Zero();
  const int dim = fixture.mesh.dim;
  {
    VecReader forces(residual), u(fixture.u);
    for (std::int32_t node = 0; node < fixture.mesh.num_owned; ++node) {
      Vector3d x = fixture.reference(node), force = Vector3d::Zero();
      if (fixture.is_upper(x) != upper) continue;
      for (int c = 0; c < dim; ++c) {
        x[c] += u[node * dim + c];
        force[c] = -forces[node * dim + c];
      }
      add_force(wrench, x, force);
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, wrench.data(), 7, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  return wrench;
}

/// Of the tractions on the slave that the pair claims, where it says that they act.
Wrench claimed_wrench(const Fixture& fixture) {
  const auto samples = fixture.form->samples(fixture.problem->state_at(fixture.u));
  Wrench wrench = Wrench::Zero();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto traction = samples.traction(i), place = samples.acts_at.at(i);
    add_force(wrench, Vector3d(place.data()), samples.weight[i] * Vector3d(traction.data()));
  }
  MPI_Allreduce(MPI_IN_PLACE, wrench.data(), 7, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  return wrench;
}

/// Both blocks feel the claimed tractions at the same places.
void check_claims(const Fixture& fixture) {
  const auto on_upper = nodal_wrench(fixture, true), on_lower = nodal_wrench(fixture, false),
             claimed = claimed_wrench(fixture);
  CHECK(claimed[6] > 0.1);
  for (int c = 0; c < 6; ++c) {
    CHECK(std::abs(on_upper[c] - claimed[c]) <= 1e-11 * claimed[6]);
    CHECK(std::abs(on_lower[c] + claimed[c]) <= 1e-11 * claimed[6]);
  }
}

} // namespace

TEST_CASE("finite kinematics: points at edges and corners of the master enter the tangent") {
  int edges = 0, corners = 0;
  for (const int dim : {2, 3})
    for (int seed = 1; seed <= 4; ++seed) {
      CAPTURE(dim);
      CAPTURE(seed);
      const auto fixture = hung_over_ridges(dim, seed);
      check_tangent(*fixture);
      const auto count = points_at_edges(*fixture);
      edges += count[0];
      corners += count[1];
    }
  CHECK(edges >= 10);
  CHECK(corners >= 10);
}

TEST_CASE("finite kinematics: both bodies feel the claimed tractions where these are said to act, moments included") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    for (int seed = 1; seed <= 4; ++seed) { // shear over gaps at edges and corners, too
      CAPTURE(seed);
      check_claims(*hung_over_ridges(dim, seed));
    }
    for (const int order : {1, 2})
      for (const ProjectionKind& projection : {ProjectionKind(ClosestPoint{}), ProjectionKind(SlaveNormal{})}) {
        CAPTURE(order);
        CAPTURE(projection.index());
        Fixture fixture({.dim = dim, .order = order, .projection = projection, .law = Coulomb{.mu = 0.3}});
        prepare(fixture, Motion::Slip, turn_of(dim));
        check_claims(fixture);
      }
  }
}

TEST_CASE("finite kinematics: a rigid motion of everything turns forces and does nothing else; they balance") {
  for (const int dim : {2, 3})
    for (const int order : {1, 2})
      for (const auto& enforcement : all_enforcements)
        for (const ProjectionKind& projection : {ProjectionKind(ClosestPoint{}), ProjectionKind(SlaveNormal{})})
          for (const auto motion : {Motion::Stick, Motion::Slip}) {
            CAPTURE(dim);
            CAPTURE(order);
            CAPTURE(enforcement.index());
            CAPTURE(projection.index());
            CAPTURE(int(motion));
            check_rigid_motion({.dim = dim,
                                .order = order,
                                .enforcement = enforcement,
                                .projection = projection,
                                .law = Coulomb{.mu = 0.3}},
                               motion, 1e-12, 1e-10);
          }
}

TEST_CASE("finite kinematics: an iterate that goes over the axis of revolution leaves nothing behind") {
  Fixture fixture({.enforcement = Semismooth{0}, .space = Space::Axisymmetric});
  const auto residual_at = [&](double along, double up) {
    fixture.set(fixture.u, [=](const Vector3d& X, bool upper) {
      return Vector3d(X + (upper ? Vector3d(along, up, 0.0) : Vector3d::Zero()));
    });
    auto residual = fixture.layout->new_vector();
    fixture.problem->residual(fixture.u, residual);
    return residual;
  };
  fixture.problem->begin_increment(1.0, fixture.u);
  const auto before = residual_at(0.0, 1.0); // out of reach of the master
  residual_at(0.0, -0.02);                   // in contact
  residual_at(-3.0, 1.0);                    // out of reach, at negative radii
  const auto after = residual_at(0.0, 1.0);
  CHECK(norm(before) > 1e-3); // unknown multipliers
  VecAXPY(after, -1.0, before);
  CHECK(norm(after) <= 1e-14 * norm(before));
}

TEST_CASE("finite kinematics: flat on flat, sliding over facets and off the end, against closed forms") {
  constexpr double mu = 0.3, depth = 0.02;
  for (const int dim : {2, 3})
    for (const int order : {1, 2})
      for (const ProjectionKind& projection : {ProjectionKind(ClosestPoint{}), ProjectionKind(SlaveNormal{})}) {
        CAPTURE(dim);
        CAPTURE(order);
        CAPTURE(projection.index());
        Fixture fixture(
            {.dim = dim, .order = order, .projection = projection, .law = Coulomb{.mu = mu}, .search_distance = 0.1});
        std::vector<Deformation> path;
        for (int step = 0; step <= 10; ++step)
          path.push_back([=](const Vector3d& X, bool upper) {
            Vector3d x = X;
            if (upper) x += 0.125 * step * Vector3d::UnitX() - (0.01 + depth) * Vector3d::Unit(dim - 1);
            return x;
          });
        const auto records = ride(fixture, path);
        const double epsilon = 3.0 * 150.0 / 0.25;
        for (int step = 0; step <= 10; ++step) {
          CAPTURE(step);
          // Whole slave facets (0.25 each) leave with every second step; in between the rim lies in a facet's middle,
          // which none of three Gauss points leaves to chance: the middle one sits on it.
          if (step % 2 == 1) continue;
          const double overlap = std::max(0.0, 1.0 - 0.125 * step);
          const auto& record = records[step];
          CHECK(record.area == doctest::Approx(overlap).epsilon(1e-9));
          CHECK(record.force[dim - 1] == doctest::Approx(epsilon * depth * overlap).epsilon(1e-9));
          const double shear = step == 0 ? 0.0 : -mu * epsilon * depth * overlap;
          CHECK(record.shear[0] == doctest::Approx(shear).epsilon(1e-9));
          CHECK(std::abs(record.shear[dim - 1]) < 1e-9);
          // Points that slide on slide by the whole step once the elastic slip mu p / epsilon is taken up.
          if (step >= 2)
            CHECK(record.dissipation == doctest::Approx(mu * epsilon * depth * overlap * 0.125).epsilon(1e-9));
        }
      }
}

TEST_CASE("finite kinematics: histories do not depend on the number of ranks") {
  for (const int dim : {2, 3})
    for (const int order : {1, 2}) {
      CAPTURE(dim);
      CAPTURE(order);
      const Scene scene{.dim = dim, .order = order, .law = Coulomb{.mu = 0.3}, .search_distance = 0.15};
      auto alone = scene;
      alone.comm = PETSC_COMM_SELF;
      std::vector<Deformation> path;
      for (int step = 0; step <= 12; ++step)
        path.push_back(rough(dim, 0.11 * step, 0.03, 0.01, 5));
      Fixture many(scene), one(alone);
      const auto a = ride(many, path), b = ride(one, path);
      double scale = 0.0;
      for (const auto& record : b)
        scale = std::max(scale, record.force[dim - 1]);
      CHECK(scale > 1.0);
      for (std::size_t step = 0; step < path.size(); ++step) {
        CAPTURE(step);
        for (int c = 0; c < 3; ++c) {
          CHECK(std::abs(a[step].force[c] - b[step].force[c]) < 1e-11 * scale);
          CHECK(std::abs(a[step].shear[c] - b[step].shear[c]) < 1e-11 * scale);
        }
        CHECK(std::abs(a[step].dissipation - b[step].dissipation) < 1e-11 * scale);
      }
      CHECK(a.back().area == 0.0); // it has slid off the end
      CHECK(a[4].shear[0] < -0.01 * scale);
    }
}

TEST_CASE("finite kinematics: the slip of arcs that turn in each other is radius times angle") {
  // The flat interface is bent to a circle of radius R: x becomes the angle (x − 0.5) / R. Order 2, for the lower block
  // is then curved; the upper one turns about the centre.
  constexpr double R = 2.0, turn = 0.02, depth = 0.005;
  constexpr int steps = 10;
  Fixture fixture({.dim = 2, .order = 2, .law = Coulomb{.mu = 0.05}, .search_distance = 0.15});
  std::vector<Deformation> path;
  for (int step = 0; step <= steps; ++step)
    path.push_back([=](const Vector3d& X, bool upper) {
      const double radius = R + (X[1] - 1.0) - (upper ? 0.01 + depth : 0.0);
      const double angle = (upper ? 0.6 : 1.0) * (X[0] - 0.5) / R + (upper ? turn * (step - steps / 2.0) : 0.0);
      return Vector3d(radius * std::sin(angle), radius * std::cos(angle), 0.0);
    });
  ride(fixture, {path.begin(), path.begin() + 2});
  const auto before = fixture.form->samples(fixture.problem->state_at(fixture.u));
  for (int step = 2; step <= steps; ++step) {
    fixture.set(fixture.u, path[step]);
    fixture.accept(step + 1.0);
  }
  const auto after = fixture.form->samples(fixture.problem->state_at(fixture.u));
  // Chords instead of arcs make the increments too short by turn² / 6 = 7e-5; facets of order 2 are off the circle by
  // 1e-5 in radius.
  const double exact = R * turn * (steps - 1);
  int count = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (after.status[i] == ContactStatus::Open) continue;
    ++count;
    CHECK(after.accumulated_slip[i] - before.accumulated_slip[i] == doctest::Approx(exact).epsilon(3e-3));
  }
  MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPI_INT, MPI_SUM, PETSC_COMM_WORLD);
  CHECK(count == 12);
}
