// Friction in a contact pair as a form: tangent against residual in stick, slip and both, the traction against closed
// forms, history, invariance.
#include "lone_pair.hpp"
#include "two_blocks.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

namespace {

constexpr double gap0 = 0.01;

enum class Motion { Stick, Slip, Mixed };

struct Scene {
  int dim = 2;
  Enforcement enforcement = Penalty{};
  FrictionLaw law = Coulomb{.mu = 0.3};
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Space space = Space::PlaneStrain;
  Integration integration = FacetIntegration{};
  std::optional<Expression> factor = std::nullopt;
};

/// Two blocks with nothing but a frictional pair between them, and displacements by formula.
struct Fixture : LonePair {
  Scene scene;
  bool slid = false; // any point, in the accepted state

  static Mesh turned_mesh(const Scene& scene) {
    auto raw = two_blocks(PETSC_COMM_WORLD, scene.dim, 3, 4, gap0);
    for (std::size_t i = 0; i + 2 < raw.coordinates.size(); i += 3) {
      Eigen::Map<Eigen::Vector3d> x(&raw.coordinates[i]);
      x = (scene.turn * x).eval();
    }
    return distribute_mesh(PETSC_COMM_WORLD, raw, {{"upper_bottom", "lower_top"}}, 0);
  }

  static ContactPair declare_pair(const Scene& scene) {
    ContactPair pair{.name = "interface",
                     .slave = "upper_bottom",
                     .master = std::string("lower_top"),
                     .enforcement = scene.enforcement,
                     .projection = {},
                     .integration = scene.integration,
                     .space = scene.dim == 3 ? Space::Solid : scene.space,
                     .stiffness = {100.0, 300.0}};
    pair.alpha = 3.0;
    pair.search_distance = 0.5;
    pair.friction = Friction{.law = scene.law, .factor = scene.factor};
    return pair;
  }

  explicit Fixture(const Scene& s) : LonePair(turned_mesh(s), declare_pair(s)), scene(s) {
    if (std::holds_alternative<Uzawa>(scene.enforcement)) hold_multipliers();
  }

  void hold_multipliers() {
    std::vector<double> normal;
    std::vector<std::vector<double>> shear(scene.dim);
    for (const auto node : form->nodes().nodes) {
      normal.push_back(-0.2 - 0.1 * mesh.position(node)[0]);
      for (int c = 0; c < scene.dim; ++c)
        shear[c].push_back(0.5 - 0.2 * c);
    }
    form->hold_multipliers(normal);
    form->tangential()->hold_multipliers(shear);
  }

  /// The upper block moves by `push` along x (and a little along y in 3D) more with growing x when `spread`, and goes
  /// down where x < 0.55, up elsewhere; waves of size `wiggle` on everything.
  void set(Vec vec, double push, double spread, double down, double wiggle) const {
    VecArray values(vec);
    const int d = mesh.dim;
    for (std::int32_t node = 0; node < mesh.num_owned; ++node) {
      const Eigen::Vector3d x = scene.turn.transpose() * reference(node);
      Eigen::Vector3d v = Eigen::Vector3d::Zero();
      for (int c = 0; c < d; ++c)
        v[c] = wiggle * std::sin(1.0 + 3.0 * x[0] + 2.0 * x[d - 1] + 5.0 * c);
      if (x[d - 1] > 1.0 + 0.5 * gap0) {
        v[d - 1] += down * (-0.05 + 0.1 * (x[0] > 0.55));
        v[0] += push + spread * x[0];
        if (d == 3) v[1] += 0.4 * push;
      }
      v = (scene.turn * v).eval();
      for (int c = 0; c < d; ++c)
        values[node * d + c] = v[c];
    }
    for (PetscInt i = mesh.num_owned * d; i < values.size(); ++i) // multipliers
      values[i] = -0.001 * down + wiggle * 0.01 * std::cos(double(i - mesh.num_owned * d));
  }

