// The change of variables of `vi` against what defines it: forces and gaps seen through T, rigid motions, refusals.
#include "base/error.hpp"
#include "contact/mortar_transform.hpp"
#include "mesh/build.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;

namespace {

struct Case {
  int dim = 2;
  int order = 1;
  bool simplices = false;
  double angle = 0.4;              // of the whole scene
  double shift = 0.0;              // of the upper block along the interface: part of it has no master
  bool floor = false;              // a second pair: lower_top, the master of the first, over a rigid plane
  std::string held = "upper_left"; // group whose displacement in direction held_component is prescribed
  int held_component = 0;
  std::vector<TiedGroup> tied = {};
};

/// Two blocks that touch, with meshes that do not match, a `vi` pair between them and no other forms.
struct Fixture {
  Mesh mesh;
  std::unique_ptr<DofLayout> layout;
  std::unique_ptr<Problem> problem;
  std::vector<MortarForm*> forms;
  std::unique_ptr<MortarTransform> transform;

  explicit Fixture(const Case& c, std::vector<ContactPair> more = {}) {
    RawMesh raw;
    on_root(PETSC_COMM_WORLD, [&] {
      const std::string scene = c.dim == 2 ? "patch_2d" : "patch_3d", shape = c.dim == 2 ? "quads" : "hexes";
      raw = read_mesh({AMONTONS_SOURCE_DIR "/inputs/" + scene + "/" + scene + ".geo",
                       {{"n_lower", 2}, {"n_upper", 3}, {shape, c.simplices ? 0.0 : 1.0}},
                       c.order});
      const Eigen::Vector3d axis = c.dim == 2 ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(1, 2, 0.5).normalized();
      const Eigen::Matrix3d turn = Eigen::AngleAxisd(c.angle, axis).toRotationMatrix();
      std::vector<std::uint8_t> is_upper(raw.coordinates.size() / 3, 0);
      for (std::int64_t cell = 0; cell < raw.num_cells(); ++cell)
        for (auto a = raw.cell_offsets[cell]; a < raw.cell_offsets[cell + 1]; ++a)
          is_upper[raw.cell_nodes[a]] = raw.groups[raw.cell_bodies[cell]].name == "upper";
      for (std::size_t i = 0; i < is_upper.size(); ++i) {
        Eigen::Map<Eigen::Vector3d> x(&raw.coordinates[3 * i]);
        if (is_upper[i]) x[0] += c.shift;
        x = (turn * x).eval();
      }
    });
    mesh = distribute_mesh(PETSC_COMM_WORLD, raw, {{"upper_bottom", "lower_top"}}, 0);
    layout = std::make_unique<DofLayout>(mesh, c.tied, std::vector<NodeField>{});
    std::vector<ContactPair> pairs = {declare("interface", "upper_bottom", std::string("lower_top"))};
    if (c.floor) pairs.push_back(declare("floor", "lower_top", RigidMaster{RigidPlane{{0, 2, 2}, {0.6, -0.8, 0}}, {}}));
    pairs.insert(pairs.end(), more.begin(), more.end());
    std::vector<std::unique_ptr<Form>> all;
    for (auto& pair : pairs) {
      auto form = std::make_unique<MortarForm>(*layout, std::move(pair));
      forms.push_back(form.get());
      all.push_back(std::move(form));
    }
    std::vector<PrescribedDisplacement> prescribed;
    if (!c.held.empty()) prescribed.push_back({c.held, c.held_component, Expression(0.1)});
    problem = std::make_unique<Problem>(*layout, std::move(all), prescribed);
    transform = std::make_unique<MortarTransform>(*problem, forms);
  }

  ContactPair declare(const std::string& name, const std::string& slave,
                      const std::variant<std::string, RigidMaster>& master) const {
    return {.name = name,
            .slave = slave,
            .master = master,
            .enforcement = BoundConstraint{},
            .projection = {},
            .integration = FacetIntegration{7},
            .search_distance = 0.2,
            .space = mesh.dim == 2 ? Space::PlaneStrain : Space::Solid,
            .stiffness = std::vector<double>(mesh.bodies.size(), 1.0)};
  }

