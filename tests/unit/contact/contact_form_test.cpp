// The contact pair as a form: search across ranks, residual against the potential, tangent against the residual.
#include "lone_pair.hpp"
#include "two_blocks.hpp"

#include <cmath>
#include <doctest/doctest.h>
#include <numeric>

using namespace amontons;
using namespace amontons::test;

namespace {

ContactPair declare_pair(int dim, Enforcement enforcement, ProjectionKind projection = {},
                         Integration integration = {}) {
  ContactPair pair{.name = "interface",
                   .slave = "upper_bottom",
                   .master = std::string("lower_top"),
                   .enforcement = enforcement,
                   .projection = projection,
                   .integration = integration,
                   .space = dim == 2 ? Space::PlaneStrain : Space::Solid,
                   .stiffness = {}};
  pair.alpha = 3.0;
  pair.search_distance = 0.5;
  pair.stiffness = {100.0, 300.0};
  return pair;
}

/// Smooth displacements that open one part and close another.
struct Fixture : LonePair {
  Fixture(int dim, Enforcement enforcement, ProjectionKind projection = {}, Integration integration = {})
      : LonePair(two_blocks_mesh(PETSC_COMM_WORLD, dim, 3, 4, 0.01),
                 declare_pair(dim, enforcement, projection, integration)) {
    set(u, 0.0, 1.0);
    if (std::holds_alternative<Uzawa>(enforcement)) {
      std::vector<double> multipliers;
      for (const auto node : form->nodes().nodes)
        multipliers.push_back(-0.2 - 0.1 * mesh.position(node)[0]);
      form->hold_multipliers(multipliers);
    }
  }

  /// base: a field with gaps of both signs; wiggle: a generic direction.
  void set(Vec vec, double wiggle, double base) const {
    VecArray values(vec);
    const int d = mesh.dim;
    for (std::int32_t node = 0; node < mesh.num_owned; ++node) {
      const auto x = mesh.position(node);
      const bool upper = x[d - 1] > 1.005;
      for (int c = 0; c < d; ++c) {
        double value = wiggle * std::sin(1.0 + 3.0 * x[0] + 2.0 * x[d - 1] + 5.0 * c);
        if (c == d - 1 && upper) value += base * (-0.05 + 0.1 * (x[0] > 0.55));
        values[node * d + c] = value;
      }
    }
    for (PetscInt i = mesh.num_owned * d; i < values.size(); ++i)
      values[i] = -base * 0.001 + wiggle * 0.01 * std::cos(double(i - mesh.num_owned * d));
  }
};

double norm(Vec vec) {
  double value = 0.0;
  VecNorm(vec, NORM_2, &value);
  return value;
}

void check_tangent(Fixture& fixture) {
  const auto direction = fixture.layout->new_vector(), x = fixture.layout->new_vector();
  const auto plus = fixture.layout->new_vector(), minus = fixture.layout->new_vector(),
             product = fixture.layout->new_vector();
  fixture.set(direction, 1.0, 0.0);
  auto matrix = fixture.problem->new_matrix();
  CHECK(fixture.problem->tangent(fixture.u, matrix));
  CHECK(MatMult(matrix, direction, product) == 0);
  const double step = 1e-5;
  VecWAXPY(x, step, direction, fixture.u);
  fixture.problem->residual(x, plus);
  VecWAXPY(x, -step, direction, fixture.u);
  fixture.problem->residual(x, minus);
  VecAXPY(plus, -1.0, minus);
  VecScale(plus, 0.5 / step);
  const double scale = norm(product);
  CHECK(scale > 1e-3); // not trivially zero
  VecAXPY(plus, -1.0, product);
  CHECK(norm(plus) <= 1e-7 * scale);
  PetscBool symmetric = PETSC_FALSE;
  MatHandle transposed;
  MatTranspose(matrix, MAT_INITIAL_MATRIX, transposed.put());
  MatEqual(matrix, transposed, &symmetric);
  MatAXPY(transposed, -1.0, matrix, DIFFERENT_NONZERO_PATTERN);
  double asymmetry = 0.0, size = 0.0;
  MatNorm(transposed, NORM_FROBENIUS, &asymmetry);
  MatNorm(matrix, NORM_FROBENIUS, &size);
  CHECK(asymmetry <= 1e-13 * size);
}

} // namespace

TEST_CASE("tangent is the derivative of the residual, and symmetric") {
  for (const int dim : {2, 3})
    for (const Enforcement& enforcement : {Enforcement(Penalty{}), Enforcement(Uzawa{}), Enforcement(Semismooth{0})})
      for (const ProjectionKind& projection : {ProjectionKind(ClosestPoint{}), ProjectionKind(SlaveNormal{})})
        for (const Integration& integration : {Integration(FacetIntegration{}), Integration(SegmentIntegration{})}) {
          CAPTURE(dim);
          CAPTURE(enforcement.index());
          CAPTURE(projection.index());
          CAPTURE(integration.index());
          Fixture fixture(dim, enforcement, projection, integration);
          check_tangent(fixture);
        }
}