  /// An accepted state that sticks but for a few points, then a state of the wanted kind under test.
  void prepare(Motion motion) {
    set(u, 0.002, 0.0, 1.0, 1e-4);
    problem->begin_increment(0.5, u);
    const auto residual = layout->new_vector();
    problem->residual(u, residual);
    slid = form->totals(problem->state_at(u)).slip_area > 0.0;
    problem->commit(u);
    const double push = motion == Motion::Stick ? 0.004 : motion == Motion::Slip ? 0.08 : 0.001;
    set(u, push, motion == Motion::Mixed ? 0.05 : 0.0, 1.02, 1e-4);
    problem->begin_increment(1.0, u);
  }
};

double norm(Vec vec) {
  double value = 0.0;
  VecNorm(vec, NORM_2, &value);
  return value;
}

double asymmetry(Mat matrix) {
  MatHandle transposed;
  MatTranspose(matrix, MAT_INITIAL_MATRIX, transposed.put());
  MatAXPY(transposed, -1.0, matrix, DIFFERENT_NONZERO_PATTERN);
  double difference = 0.0, size = 0.0;
  MatNorm(transposed, NORM_FROBENIUS, &difference);
  MatNorm(matrix, NORM_FROBENIUS, &size);
  return difference / size;
}

/// Central differences, and the Taylor remainder that must fall like h² (or be rounding, where the law is linear).
void check_tangent(Fixture& fixture, Motion motion) {
  fixture.prepare(motion);
  const auto direction = fixture.layout->new_vector(), x = fixture.layout->new_vector();
  const auto base = fixture.layout->new_vector(), plus = fixture.layout->new_vector(),
             minus = fixture.layout->new_vector(), product = fixture.layout->new_vector();
  fixture.set(direction, 0.7, 0.3, 0.0, 1.0);
  auto matrix = fixture.problem->new_matrix();
  REQUIRE(fixture.problem->tangent(fixture.u, matrix)); // of the first guess: what slid slides on, all else sticks
  CHECK((asymmetry(matrix) < 1e-13) == !fixture.slid);
  REQUIRE(fixture.problem->tangent(fixture.u, matrix));
  const auto totals = fixture.form->totals(fixture.problem->state_at(fixture.u));
  CHECK((totals.stick_area > 0.1) == (motion != Motion::Slip));
  CHECK((totals.slip_area > 0.05) == (motion != Motion::Stick));
  CHECK(MatMult(matrix, direction, product) == 0);
  CHECK((asymmetry(matrix) > 1e-3) == (motion != Motion::Stick));
  fixture.problem->residual(fixture.u, base);
  const double scale = norm(product);
  CHECK(scale > 1e-3);
  const auto residual_at = [&](double step, Vec result) {
    VecWAXPY(x, step, direction, fixture.u);
    fixture.problem->residual(x, result);
  };
  const double step = 1e-6;
  residual_at(step, plus);
  residual_at(-step, minus);
  VecAXPY(plus, -1.0, minus);
  VecScale(plus, 0.5 / step);
  VecAXPY(plus, -1.0, product);
  CHECK(norm(plus) <= 1e-7 * scale);
  double remainder[2];
  for (const int half : {0, 1}) {
    const double h = 4e-5 / (1 + half);
    residual_at(h, plus);
    VecAXPY(plus, -1.0, base);
    VecAXPY(plus, -h, product);
    remainder[half] = norm(plus);
  }
  const double rounding = 1e-12 * norm(base);
  CHECK(remainder[1] <= remainder[0] / 3.8 + rounding);
}

} // namespace

