// Contact in the current configuration: the tangent of the whole contact residual, frame indifference, balance, sliding
// over facets, ranks and ends, slip on curved surfaces against closed forms.
#include "contact/contact_form.hpp"
#include "form/problem.hpp"
#include "two_blocks.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <doctest/doctest.h>
#include <functional>

using namespace amontons;
using namespace amontons::test;

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Scene {
  int dim = 2, order = 1;
  Enforcement enforcement = Penalty{};
  ProjectionKind projection = ClosestPoint{};
  std::optional<FrictionLaw> law = std::nullopt;
  Space space = Space::PlaneStrain;
  double gap = 0.01;
  MPI_Comm comm = PETSC_COMM_WORLD;
  std::variant<std::string, RigidMaster> master = std::string("lower_top");
  double search_distance = 0.3;
};

/// A deformation: from reference to current places. `upper`: of the upper block.
using Deformation = std::function<Vector3d(const Vector3d& X, bool upper)>;

/// In [-1, 1], from the place alone: the same on any number of ranks.
double noise(const Vector3d& X, int component, int seed) {
  const double s = std::sin(12.9898 * X[0] + 78.233 * X[1] + 37.719 * X[2] + 4.1 * component + 1.7 * seed) * 43758.5453;
  return 2.0 * (s - std::floor(s)) - 1.0;
}

struct Fixture {
  Scene scene;
  Mesh mesh;
  std::vector<NodeField> fields;
  std::unique_ptr<DofLayout> layout;
  std::unique_ptr<Problem> problem;
  ContactForm* form = nullptr;
  VecHandle u;

  explicit Fixture(const Scene& s)
      : scene(s), mesh(distribute_mesh(s.comm, two_blocks(s.comm, s.dim, 3, 4, s.gap, s.order),
                                       {{"upper_bottom", "lower_top"}}, 0)) {
    const bool unknown = std::holds_alternative<Semismooth>(scene.enforcement);
    if (unknown) fields.assign(scene.law ? 1 + scene.dim : 1, multiplier_nodes(mesh, "interface", "upper_bottom"));
    layout = std::make_unique<DofLayout>(mesh, std::vector<TiedGroup>{}, fields);
    ContactPair pair{.name = "interface",
                     .slave = "upper_bottom",
                     .master = scene.master,
                     .enforcement = scene.enforcement,
                     .projection = scene.projection,
                     .kinematics = Kinematics::Finite,
                     .space = scene.dim == 3 ? Space::Solid : scene.space,
                     .stiffness = {100.0, 300.0}};
    pair.alpha = 3.0;
    pair.search_distance = scene.search_distance;
    if (scene.law) pair.friction = Friction{.law = *scene.law, .factor = std::nullopt, .field = unknown ? 1 : -1};
    auto contact = std::make_unique<ContactForm>(*layout, std::move(pair));
    form = contact.get();
    std::vector<std::unique_ptr<Form>> forms;
    forms.push_back(std::move(contact));
    problem = std::make_unique<Problem>(*layout, std::move(forms), std::vector<PrescribedDisplacement>{});
    u = layout->new_vector();
    hold_multipliers(Matrix3d::Identity());
  }

  /// Tractions as large as those of the penalty; shear in the frame of `turn`.
  void hold_multipliers(const Matrix3d& turn) {
    if (!std::holds_alternative<Uzawa>(scene.enforcement)) return;
    std::vector<double> normal;
    std::vector<std::vector<double>> shear(scene.dim);
    for (const auto node : form->nodes().nodes) {
      normal.push_back(-15.0 - 5.0 * mesh.position(node)[0]);
      const Vector3d t = turn * Vector3d(0.5, -0.2, scene.dim == 3 ? 0.1 : 0.0);
      for (int c = 0; c < scene.dim; ++c)
        shear[c].push_back(t[c]);
    }
    form->hold_multipliers(normal);
    if (scene.law) form->tangential()->hold_multipliers(shear);
  }

