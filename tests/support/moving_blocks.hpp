// Two blocks in contact in finite kinematics whose places are given by formulas: for tests of forces and tangents.
#pragma once

#include "lone_pair.hpp"
#include "two_blocks.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <doctest/doctest.h>
#include <functional>
#include <memory>
#include <vector>

namespace amontons::test {

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
  MasterSmoothing smoothing = FacetedMaster{};
  int cells = 3; // of the lower block, a side; the upper one has one more
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> shape = nullptr; // of the reference configuration
};

/// A deformation: from reference to current places. `upper`: of the upper block.
using Deformation = std::function<Vector3d(const Vector3d& X, bool upper)>;

inline RawMesh shaped_blocks(const Scene& scene) {
  auto raw = two_blocks(scene.comm, scene.dim, scene.cells, scene.cells + 1, scene.gap, scene.order);
  for (std::size_t at = 0; scene.shape && at < raw.coordinates.size(); at += 3)
    Vector3d::Map(raw.coordinates.data() + at) = scene.shape(Vector3d(Vector3d::Map(raw.coordinates.data() + at)));
  return raw;
}

inline ContactPair pair_of(const Scene& scene) {
  ContactPair pair{.name = "interface",
                   .slave = "upper_bottom",
                   .master = scene.master,
                   .enforcement = scene.enforcement,
                   .projection = scene.projection,
                   .kinematics = Kinematics::Finite,
                   .space = scene.dim == 3 ? Space::Solid : scene.space,
                   .stiffness = {100.0, 300.0}};
  pair.smoothing = scene.smoothing;
  pair.alpha = 3.0;
  pair.search_distance = scene.search_distance;
  if (scene.law) pair.friction = Friction{.law = *scene.law, .factor = std::nullopt};
  return pair;
}

struct Fixture : LonePair {
  Scene scene;

  explicit Fixture(const Scene& s)
      : LonePair(distribute_mesh(s.comm, shaped_blocks(s), {{"upper_bottom", "lower_top"}}, 0), pair_of(s)), scene(s) {
    hold_multipliers(Matrix3d::Identity());
  }

  /// Tractions as large as those of the penalty; shear in the frame of `turn`.
  void hold_multipliers(const Matrix3d& turn) {
    if (std::holds_alternative<Uzawa>(scene.enforcement)) hold_any_multipliers(turn);
  }
  /// The same where they are unknowns.
  void hold_any_multipliers(const Matrix3d& turn) {
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
inline Deformation rough(int dim, double push, double down, double roughness, int seed) {
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

inline double norm(Vec vec) {
  double value = 0.0;
  VecNorm(vec, NORM_2, &value);
  return value;
}

inline bool on_all_ranks(bool mine) {
  int all = mine ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_INT, MPI_MIN, PETSC_COMM_WORLD);
  return all != 0;
}

/// Within ±step along the direction no point changes its status or its facet.
inline bool is_smooth(const Fixture& fixture, Vec direction, double step) {
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

inline double smooth_range(const Fixture& fixture, Vec direction) {
  double widest = 1e-2;
  while (widest > least_range && !is_smooth(fixture, direction, widest))
    widest *= 0.3;
  return widest;
}

/// The Taylor remainder |R(u + h d) − R(u) − h K d| over three decades of h, that is six of its own, and central
/// differences.
inline void check_tangent(Fixture& fixture) {
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

inline const Enforcement all_enforcements[] = {Enforcement(Penalty{}), Enforcement(Uzawa{}),
                                               Enforcement(Semismooth{0})};

enum class Motion { Stick, Slip, Mixed };

inline Matrix3d turn_of(int dim) {
  const Vector3d axis = dim == 2 ? Vector3d(0, 0, 1) : Vector3d(1, 2, 0.5).normalized();
  return Eigen::AngleAxisd(0.65, axis).toRotationMatrix();
}

inline Deformation turned(const Deformation& deformation, const Matrix3d& turn) {
  return [=](const Vector3d& X, bool upper) { return Vector3d(turn * deformation(X, upper) + turn.col(0)); };
}

/// An accepted rough state, then one of the wanted kind under test, all of it turned by `turn` in the increment.
inline void prepare(Fixture& fixture, Motion motion, const Matrix3d& turn, int seed = 5) {
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

/// Forces on nodes turn with a rigid motion of everything in the increment; they and their moments add up to nothing
/// but for these parts of the sum of their sizes.
inline void check_rigid_motion(const Scene& scene, Motion motion, double force_tolerance, double moment_tolerance) {
  const int dim = scene.dim;
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
      Vector3d::Map(sums) += other;
      Vector3d::Map(sums + 3) += x.cross(other);
      sums[6] += other.norm();
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 7, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  CHECK(sums[6] > 0.1);
  CHECK(worst <= 1e-11 * sums[6]);
  for (int c = 0; c < 6; ++c)
    CHECK(std::abs(sums[c]) <= (c < 3 ? force_tolerance : moment_tolerance) * sums[6]);
}

/// The first of some random states that is not next to a change of status or facet.
inline std::unique_ptr<Fixture> prepared(const Scene& scene, Motion motion, const Matrix3d& turn) {
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

/// Force on the slave, shear force and dissipation of one increment.
struct Record {
  std::array<double, 3> force{}, shear{};
  double area = 0.0, dissipation = 0.0;
};

/// Takes the upper block along a path, in increments, and writes down what it feels.
inline std::vector<Record> ride(Fixture& fixture, const std::vector<Deformation>& path) {
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

} // namespace amontons::test