TEST_CASE("a tangent is assembled again only when the status of a point has changed") {
  Fixture fixture(2, Semismooth{0});
  auto matrix = fixture.problem->new_matrix();
  CHECK(fixture.problem->tangent(fixture.u, matrix));
  CHECK_FALSE(fixture.problem->tangent(fixture.u, matrix));
  const auto direction = fixture.layout->new_vector();
  fixture.set(direction, 0.0, 1.0);
  VecAXPY(fixture.u, -2.0, direction); // contact moves to the other half
  CHECK(fixture.problem->tangent(fixture.u, matrix));
}

TEST_CASE("residual is the derivative of the contact potential, multipliers included") {
  for (const Enforcement& enforcement : {Enforcement(Penalty{}), Enforcement(Semismooth{0})}) {
    CAPTURE(enforcement.index());
    Fixture fixture(3, enforcement);
    const auto direction = fixture.layout->new_vector(), x = fixture.layout->new_vector(),
               residual = fixture.layout->new_vector();
    fixture.set(direction, 1.0, 0.0);
    fixture.problem->residual(fixture.u, residual);
    double product = 0.0;
    VecDot(residual, direction, &product);
    const double step = 1e-6;
    VecWAXPY(x, step, direction, fixture.u);
    const double plus = fixture.problem->stored_energy(x);
    VecWAXPY(x, -step, direction, fixture.u);
    const double minus = fixture.problem->stored_energy(x);
    CHECK(std::abs(product) > 1e-6);
    CHECK((plus - minus) / (2.0 * step) == doctest::Approx(product).epsilon(1e-6));
  }
}

TEST_CASE("contact forces balance, in sum and in moment, and equal the claimed pressure") {
  for (const int dim : {2, 3}) {
    Fixture fixture(dim, Penalty{});
    const auto residual = fixture.layout->new_vector();
    fixture.problem->residual(fixture.u, residual);
    double sums[4] = {}; // force x, y, z and moment in the plane of x and the vertical
    {
      VecReader f(residual);
      for (std::int32_t node = 0; node < fixture.mesh.num_owned; ++node) {
        const auto x = fixture.mesh.position(node);
        for (int c = 0; c < dim; ++c)
          sums[c] += f[node * dim + c];
        sums[3] += x[0] * f[node * dim + dim - 1] - x[dim - 1] * f[node * dim];
      }
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    const auto totals = fixture.form->totals(fixture.problem->state_at(fixture.u));
    CHECK(totals.force[dim - 1] > 0.0); // pushes the upper body up
    for (const double sum : sums)
      CHECK(std::abs(sum) <= 1e-12 * totals.force[dim - 1]);
    // Penalty on the closed part: p = ε (0.05 − 0.01), 0.04 over the facets left of x = 0.5 plus a ramp on the next.
    const double epsilon = 3.0 * 150.0 / 0.25;
    CHECK(totals.max_pressure == doctest::Approx(epsilon * 0.04).epsilon(1e-10));
  }
}

TEST_CASE("search finds the same gaps on any number of ranks, and nothing beyond the rim") {
  for (const int dim : {2, 3}) {
    const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, dim, 3, 4, 0.01);
    const DofLayout layout(mesh, {}, {});
    const auto pair = declare_pair(mesh.dim, Penalty{});
    const ContactPoints points(layout, pair);
    double sums[3] = {};
    for (const auto& point : points.points()) {
      CHECK(point.gap0 == doctest::Approx(0.01).epsilon(1e-12));
      CHECK(point.normal[dim - 1] == doctest::Approx(1.0));
      CHECK(point.master >= 0);
      sums[0] += point.weight;
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    CHECK(sums[0] == doctest::Approx(1.0).epsilon(1e-12));

    auto near = pair;
    near.search_distance = 0.005; // less than the gap: nothing in reach
    const ContactPoints out_of_reach(layout, near);
    for (const auto& point : out_of_reach.points())
      CHECK(point.master == ContactPoint::none);
  }
}

TEST_CASE("rigid masters: plane, sphere and their motion") {
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, 3, 2, 2, 0.0);
  const DofLayout layout(mesh, {}, {});
  auto pair = declare_pair(mesh.dim, Penalty{});
  pair.slave = "top";
  pair.master = RigidMaster{RigidPlane{{0.0, 0.0, 2.1}, {0.0, 0.0, -1.0}},
                            {std::nullopt, std::nullopt, Expression("-0.2*t", {})}};
  ContactPoints points(layout, pair);
  for (const auto& point : points.points())
    CHECK(point.gap0 == doctest::Approx(0.1));
  points.move_rigid_master(1.0);
  for (const auto& point : points.points()) {
    CHECK(point.gap0 == doctest::Approx(-0.1));
    CHECK(point.normal[2] == doctest::Approx(-1.0));
  }
  pair.master = RigidMaster{RigidSphere{{0.5, 0.5, 3.0}, 1.0}, {}};
  ContactPoints on_ball(layout, pair);
  for (const auto& point : on_ball.points()) {
    const double r = std::hypot(point.place[0] - 0.5, point.place[1] - 0.5);
    CHECK(point.gap0 == doctest::Approx(std::hypot(r, 1.0) - 1.0));
  }
}