  Vector3d reference(std::int32_t node) const {
    Vector3d X = Vector3d::Zero();
    for (int c = 0; c < mesh.dim; ++c)
      X[c] = mesh.position(node)[c];
    return X;
  }
  bool is_upper(const Vector3d& X) const { return X[mesh.dim - 1] > 1.0 + 0.5 * scene.gap; }

  /// Displacements by formula, and unknown multipliers: shear turned by `turn`.
  void set(Vec vec, const Deformation& deformation, const Matrix3d& turn = Matrix3d::Identity()) const {
    VecArray values(vec);
    const int d = mesh.dim;
    for (std::int32_t node = 0; node < mesh.num_owned; ++node) {
      const auto X = reference(node);
      const Vector3d moved = deformation(X, is_upper(X)) - X;
      for (int c = 0; c < d; ++c)
        values[node * d + c] = moved[c];
    }
    for (const auto node : fields.empty() ? std::vector<std::int32_t>{} : fields[0].nodes) {
      const auto X = reference(node);
      const Vector3d shear = turn * Vector3d(0.002 * noise(X, 1, 3), 0.001 * noise(X, 2, 3), 0.0);
      for (std::size_t field = 0; field < fields.size(); ++field) {
        const PetscInt at = layout->extra_equation(static_cast<int>(field), node) - layout->first_equation();
        if (at < 0 || at >= layout->num_owned()) continue;
        values[at] = field == 0 ? -0.012 + 0.004 * noise(X, 0, 3) : shear[static_cast<Eigen::Index>(field) - 1];
      }
    }
  }

  /// A generic direction, multipliers included.
  void set_direction(Vec vec) const {
    VecArray values(vec);
    for (PetscInt i = 0; i < values.size(); ++i)
      values[i] = 0.0;
    const int d = mesh.dim;
    for (std::int32_t node = 0; node < mesh.num_owned; ++node)
      for (int c = 0; c < d; ++c)
        values[node * d + c] = noise(reference(node), c, 17);
    for (std::size_t field = 0; field < fields.size(); ++field)
      for (const auto node : fields[field].nodes) {
        const PetscInt at = layout->extra_equation(static_cast<int>(field), node) - layout->first_equation();
        if (at >= 0 && at < layout->num_owned()) values[at] = 0.3 * noise(reference(node), static_cast<int>(field), 23);
      }
  }

  void accept(double time) {
    problem->begin_increment(time, u);
    const auto residual = layout->new_vector();
    problem->residual(u, residual);
    problem->commit(u);
  }

  /// Status, facet and hold of every point in contact, and who has a master.
  std::vector<int> signature(Vec x) const {
    const auto samples = form->samples(problem->state_at(x));
    std::vector<int> all;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const auto& point = form->points().points()[i];
      const bool open = samples.status[i] == ContactStatus::Open;
      all.push_back(int(samples.status[i]));
      all.push_back(open ? (point.master >= 0) : point.master);
      all.push_back(open ? 0 : static_cast<int>(form->points().now(i).hold.index()));
    }
    return all;
  }
};

/// Upper block pushed down and along, everything rough; bumpy enough that points meet facets, edges and corners.
Deformation rough(int dim, double push, double down, double roughness, int seed) {
  return [=](const Vector3d& X, bool upper) {
    Vector3d x = X;
    for (int c = 0; c < dim; ++c)
      x[c] += roughness * noise(X, c, seed);
    if (upper) {
      x[0] += push * (1.0 + 0.2 * X[0]);
      if (dim == 3) x[1] += 0.4 * push;
      x[dim - 1] -= down;
    }
    return x;
  };
}

double norm(Vec vec) {
  double value = 0.0;
  VecNorm(vec, NORM_2, &value);
  return value;
}

bool on_all_ranks(bool mine) {
  int all = mine ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_INT, MPI_MIN, PETSC_COMM_WORLD);
  return all != 0;
}