TEST_CASE("tangent of a frictional pair is the derivative of its residual in stick, slip and both") {
  const FrictionLaw laws[] = {Coulomb{.mu = 0.3, .cohesion = 0.5},
                              VelocityWeakening{.mu_s = 0.3, .mu_k = 0.2, .v_c = 0.5}};
  for (const int dim : {2, 3})
    for (const Enforcement& enforcement : {Enforcement(Penalty{}), Enforcement(Uzawa{}), Enforcement(Semismooth{0})})
      for (const auto& law : laws)
        for (const auto motion : {Motion::Stick, Motion::Slip, Motion::Mixed}) {
          CAPTURE(dim);
          CAPTURE(enforcement.index());
          CAPTURE(law.index());
          CAPTURE(int(motion));
          Fixture fixture({.dim = dim, .enforcement = enforcement, .law = law});
          check_tangent(fixture, motion);
        }
}

TEST_CASE("tangent of a frictional pair on segments") {
  for (const int dim : {2, 3})
    for (const Enforcement& enforcement : {Enforcement(Penalty{}), Enforcement(Uzawa{}), Enforcement(Semismooth{0})}) {
      CAPTURE(dim);
      CAPTURE(enforcement.index());
      Fixture fixture({.dim = dim, .enforcement = enforcement, .integration = SegmentIntegration{}});
      check_tangent(fixture, Motion::Mixed);
    }
}

TEST_CASE("tangent of a frictional pair whose unknown multipliers are held elsewhere, and let go again") {
  for (const int dim : {2, 3})
    for (const auto motion : {Motion::Stick, Motion::Slip, Motion::Mixed}) {
      CAPTURE(dim);
      CAPTURE(int(motion));
      Fixture fixture({.dim = dim, .enforcement = Semismooth{0}});
      fixture.hold_multipliers();
      check_tangent(fixture, motion);
      Fixture released({.dim = dim, .enforcement = Semismooth{0}});
      released.hold_multipliers();
      released.form->release_multipliers();
      check_tangent(released, motion);
    }
}

TEST_CASE("axisymmetric: tangent, and tractions by the full turn") {
  Fixture fixture({.space = Space::Axisymmetric});
  check_tangent(fixture, Motion::Mixed);
}

TEST_CASE("sliding penalty contact: shear is mu times pressure against the motion, dissipation is their work") {
  for (const int dim : {2, 3}) {
    Fixture fixture({.dim = dim});
    fixture.prepare(Motion::Slip);
    const auto state = fixture.problem->state_at(fixture.u);
    const auto samples = fixture.form->samples(state);
    REQUIRE(samples.has_friction);
    double dissipation = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const auto& shear = samples.shear[i];
      const double size = std::hypot(shear[0], shear[1], shear[2]);
      if (samples.status[i] == ContactStatus::Open) {
        CHECK(size == 0.0);
        CHECK(samples.pressure[i] == 0.0);
        continue;
      }
      CHECK(size == doctest::Approx(0.3 * samples.pressure[i]).epsilon(1e-12));
      CHECK(shear[0] < 0.0); // on the upper block, which moves to the right
      CHECK(std::abs(shear[dim - 1]) < 1e-12);
      dissipation -= (shear[0] * samples.slip[i][0] + shear[1] * samples.slip[i][1]) * samples.weight[i];
    }
    MPI_Allreduce(MPI_IN_PLACE, &dissipation, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    const auto totals = fixture.form->totals(state);
    CHECK(totals.dissipation > 0.01);
    CHECK(totals.dissipation == doctest::Approx(dissipation).epsilon(1e-12));
    CHECK(totals.tangential_force[0] == doctest::Approx(totals.force[0]).epsilon(1e-12));
  }
}