TEST_CASE("the defect of held multipliers is the potential's derivative") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    Fixture fixture(dim, Uzawa{});
    const auto state = fixture.problem->state_at(fixture.u);
    const auto sum = [](double mine) {
      MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
      return mine;
    };
    const auto held = fixture.form->multipliers();
    std::vector<double> defect, mass, direction;
    for (const auto node : fixture.form->nodes().nodes)
      direction.push_back(0.01 * std::cos(3.0 * fixture.mesh.position(node)[0]));
    const auto energy_at = [&](double step) {
      auto multipliers = held;
      for (std::size_t i = 0; i < multipliers.size(); ++i)
        multipliers[i] += step * direction[i];
      fixture.form->hold_multipliers(multipliers);
      return sum(fixture.form->stored_energy(state));
    };
    const double difference = (energy_at(1e-3) - energy_at(-1e-3)) / 2e-3;
    fixture.form->hold_multipliers(held);
    fixture.form->multiplier_defect(state, defect, mass);
    const double derivative = sum(std::inner_product(defect.begin(), defect.end(), direction.begin(), 0.0));
    CHECK(std::abs(derivative) > 1e-6);
    CHECK(difference == doctest::Approx(derivative).epsilon(1e-6));
  }
}

TEST_CASE(
    "unknown multipliers that are held: forces of what is held, equations that lead there, and nothing is left of it") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    Fixture fixture(dim, Semismooth{0}), other(dim, Uzawa{}); // the latter holds the same tractions
    const auto residual = [](Fixture& of) {
      auto result = of.layout->new_vector();
      of.problem->residual(of.u, result);
      return result;
    };
    const auto same_forces = [](const Fixture& of, Vec one, Vec two) {
      VecReader a(one), b(two);
      int same = 1;
      for (PetscInt i = 0; i < of.mesh.num_owned * of.mesh.dim; ++i)
        same = same && a[i] == b[i];
      MPI_Allreduce(MPI_IN_PLACE, &same, 1, MPI_INT, MPI_MIN, PETSC_COMM_WORLD);
      return same == 1;
    };
    const auto free = residual(fixture);
    const auto unknown = fixture.form->multipliers();
    CHECK_FALSE(same_forces(fixture, free, residual(other)));
    fixture.form->hold_multipliers(other.form->multipliers());
    CHECK(same_forces(fixture, residual(fixture), residual(other)));
    check_tangent(fixture);

    // With unknowns s μ = λ held the multipliers' equations hold, whatever the gaps are.
    {
      VecArray values(fixture.u);
      const auto& nodes = fixture.form->nodes().nodes;
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        const PetscInt at = fixture.layout->extra_equation(0, nodes[i]) - fixture.layout->first_equation();
        if (at >= 0 && at < values.size())
          values[at] = fixture.form->multipliers()[i] / fixture.form->multiplier_scale();
      }
    }
    {
      const auto reached = residual(fixture);
      const VecReader values(reached);
      for (PetscInt i = fixture.mesh.num_owned * dim; i < values.size(); ++i)
        CHECK(std::abs(values[i]) < 1e-14);
    }
    fixture.set(fixture.u, 0.0, 1.0);
    fixture.form->release_multipliers();
    PetscBool equal = PETSC_FALSE;
    VecEqual(residual(fixture), free, &equal);
    CHECK(equal == PETSC_TRUE);
    CHECK(fixture.form->multipliers() == unknown);
    check_tangent(fixture);
  }
}

TEST_CASE("bodies held by nothing else get a first guess where they are nearest") {
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, 2, 3, 4, 0.01);
  const DofLayout layout(mesh, {}, {});
  auto pair = declare_pair(mesh.dim, Penalty{});
  pair.holds_floating_body = true;
  ContactForm form(layout, pair);
  const auto u = layout.new_vector();
  std::vector<double> displacement(std::size_t(mesh.num_local()) * 2, 0.0);
  State state{.time = 0.0, .unknowns = u, .displacement = displacement, .first_guess = true};
  CHECK(form.totals(state).area == doctest::Approx(1.0));
  state.first_guess = false;
  CHECK(form.totals(state).area == 0.0);
  // In equilibrium far from its place without this pair, the body is held by another one.
  form.commit(state);
  state.first_guess = true;
  CHECK(form.totals(state).area == doctest::Approx(1.0));
  std::fill(displacement.begin(), displacement.end(), 0.5);
  form.commit(state);
  CHECK(form.totals(state).area == 0.0);
}
