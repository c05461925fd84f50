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
                     .kinematics = FiniteKinematics{},
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
  double widest = 1e-2;
  while (widest > 2e-5 && !is_smooth(fixture, direction, widest))
    widest *= 0.3;
  REQUIRE(widest > 2e-5);
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