/// Within ±step along the direction no point changes its status or its facet.
bool is_smooth(const Fixture& fixture, Vec direction, double step) {
  const auto x = fixture.layout->new_vector();
  const auto here = fixture.signature(fixture.u);
  bool same = true;
  for (const double h : {-1.0, -0.3, 0.3, 1.0}) {
    VecWAXPY(x, h * step, direction, fixture.u);
    same = fixture.signature(x) == here && same;
  }
  return on_all_ranks(same);
}

/// Taylor tests want this much around the state without a change.
constexpr double least_range = 2e-5;

double smooth_range(const Fixture& fixture, Vec direction) {
  double widest = 1e-2;
  while (widest > least_range && !is_smooth(fixture, direction, widest))
    widest *= 0.3;
  return widest;
}

/// The Taylor remainder |R(u + h d) − R(u) − h K d| over three decades of h, that is six of its own, and central
/// differences.
void check_tangent(Fixture& fixture) {
  const auto direction = fixture.layout->new_vector(), x = fixture.layout->new_vector(),
             base = fixture.layout->new_vector(), plus = fixture.layout->new_vector(),
             minus = fixture.layout->new_vector(), product = fixture.layout->new_vector();
  fixture.set_direction(direction);
  auto matrix = fixture.problem->new_matrix();
  fixture.problem->tangent(fixture.u, matrix); // of the first guess
  REQUIRE(fixture.problem->tangent(fixture.u, matrix));
  CHECK(MatMult(matrix, direction, product) == 0);
  fixture.problem->residual(fixture.u, base);
  const double scale = norm(product);
  CHECK(scale > 1e-2); // not trivially zero
  CHECK(norm(base) > 1e-3);
  const double widest = smooth_range(fixture, direction);
  REQUIRE(widest > least_range);
  const auto residual_at = [&](double step, Vec result) {
    VecWAXPY(x, step, direction, fixture.u);
    fixture.problem->residual(x, result);
  };
  const double rounding = 2e-13 * norm(base);
  double last = 0.0, first = 0.0;
  for (int k = 0; k < 7; ++k) {
    const double h = widest * std::pow(10.0, -0.5 * k);
    residual_at(h, plus);
    VecAXPY(plus, -1.0, base);
    VecAXPY(plus, -h, product);
    const double remainder = norm(plus);
    CAPTURE(h);
    if (k > 0) CHECK(remainder <= 0.115 * last + rounding); // 0.1 is order 2
    if (k == 0) first = remainder;
    last = remainder;
  }
  CHECK(first > 100.0 * rounding); // kinematics is not linear
  const double step = std::min(1e-5, 0.3 * widest);
  residual_at(step, plus);
  residual_at(-step, minus);
  VecAXPY(plus, -1.0, minus);
  VecScale(plus, 0.5 / step);
  VecAXPY(plus, -1.0, product);
  CHECK(norm(plus) <= 1e-6 * scale);
}

const Enforcement all_enforcements[] = {Enforcement(Penalty{}), Enforcement(Uzawa{}), Enforcement(Semismooth{0})};

} // namespace

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