  /// Numbers between -1 and 1 that depend on place and component only.
  VecHandle wiggle(double seed) const {
    auto vec = layout->new_vector();
    VecArray values(vec);
    for (std::int32_t node = 0; node < mesh.num_owned; ++node)
      for (int c = 0; c < mesh.dim; ++c) {
        const auto x = mesh.position(node);
        values[node * mesh.dim + c] = std::sin(seed + 7.0 * x[0] + 11.0 * x[1] + 3.0 * x[mesh.dim - 1] + 5.0 * c);
      }
    return vec;
  }
  /// Random forces >= 0 on the bounds, and how many bounds there are.
  VecHandle bound_forces(double& count) const {
    auto forces = wiggle(2.0);
    count = 0.0;
    VecArray values(forces);
    VecReader lower(transform->lower());
    for (PetscInt i = 0; i < values.size(); ++i) {
      values[i] = lower[i] > PETSC_NINFINITY ? 2.0 + values[i] : 0.0;
      count += values[i] > 0.0;
    }
    MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    return forces;
  }
};

double norm(Vec vec) {
  double value = 0.0;
  VecNorm(vec, NORM_INFINITY, &value);
  return value;
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const int dim : {2, 3})
    for (const int order : {1, 2})
      for (const bool simplices : {false, true})
        cases.push_back({.dim = dim, .order = order, .simplices = simplices});
  cases.push_back({.dim = 2, .shift = 0.13});
  cases.push_back({.dim = 3, .order = 2, .shift = 0.13});
  // The end of the slave surface is held along its normal: its nodes there are left out.
  for (const int order : {1, 2}) {
    cases.push_back({.dim = 2, .order = order, .angle = 0.0, .held_component = 1});
    cases.push_back({.dim = 3, .order = order, .simplices = order == 2, .angle = 0.0, .held_component = 2});
  }
  cases.push_back({.dim = 2, .floor = true});
  cases.push_back({.dim = 3, .order = 2, .floor = true});
  return cases;
}

} // namespace

TEST_CASE("T and its inverse are inverse; forces and gaps of the form are those of the bounds") {
  for (const auto& c : all_cases()) {
    CAPTURE(c.dim);
    CAPTURE(c.order);
    CAPTURE(c.simplices);
    CAPTURE(c.shift);
    CAPTURE(c.floor);
    Fixture fixture(c);
    const auto u = fixture.wiggle(0.3), changed = fixture.layout->new_vector(), back = fixture.layout->new_vector();
    MatMult(fixture.transform->inverse(), u, changed);
    MatMult(fixture.transform->transform(), changed, back);
    VecAXPY(back, -1.0, u);
    CHECK(norm(back) < 1e-12);

    // The residual of forces f on the bounds does their work: Tᵀ r = −f.
    double count = 0.0;
    const auto forces = fixture.bound_forces(count);
    CHECK(count > 2.0);
    fixture.transform->hold_forces(forces);
    const auto residual = fixture.layout->new_vector();
    fixture.problem->residual(u, residual);
    CHECK(norm(residual) > 0.1);
    MatMultTranspose(fixture.transform->transform(), fixture.problem->raw_residual(), back);
    VecAXPY(back, 1.0, forces);
    CHECK(norm(back) < 1e-11);

    // The work of the tractions on the displacement is −f · û.
    double work = 0.0, expected = 0.0;
    VecDot(forces, changed, &expected);
    for (auto* form : fixture.forms)
      work += form->work_of_displacement(fixture.problem->state_at(u));
    CHECK(std::abs(expected) > 1e-3);
    CHECK(work == doctest::Approx(-expected).epsilon(1e-10));

    fixture.transform->release();
    fixture.problem->residual(u, residual);
    CHECK(norm(fixture.problem->raw_residual()) == 0.0);
  }
}