TEST_CASE("history: an accepted slip leaves its traction, a rolled back one nothing, release forgets") {
  Fixture fixture({.enforcement = Penalty{}});
  fixture.prepare(Motion::Slip);
  const auto slid = fixture.form->totals(fixture.problem->state_at(fixture.u));
  fixture.problem->roll_back();
  const auto again = fixture.form->totals(fixture.problem->state_at(fixture.u));
  CHECK(again.tangential_force[0] == slid.tangential_force[0]);
  fixture.problem->commit(fixture.u);
  const auto rest = fixture.form->totals(fixture.problem->state_at(fixture.u));
  CHECK(rest.dissipation == doctest::Approx(0.0));
  CHECK(rest.tangential_force[0] == doctest::Approx(slid.tangential_force[0]).epsilon(1e-12));

  fixture.set(fixture.u, 0.08, 0.0, -0.1, 0.0); // lift
  const auto lifted = fixture.form->totals(fixture.problem->state_at(fixture.u));
  CHECK(lifted.stick_area + lifted.slip_area < 0.7);
  fixture.set(fixture.u, 0.08, 0.0, 0.0, 0.0); // nowhere in contact
  fixture.problem->commit(fixture.u);
  fixture.set(fixture.u, 0.08, 0.0, 1.0, 0.0); // back without any tangential motion: no shear
  const auto back = fixture.form->totals(fixture.problem->state_at(fixture.u));
  CHECK(back.force[1] > 1.0);
  CHECK(std::abs(back.tangential_force[0]) < 1e-10 * back.force[1]);
}

TEST_CASE("release heals: what a law remembers is void when a point closes again") {
  constexpr double mu_s = 0.5, mu_k = 0.2;
  Fixture fixture({.law = SlipWeakening{.mu_s = mu_s, .mu_k = mu_k, .D_c = 0.01}});
  const auto check_coefficient = [&](double expected) {
    const auto samples = fixture.form->samples(fixture.problem->state_at(fixture.u));
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (samples.status[i] != ContactStatus::Open)
        CHECK(samples.tau_c[i] == doctest::Approx(expected * samples.pressure[i]).epsilon(1e-12));
    return fixture.form->totals(fixture.problem->state_at(fixture.u));
  };
  fixture.prepare(Motion::Slip); // over nearly 0.08
  CHECK(check_coefficient(mu_k).slip_area > 0.1);
  fixture.problem->commit(fixture.u);
  CHECK(check_coefficient(mu_k).area > 0.1);   // at rest it stays weak
  fixture.set(fixture.u, 0.08, 0.0, 0.0, 0.0); // nowhere in contact
  fixture.problem->commit(fixture.u);
  fixture.set(fixture.u, 0.08, 0.0, 1.0, 0.0);
  CHECK(check_coefficient(mu_s).stick_area > 0.1);
}

TEST_CASE("no time passes: rate-dependent laws slide at the rate they say") {
  const std::pair<FrictionLaw, double> cases[] = {
      {RateAndState{.mu = 0.3, .a = 0.01, .b = 0.02, .L = 1e-3, .v0 = 2.0}, 0.3}, // v = v0, in its steady state
      {VelocityWeakening{.mu_s = 0.4, .mu_k = 0.2, .v_c = 0.5}, 0.4},             // v = 0
      {WeakeningStrengthening{.mu_s = 0.4, .mu_k = 0.2, .v_c = 0.5, .kappa = 3.0}, 0.4}};
  for (const auto& [law, coefficient] : cases) {
    CAPTURE(law.index());
    Fixture fixture({.law = law});
    fixture.prepare(Motion::Slip);
    fixture.problem->begin_increment(0.5, fixture.u); // again the time of the accepted state
    const auto samples = fixture.form->samples(fixture.problem->state_at(fixture.u));
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (samples.status[i] == ContactStatus::Slip)
        CHECK(std::hypot(samples.shear[i][0], samples.shear[i][1]) ==
              doctest::Approx(coefficient * samples.pressure[i]).epsilon(1e-10));
    CHECK(fixture.form->totals(fixture.problem->state_at(fixture.u)).slip_area > 0.1);
  }
}