namespace {

enum class Motion { Stick, Slip, Mixed };

Matrix3d turn_of(int dim) {
  const Vector3d axis = dim == 2 ? Vector3d(0, 0, 1) : Vector3d(1, 2, 0.5).normalized();
  return Eigen::AngleAxisd(0.65, axis).toRotationMatrix();
}

Deformation turned(const Deformation& deformation, const Matrix3d& turn) {
  return [=](const Vector3d& X, bool upper) { return Vector3d(turn * deformation(X, upper) + turn.col(0)); };
}

/// An accepted rough state, then one of the wanted kind under test, all of it turned by `turn` in the increment.
void prepare(Fixture& fixture, Motion motion, const Matrix3d& turn, int seed = 5) {
  const int dim = fixture.mesh.dim;
  fixture.set(fixture.u, rough(dim, 0.03, 0.03, 0.01, seed));
  fixture.accept(0.5);
  fixture.hold_multipliers(turn);
  // What slid on the way down sticks when it moves back.
  const double push = motion == Motion::Stick ? 0.0292 : motion == Motion::Slip ? 0.12 : 0.03;
  const double waves = motion == Motion::Stick ? 1e-4 : motion == Motion::Slip ? 0.0 : 5e-3;
  const auto base = rough(dim, push, 0.031, 0.01, seed);
  const auto moved = [=](const Vector3d& X, bool upper) {
    const double x = X[0] + 0.3 * X[1];
    return Vector3d(base(X, upper) + waves * Vector3d(std::sin(9.0 * x + upper), 0.1 * std::cos(3.0 * x), 0.0));
  };
  fixture.set(fixture.u, turned(moved, turn), turn);
  fixture.problem->begin_increment(1.0, fixture.u);
}

/// The first of some random states that is not next to a change of status or facet.
std::unique_ptr<Fixture> prepared(const Scene& scene, Motion motion, const Matrix3d& turn) {
  for (int seed = 1; seed <= 12; ++seed) {
    auto fixture = std::make_unique<Fixture>(scene);
    prepare(*fixture, motion, turn, seed);
    const auto direction = fixture->layout->new_vector();
    fixture->set_direction(direction);
    if (smooth_range(*fixture, direction) > least_range) return fixture;
  }
  FAIL("no state without a change nearby");
  return nullptr;
}

} // namespace

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