TEST_CASE("rigid motions of everything leave the bounded unknowns at zero") {
  for (auto c : all_cases()) {
    if (c.floor) continue; // the plane does not move along
    c.held.clear();
    CAPTURE(c.dim);
    CAPTURE(c.order);
    CAPTURE(c.simplices);
    CAPTURE(c.shift);
    Fixture fixture(c);
    const auto u = fixture.layout->new_vector(), changed = fixture.layout->new_vector();
    {
      VecArray values(u);
      for (std::int32_t node = 0; node < fixture.mesh.num_owned; ++node) {
        const auto x = fixture.mesh.position(node);
        values[node * c.dim] = 0.3 - 0.5 * x[1];
        values[node * c.dim + 1] = -0.7 + 0.5 * x[0];
        if (c.dim == 3) values[node * c.dim + 2] = 0.2;
      }
    }
    MatMult(fixture.transform->inverse(), u, changed);
    double largest = 0.0;
    {
      VecReader values(changed), lower(fixture.transform->lower());
      for (PetscInt i = 0; i < values.size(); ++i)
        if (lower[i] > PETSC_NINFINITY) {
          largest = std::max(largest, std::abs(values[i]));
          CHECK(std::abs(lower[i]) < 1e-12); // the blocks touch
        }
    }
    CHECK(largest < 1e-12);
  }
}

TEST_CASE("a uniform pressure stays one where nodes are left out") {
  for (const int dim : {2, 3})
    for (const int order : {1, 2}) {
      CAPTURE(dim);
      CAPTURE(order);
      std::vector<VecHandle> forces;
      double left_out = 0.0;
      for (const auto* held : {"", "upper_left"}) {
        Fixture fixture({.dim = dim, .order = order, .angle = 0.0, .held = held, .held_component = dim - 1});
        auto& form = *fixture.forms[0];
        form.hold_multipliers(std::vector<double>(form.nodes().nodes.size(), -1.0));
        const auto u = fixture.layout->new_vector(), residual = fixture.layout->new_vector();
        fixture.problem->residual(u, residual);
        auto& all = forces.emplace_back(fixture.layout->new_vector());
        VecCopy(fixture.problem->raw_residual(), all);
        left_out = 0.0;
        for (const auto& constraint : form.constraints())
          left_out += constraint.weight == 0.0;
      }
      MPI_Allreduce(MPI_IN_PLACE, &left_out, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
      CHECK(left_out >= (dim == 2 ? 1 : 4));
      CHECK(norm(forces[0]) > 0.05);
      VecAXPY(forces[1], -1.0, forces[0]);
      CHECK(norm(forces[1]) < 1e-13);
    }
}

TEST_CASE("a moving rigid master moves the bounds") {
  Fixture fixture({.dim = 2, .angle = 0.0, .held = ""});
  auto pair = fixture.declare("lid", "lower_top",
                              RigidMaster{RigidPlane{{0.0, 2.0, 0.0}, {0.0, -1.0, 0.0}},
                                          {std::nullopt, Expression("-0.25*t", {}), std::nullopt}});
  MortarForm form(*fixture.layout, pair);
  MortarTransform transform(*fixture.problem, {&form});
  double before = 0.0, after = 0.0;
  VecMax(transform.lower(), nullptr, &before);
  CHECK_FALSE(transform.update(0.0));
  CHECK(transform.update(1.0));
  VecMax(transform.lower(), nullptr, &after);
  CHECK(after - before == doctest::Approx(0.25));
}

TEST_CASE("scenes that bounds cannot express are refused with place and remedy") {
  const auto message = [](const Case& c, std::vector<ContactPair> more = {}) -> std::string {
    try {
      Fixture fixture(c, std::move(more));
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  };
  Fixture plain({.angle = 0.0});
  // Slave and master exchanged in a second pair: a ring.
  const auto ring = message({}, {plain.declare("back", "lower_top", std::string("upper_bottom"))});
  CHECK(ring.find("ring") != std::string::npos);
  CHECK(ring.find("semismooth") != std::string::npos);
  // A second pair for the same slave nodes.
  const auto shared = message({.angle = 0.0}, {plain.declare("again", "upper_bottom", std::string("lower_top"))});
  CHECK(shared.find("share the slave node at (") != std::string::npos);
  // The slave surface moves as one along its normal.
  const auto tied = message({.angle = 0.0, .held = "", .tied = {{"upper_bottom", 1}}});
  CHECK(tied.find("all nodes of its slave facet at (") != std::string::npos);
  CHECK(tied.find("Exchange slave and master") != std::string::npos);
  // All of it is moved along its normal.
  const auto driven = message({.angle = 0.0, .held = "upper_bottom", .held_component = 1});
  CHECK(driven.find("have prescribed displacements or resultants along the contact normal") != std::string::npos);
  // Some of it is: those nodes have no bound, the others do.
  CHECK(message({.angle = 0.0, .held_component = 1}).empty());
}