TEST_CASE("no coefficient, or no pressure: slip without traction, and a tangent that is finite") {
  const FrictionLaw laws[] = {Coulomb{}, RateAndState{.mu = 0.3, .a = 0.01, .b = 0.02, .L = 1e-3},
                              PrakashClifton{.mu = 0.3, .L = 1e-3},
                              SlipWeakening{.mu_s = 0.4, .mu_k = 0.2, .D_c = 0.1}};
  for (const Enforcement& enforcement : {Enforcement(Penalty{}), Enforcement(Semismooth{0})})
    for (const auto& law : laws) {
      CAPTURE(enforcement.index());
      CAPTURE(law.index());
      Fixture fixture({.enforcement = enforcement, .law = law});
      fixture.prepare(Motion::Slip);
      const bool has_pressure = law.index() == 0;
      if (!has_pressure) { // touching: gap0 - 0.05 down = 0, but for rounding; no multipliers
        fixture.set(fixture.u, 0.08, 0.0, gap0 / 0.05, 0.0);
        VecArray values(fixture.u);
        for (PetscInt i = fixture.mesh.num_owned * 2; i < values.size(); ++i)
          values[i] = 0.0;
      }
      auto matrix = fixture.problem->new_matrix();
      REQUIRE(fixture.problem->tangent(fixture.u, matrix)); // of the first guess
      fixture.problem->tangent(fixture.u, matrix);
      double size = 0.0;
      CHECK(MatNorm(matrix, NORM_FROBENIUS, &size) == 0);
      CHECK(std::isfinite(size));
      const auto totals = fixture.form->totals(fixture.problem->state_at(fixture.u));
      CHECK((totals.force[1] > 0.1) == has_pressure);
      CHECK(std::abs(totals.tangential_force[0]) < 1e-11);
      CHECK(std::abs(totals.dissipation) < 1e-11);
    }
}

TEST_CASE("a snapshot brings back all that accepted increments have changed") {
  for (const Enforcement& enforcement : {Enforcement(Penalty{}), Enforcement(Uzawa{}), Enforcement(Semismooth{0})}) {
    Fixture fixture({.enforcement = enforcement, .law = SlipWeakening{.mu_s = 0.4, .mu_k = 0.2, .D_c = 0.05}});
    fixture.prepare(Motion::Mixed);
    const auto before = fixture.problem->snapshot();
    const auto residual = fixture.layout->new_vector(), again = fixture.layout->new_vector();
    fixture.problem->revisit(1.0, fixture.u);
    VecCopy(fixture.problem->raw_residual(), residual);
    const auto samples = fixture.form->samples(fixture.problem->state_at(fixture.u));
    const auto there = fixture.layout->new_vector();
    VecCopy(fixture.u, there);

    fixture.problem->commit(fixture.u);
    if (std::holds_alternative<Uzawa>(enforcement))
      fixture.form->hold_multipliers(std::vector<double>(fixture.form->nodes().nodes.size(), -1.0));
    fixture.set(fixture.u, -0.05, 0.02, 1.1, 0.0);
    fixture.problem->begin_increment(2.0, fixture.u);
    fixture.problem->commit(fixture.u);
    fixture.problem->revisit(2.5, there);
    VecAXPY(fixture.problem->raw_residual(), -1.0, residual);
    CHECK(norm(fixture.problem->raw_residual()) > 1e-3 * norm(residual)); // the history matters

    fixture.problem->restore(before);
    CHECK(fixture.problem->time() == 0.5);
    fixture.problem->revisit(1.0, there);
    VecCopy(fixture.problem->raw_residual(), again);
    VecAXPY(again, -1.0, residual);
    CHECK(norm(again) == 0.0);
    const auto restored = fixture.form->samples(fixture.problem->state_at(there));
    CHECK(restored.accumulated_slip == samples.accumulated_slip);
    REQUIRE(restored.states.size() == 1);
    CHECK(restored.states == samples.states);
  }
}