TEST_CASE("finite kinematics: tangent with the slave's normal, around an axis, and over rigid shapes") {
  const FrictionLaw law = Coulomb{.mu = 0.3, .cohesion = 0.5};
  for (const int dim : {2, 3})
    for (const auto motion : {Motion::Slip, Motion::Mixed}) {
      const auto fixture = prepared({.dim = dim, .projection = SlaveNormal{}, .law = law}, motion, turn_of(dim));
      check_tangent(*fixture);
    }
  check_tangent(*prepared({.enforcement = Semismooth{0}, .law = law, .space = Space::Axisymmetric}, Motion::Mixed,
                          Matrix3d::Identity()));
  const RigidShape shapes[] = {RigidPlane{{0.0, 1.0, 1.0}, {0.0, 0.0, 1.0}}, RigidSphere{{0.5, 0.5, -0.3}, 1.3},
                               RigidCylinder{{0.5, 0.5, 0.2}, {1.0, 0.0, 0.0}, 0.8},
                               rounded_corner({0.5, 0.5, 1.1}, {{{0.0, -0.6, 0.8}, {0.0, 0.8, 0.6}}}, 0.4)};
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

TEST_CASE("finite kinematics: points at edges and corners of the master enter the tangent") {
  // Pressed by held multipliers over a gap above ridges, so that points hang over edges and corners.
  int edges = 0, corners = 0;
  for (const int dim : {2, 3})
    for (int seed = 1; seed <= 4; ++seed) {
      CAPTURE(dim);
      CAPTURE(seed);
      Fixture fixture({.dim = dim, .enforcement = Uzawa{}, .law = Coulomb{.mu = 0.3}});
      const auto ridges = [=](const Vector3d& X, bool upper) {
        Vector3d x = X;
        if (!upper && X[dim - 1] > 0.9)
          x[dim - 1] -=
              0.9 * (std::pow(X[0] - 0.5, 2) + (dim == 3 ? std::pow(X[1] - 0.5, 2) : 0.0)) + 0.01 * noise(X, 1, seed);
        if (upper) x += Vector3d(0.02 * seed, 0.0, 0.0) + 0.05 * Vector3d::Unit(dim - 1);
        return x;
      };
      fixture.set(fixture.u, ridges);
      fixture.hold_multipliers(Matrix3d::Identity());
      auto multipliers = fixture.form->multipliers();
      for (double& value : multipliers)
        value -= 400.0;
      fixture.form->hold_multipliers(multipliers);
      fixture.accept(0.5);
      fixture.set(fixture.u, [=](const Vector3d& X, bool upper) {
        return Vector3d(ridges(X, upper) + (upper ? 0.01 : 0.0) * Vector3d(1.0, dim == 3 ? 0.5 : 0.0, 0.0));
      });
      fixture.problem->begin_increment(1.0, fixture.u);
      check_tangent(fixture);
      const auto samples = fixture.form->samples(fixture.problem->state_at(fixture.u));
      for (std::size_t i = 0; i < samples.size(); ++i) {
        if (samples.status[i] == ContactStatus::Open) continue;
        edges += std::holds_alternative<OnEdge>(fixture.form->points().now(i).hold);
        corners += std::holds_alternative<OnCorner>(fixture.form->points().now(i).hold);
      }
    }
  MPI_Allreduce(MPI_IN_PLACE, &edges, 1, MPI_INT, MPI_SUM, PETSC_COMM_WORLD);
  MPI_Allreduce(MPI_IN_PLACE, &corners, 1, MPI_INT, MPI_SUM, PETSC_COMM_WORLD);
  CHECK(edges >= 10);
  CHECK(corners >= 10);
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
            const Scene scene{.dim = dim,
                              .order = order,
                              .enforcement = enforcement,
                              .projection = projection,
                              .law = Coulomb{.mu = 0.3}};
            const auto turn = turn_of(dim);
            Fixture straight(scene), rotated(scene);
            prepare(straight, motion, Matrix3d::Identity());
            prepare(rotated, motion, turn);
            const auto a = straight.layout->new_vector(), b = rotated.layout->new_vector();
            straight.problem->residual(straight.u, a);
            rotated.problem->residual(rotated.u, b);
            double worst = 0.0, sums[7] = {}; // force, moment, absolute
            {
              VecReader fa(a), fb(b), u(rotated.u);
              for (std::int32_t node = 0; node < straight.mesh.num_owned; ++node) {
                Vector3d one = Vector3d::Zero(), other = Vector3d::Zero(), x = rotated.reference(node);
                for (int c = 0; c < dim; ++c) {
                  one[c] = fa[node * dim + c];
                  other[c] = fb[node * dim + c];
                  x[c] += u[node * dim + c];
                }
                worst = std::max(worst, (turn * one - other).norm());
                const Vector3d moment = x.cross(other);
                for (int c = 0; c < 3; ++c) {
                  sums[c] += other[c];
                  sums[3 + c] += moment[c];
                }
                sums[6] += other.norm();
              }
            }
            MPI_Allreduce(MPI_IN_PLACE, sums, 7, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
            CHECK(sums[6] > 0.1);
            CHECK(worst <= 1e-11 * sums[6]);
            // Moments of shear over a gap balance but at edges and corners, where next to no gap carries shear.
            for (int c = 0; c < 6; ++c)
              CHECK(std::abs(sums[c]) <= (c < 3 ? 1e-12 : 1e-10) * sums[6]);
          }
}

namespace {

/// Force on the slave, shear force and dissipation of one increment.
struct Record {
  std::array<double, 3> force{}, shear{};
  double area = 0.0, dissipation = 0.0;
};

/// Takes the upper block along a path, in increments, and writes down what it feels.
std::vector<Record> ride(Fixture& fixture, const std::vector<Deformation>& path) {
  std::vector<Record> records;
  double time = 0.0;
  auto matrix = fixture.problem->new_matrix();
  for (const auto& deformation : path) {
    fixture.set(fixture.u, deformation);
    time += 1.0;
    fixture.problem->begin_increment(time, fixture.u);
    fixture.problem->tangent(fixture.u, matrix); // the pattern follows, or PETSc complains
    fixture.problem->tangent(fixture.u, matrix);
    const auto residual = fixture.layout->new_vector();
    fixture.problem->residual(fixture.u, residual);
    const auto totals = fixture.form->totals(fixture.problem->state_at(fixture.u));
    records.push_back({totals.force, totals.tangential_force, totals.area, totals.dissipation});
    fixture.problem->commit(fixture.u);
  }
  return records;
}

} // namespace

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