TEST_CASE("with multipliers, increments without motion leave tractions as they are") {
  // Sticking points: nodal multipliers cannot take up all of their traction; what is left must not grow.
  Fixture fixture({.enforcement = Uzawa{}});
  fixture.set(fixture.u, 0.001, 0.002, 1.0, 1e-4);
  fixture.problem->begin_increment(1.0, fixture.u);
  const auto first = fixture.form->samples(fixture.problem->state_at(fixture.u));
  fixture.problem->commit(fixture.u);
  for (const double time : {1.1, 1.2, 1.3}) {
    fixture.problem->begin_increment(time, fixture.u);
    const auto later = fixture.form->samples(fixture.problem->state_at(fixture.u));
    double largest = 0.0, change = 0.0;
    for (std::size_t i = 0; i < later.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c) {
        largest = std::max(largest, std::abs(first.shear[i][c]));
        change = std::max(change, std::abs(later.shear[i][c] - first.shear[i][c]));
      }
    CHECK(change <= 1e-12 * largest);
    fixture.problem->commit(fixture.u);
  }
}

TEST_CASE("motion before friction begins leaves no shear behind") {
  for (const Enforcement& enforcement : {Enforcement(Penalty{}), Enforcement(Uzawa{})}) {
    const std::map<std::string, double> none;
    Fixture fixture({.enforcement = enforcement, .factor = Expression("t > 1 ? 1 : 0", none)});
    const std::size_t nodes = fixture.form->nodes().nodes.size();
    fixture.form->tangential()->hold_multipliers({2, std::vector<double>(nodes, 0.0)});
    fixture.set(fixture.u, 0.02, 0.01, 1.0, 0.0);
    fixture.problem->begin_increment(0.5, fixture.u);
    fixture.problem->commit(fixture.u);
    fixture.set(fixture.u, 0.04, 0.01, 1.0, 0.0);
    fixture.problem->begin_increment(1.0, fixture.u);
    fixture.problem->commit(fixture.u);
    fixture.problem->begin_increment(1.5, fixture.u);
    const auto still = fixture.form->totals(fixture.problem->state_at(fixture.u));
    CHECK(still.area > 0.1);
    CHECK(std::abs(still.tangential_force[0]) < 1e-12 * still.force[1]);
    fixture.set(fixture.u, 0.041, 0.01, 1.0, 0.0);
    CHECK(fixture.form->totals(fixture.problem->state_at(fixture.u)).tangential_force[0] < -1e-3 * still.force[1]);
  }
}

TEST_CASE("friction does not depend on the frame") {
  for (const int dim : {2, 3}) {
    Fixture straight({.dim = dim});
    const Eigen::Vector3d axis = dim == 2 ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(1, 2, 0.5).normalized();
    Fixture turned({.dim = dim, .turn = Eigen::AngleAxisd(0.65, axis).toRotationMatrix()});
    straight.prepare(Motion::Mixed);
    turned.prepare(Motion::Mixed);
    const auto a = straight.form->totals(straight.problem->state_at(straight.u));
    const auto b = turned.form->totals(turned.problem->state_at(turned.u));
    const Eigen::Map<const Eigen::Vector3d> fa(a.tangential_force.data()), fb(b.tangential_force.data());
    CHECK(fa.norm() > 0.1);
    CHECK((turned.scene.turn * fa - fb).norm() <= 1e-10 * fa.norm());
    CHECK(a.slip_area == doctest::Approx(b.slip_area).epsilon(1e-12));
    CHECK(a.dissipation == doctest::Approx(b.dissipation).epsilon(1e-10));
  }
}

TEST_CASE("a pair without friction builds nothing tangential") {
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, 2, 3, 4, gap0);
  const DofLayout layout(mesh, {}, {});
  ContactPair pair{.name = "interface",
                   .slave = "upper_bottom",
                   .master = std::string("lower_top"),
                   .enforcement = Penalty{},
                   .projection = {},
                   .search_distance = 0.5,
                   .space = Space::PlaneStrain,
                   .stiffness = {100.0, 300.0}};
  ContactForm form(layout, pair);
  CHECK(form.tangential() == nullptr);
  CHECK(form.tangent_is_symmetric());
}
