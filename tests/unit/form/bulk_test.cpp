// Internal forces and stiffness of every element in every space: patch test, consistency with the energy, rigid
// motions, absence of spurious modes, stress recovery.
#include "base/error.hpp"
#include "dense_system.hpp"
#include "form/bulk.hpp"
#include "material/elastic.hpp"

#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::testing;

namespace {

constexpr Elastic soft{7.0, 0.3};

struct Case {
  ElementType type;
  Space space;
};

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const ElementType type :
       {ElementType::Triangle3, ElementType::Triangle6, ElementType::Quadrilateral4, ElementType::Quadrilateral9})
    for (const Space space : {Space::PlaneStrain, Space::PlaneStress, Space::Axisymmetric})
      cases.push_back({type, space});
  for (const ElementType type :
       {ElementType::Tetrahedron4, ElementType::Tetrahedron10, ElementType::Hexahedron8, ElementType::Hexahedron27})
    cases.push_back({type, Space::Solid});
  return cases;
}

/// A skewed and smoothly bent box at x > 0.
std::array<double, 3> bent(std::array<double, 3> p) {
  const auto [x, y, z] = p;
  return {1 + x + 0.2 * y + 0.1 * std::sin(2 * x + 3 * y + z), y - 0.15 * x + 0.1 * std::sin(3 * x - y + 2 * z),
          z + 0.1 * x * y - 0.08 * std::sin(2 * y + x)};
}

/// Curved sides where the quadrature integrates the gradients exactly on them (all but the ten-node tetrahedron).
Mesh small_mesh(ElementType type, MPI_Comm comm = PETSC_COMM_SELF, std::array<int, 3> counts = {3, 2, 2}) {
  Mesh mesh = box_mesh(comm, type, counts, bent);
  if (type == ElementType::Tetrahedron10) straighten(mesh);
  return mesh;
}

/// A displacement with constant stress that is in equilibrium without body force.
std::array<double, 3> linear_field(Space space, std::span<const double> x) {
  if (space == Space::Axisymmetric) return {0.3 * x[0], -0.2 * x[1] + 0.1, 0};
  const double z = space == Space::Solid ? x[2] : 0;
  return {0.1 + 0.3 * x[0] - 0.2 * x[1] + 0.15 * z, 0.4 * x[0] + 0.25 * x[1] - 0.1 * z,
          0.2 * x[0] - 0.35 * x[1] - 0.15 * z};
}

/// The strain of linear_field; out of plane in plane stress the implied one.
std::vector<double> linear_strain(Space space) {
  switch (space) {
  case Space::Axisymmetric:
    return {0.3, -0.2, 0.3, 0};
  case Space::PlaneStrain:
    return {0.3, 0.25, 0, 0.2};
  case Space::PlaneStress:
    return {0.3, 0.25, -0.3 / 0.7 * 0.55, 0.2};
  default:
    return {0.3, 0.25, -0.15, 0.2, -0.45, 0.35};
  }
}

/// Number of rigid motions of a space and displacement field of motion k.
int num_rigid(Space space) { return space == Space::Solid ? 6 : (space == Space::Axisymmetric ? 1 : 3); }
std::array<double, 3> rigid_motion(Space space, int k, std::span<const double> x) {
  if (space == Space::Axisymmetric) return {0, 1, 0};
  std::array<double, 3> u{};
  const int dim = space_dim(space);
  if (k < dim) {
    u[k] = 1;
  } else {
    const int i = k - dim, j = (i + 1) % 3;
    u[i] = -x[j];
    u[j] = x[i];
  }
  return u;
}

/// Elasticity that hides that it is linear, behind a yield stress that nothing reaches: forms must take their general
/// kernel.
SmallLaw hidden() {
  return SmallPlastic{
      {.elastic = soft, .hardening = LinearHardening{.yield = 1e9, .H = 0}, .kinematic = {}, .rate = {}}};
}

/// Plasticity that flows at a strain of a per cent.
SmallLaw flowing() {
  return SmallPlastic{
      {.elastic = soft, .hardening = LinearHardening{.yield = 0.05, .H = 1}, .kinematic = {}, .rate = {}}};
}

/// σ of `soft` with the components that a form has.
std::vector<double> soft_stress(Space space, std::span<const double> strain) {
  std::vector<double> stress(strain.size());
  const Lame lame = lame_constants(soft, space);
  if (strain.size() == 4)
    Eigen::Map<Stress<2>>(stress.data()) = elastic_stress<2>(lame, space, Eigen::Map<const Strain<2>>(strain.data()));
  else
    Eigen::Map<Stress<3>>(stress.data()) = elastic_stress<3>(lame, space, Eigen::Map<const Strain<3>>(strain.data()));
  return stress;
}

} // namespace

TEST_CASE("patch test: a linear displacement gives constant stress and no force inside") {
  for (const auto& [type, space] : all_cases()) {
    CAPTURE(int(type));
    CAPTURE(int(space));
    const Mesh mesh = small_mesh(type);
    const DofLayout layout(mesh, {}, {});
    BulkForm form(layout, space, {soft});
    const Eigen::VectorXd u = nodal_values(mesh, [&](auto x) { return linear_field(space, x); });
    const Eigen::VectorXd force = residual_of(layout, form, u);
    std::vector<bool> outside(mesh.num_local());
    for (const auto& [name, nodes] : mesh.node_groups)
      for (const auto node : nodes)
        outside[node] = true;
    double inside = 0;
    int count = 0;
    for (std::int32_t node = 0; node < mesh.num_local(); ++node)
      if (!outside[node]) {
        ++count;
        inside = std::max(inside, force.segment(node * mesh.dim, mesh.dim).cwiseAbs().maxCoeff());
      }
    CHECK(count > 0);
    CHECK(force.cwiseAbs().maxCoeff() > 0.01);
    CHECK(inside < 1e-12 * force.cwiseAbs().maxCoeff());

    const auto stress = soft_stress(space, linear_strain(space));
    form.for_each_batch(state_of(u), [&](const PointBatch& batch) {
      for (std::size_t i = 0; i < batch.stress.size(); ++i)
        REQUIRE(batch.stress[i] == doctest::Approx(stress[i % stress.size()]).epsilon(1e-11));
    });
  }
}

TEST_CASE("forces are the derivative of the energy, the tangent that of the forces") {
  for (const auto& [type, space] : all_cases())
    for (const SmallLaw& law : {SmallLaw{soft}, hidden(), flowing()}) {
      const bool linear = std::holds_alternative<Elastic>(law);
      if (!linear && space == Space::PlaneStress) continue;
      const bool flows = !linear && std::get<LinearHardening>(std::get<SmallPlastic>(law).material.hardening).H > 0;
      CAPTURE(int(type));
      CAPTURE(int(space));
      CAPTURE(flows);
      const Mesh mesh = small_mesh(type, PETSC_COMM_SELF, {2, 1, 1});
      const DofLayout layout(mesh, {}, {});
      BulkForm form(layout, space, {law});
      CHECK(form.tangent_is_constant() == linear);
      const Eigen::VectorXd u = 0.1 * random_vector(layout.num_global(), 1), v = random_vector(layout.num_global(), 2);
      const Eigen::VectorXd force = residual_of(layout, form, u);
      const Eigen::MatrixXd K = tangent_of(layout, form, u);
      REQUIRE(force.norm() > 0.1);
      REQUIRE(std::abs(force.dot(v)) > 1e-3);
      CHECK((K - K.transpose()).norm() < 1e-13 * K.norm());
      CHECK(form.internal_work(state_of(u)) == doctest::Approx(force.dot(u)).epsilon(1e-11));

      // Taylor: the error of a first-order expansion falls with the square of the step; zero for a linear law.
      const auto remainder = [&](double h) {
        return (residual_of(layout, form, u + h * v) - force - h * (K * v)).norm();
      };
      if (flows) {
        CHECK(remainder(1e-4) > 1e-10);
        CHECK(std::log2(remainder(2e-4) / remainder(1e-4)) == doctest::Approx(2).epsilon(0.03));
      } else {
        CHECK(remainder(1) < 1e-12 * (K * v).norm());
      }
      // The increment's potential, energy stored and dissipated: quadratic for a linear law, for which the five-point
      // difference is exact, else smooth.
      const auto energy = [&](double h) {
        return form.stored_energy(state_of(u + h * v)) + form.dissipated_energy(state_of(u + h * v));
      };
      const double h = flows ? 1e-4 : 0.1;
      const double slope = (8 * (energy(h) - energy(-h)) - (energy(2 * h) - energy(-2 * h))) / (12 * h);
      CHECK(std::abs(slope - force.dot(v)) < 1e-8 * force.norm() * v.norm());
      if (!flows) CHECK(form.stored_energy(state_of(u)) == doctest::Approx(0.5 * u.dot(K * u)).epsilon(1e-12));
      if (flows) CHECK(form.dissipated_energy(state_of(u)) > 0.1 * form.stored_energy(state_of(u)));
    }
}

TEST_CASE("the isotropic kernel agrees with the general one") {
  for (const auto& [type, space] : all_cases()) {
    if (space == Space::PlaneStress) continue;
    CAPTURE(int(type));
    CAPTURE(int(space));
    const Mesh mesh = small_mesh(type, PETSC_COMM_SELF, {1, 1, 1});
    const DofLayout layout(mesh, {}, {});
    BulkForm fast(layout, space, {soft});
    BulkForm general(layout, space, {hidden()});
    const Eigen::VectorXd u = Eigen::VectorXd::Zero(layout.num_global());
    const Eigen::MatrixXd K = tangent_of(layout, general, u);
    CHECK((tangent_of(layout, fast, u) - K).norm() < 1e-13 * K.norm());
  }
}

TEST_CASE("only an accepted increment of plastic flow is remembered, and history goes back") {
  for (const auto& [type, space] : all_cases()) {
    if (space == Space::PlaneStress) continue;
    CAPTURE(int(type));
    CAPTURE(int(space));
    const Mesh mesh = small_mesh(type, PETSC_COMM_SELF, {1, 1, 1});
    const DofLayout layout(mesh, {}, {});
    BulkForm form(layout, space, {flowing()});
    const Eigen::VectorXd u = nodal_values(mesh, [](auto x) { return std::array<double, 3>{0, 0.05 * x[0], 0}; });
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(u.size());
    const auto virgin = form.history();
    const Eigen::VectorXd loaded = residual_of(layout, form, u, 1.0);
    CHECK(residual_of(layout, form, none, 1.0).norm() < 1e-14); // tried, not accepted: nothing stays
    form.commit(state_of(u, 1.0));
    CHECK(form.dissipated_energy(state_of(u, 1.0)) > 0.0);
    CHECK((residual_of(layout, form, u, 1.0) - loaded).norm() < 1e-10 * loaded.norm());
    CHECK(residual_of(layout, form, none, 2.0).norm() > 0.1 * loaded.norm());
    form.for_each_batch(state_of(u, 1.0), [&](const PointBatch& batch) {
      // Simple shear: γ = τ / G + √3 p, τ = σ_y / √3 = (0.05 + p) / √3.
      const double G = soft.young / (2 * (1 + soft.poisson)),
                   p = (0.05 - 0.05 / std::sqrt(3.0) / G) / (std::sqrt(3.0) + 1 / std::sqrt(3.0) / G);
      REQUIRE(batch.scalars.size() == batch.weights.size());
      for (const double plastic_strain : batch.scalars)
        if (space != Space::Axisymmetric) REQUIRE(plastic_strain == doctest::Approx(p).epsilon(1e-9));
    });
    form.restore(virgin);
    CHECK(residual_of(layout, form, none, 1.0).norm() < 1e-14);
  }
}

TEST_CASE("an elastic body beside a plastic one is the constant part of the tangent") {
  Mesh mesh = small_mesh(ElementType::Quadrilateral4, PETSC_COMM_SELF, {2, 1, 1});
  mesh.bodies = {"metal", "tool"};
  const CellBlock both = mesh.blocks[0];
  mesh.blocks = {{both.type, 0, {both.cell(0).begin(), both.cell(0).end()}},
                 {both.type, 1, {both.cell(1).begin(), both.cell(1).end()}}};
  const DofLayout layout(mesh, {}, {});
  BulkForm form(layout, Space::PlaneStrain, {flowing(), soft});
  BulkForm elastic(layout, Space::PlaneStrain, {soft, soft});
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(layout.num_global()), u = 0.1 * random_vector(none.size(), 1);
  DenseTangent constant(layout.num_global()), changing(layout.num_global());
  form.add_constant_tangent(state_of(u), constant);
  form.add_changing_tangent(state_of(u), changing);
  CHECK(!form.tangent_is_constant());
  CHECK(constant.matrix.norm() > 0);
  CHECK((constant.matrix + changing.matrix - tangent_of(layout, form, u)).norm() == 0);
  form.add_changing_tangent(state_of(none), constant);
  CHECK((constant.matrix - tangent_of(layout, elastic, none)).norm() < 1e-13 * constant.matrix.norm());
}

TEST_CASE("rigid motions need no force, and nothing else is free of force") {
  for (const auto& [type, space] : all_cases()) {
    CAPTURE(int(type));
    CAPTURE(int(space));
    const Mesh mesh = small_mesh(type, PETSC_COMM_SELF, {1, 1, 1});
    const DofLayout layout(mesh, {}, {});
    BulkForm form(layout, space, {soft});
    for (int k = 0; k < num_rigid(space); ++k) {
      const Eigen::VectorXd u = nodal_values(mesh, [&](auto x) { return rigid_motion(space, k, x); });
      CHECK(residual_of(layout, form, u).norm() < 1e-12 * u.norm() * soft.young);
      CHECK(std::abs(form.stored_energy(state_of(u))) < 1e-12);
    }
    const Eigen::MatrixXd K = tangent_of(layout, form, Eigen::VectorXd::Zero(layout.num_global()));
    const Eigen::VectorXd eigenvalues = K.selfadjointView<Eigen::Lower>().eigenvalues();
    const int rigid = num_rigid(space);
    CHECK(eigenvalues.head(rigid).cwiseAbs().maxCoeff() < 1e-12 * eigenvalues.tail(1)[0]);
    CHECK(eigenvalues[rigid] > 1e-4 * eigenvalues.tail(1)[0]);
  }
}

TEST_CASE("far rigid motions need no force with a law of memory either") {
  for (const auto& [type, space] : all_cases()) {
    if (space == Space::PlaneStress) continue;
    CAPTURE(int(type));
    CAPTURE(int(space));
    const Mesh mesh = small_mesh(type, PETSC_COMM_SELF, {1, 1, 1});
    const DofLayout layout(mesh, {}, {});
    BulkForm form(layout, space, {flowing()});
    for (int k = 0; k < num_rigid(space); ++k) {
      const Eigen::VectorXd u = 1e6 / 3 * nodal_values(mesh, [&](auto x) { return rigid_motion(space, k, x); });
      CHECK(residual_of(layout, form, u).norm() < 1e-12 * u.norm() * soft.young);
    }
  }
}

TEST_CASE("axisymmetric: moving away from the axis costs hoop strain") {
  const Mesh mesh = small_mesh(ElementType::Quadrilateral4);
  const DofLayout layout(mesh, {}, {});
  BulkForm form(layout, Space::Axisymmetric, {soft});
  const Eigen::VectorXd u = nodal_values(mesh, [](auto) { return std::array<double, 3>{1, 0, 0}; });
  CHECK(residual_of(layout, form, u).norm() > 1);
}

TEST_CASE("nodal stress of a linear displacement is its constant stress at every node, on any number of ranks") {
  for (const auto& [type, space] : all_cases()) {
    CAPTURE(int(type));
    CAPTURE(int(space));
    const Mesh mesh = small_mesh(type, PETSC_COMM_WORLD);
    const DofLayout layout(mesh, {}, {});
    BulkForm form(layout, space, {soft});
    const Eigen::VectorXd u = nodal_values(mesh, [&](auto x) { return linear_field(space, x); });
    const NodalStress nodal = nodal_stress(form, mesh, state_of(u));
    const auto strain = linear_strain(space);
    const auto stress = soft_stress(space, strain);
    REQUIRE(nodal.stress.size() == std::size_t(mesh.num_local()) * stress.size());
    double error = 0;
    for (std::size_t i = 0; i < nodal.stress.size(); ++i)
      error = std::max({error, std::abs(nodal.stress[i] - stress[i % stress.size()]),
                        std::abs(nodal.strain[i] - strain[i % strain.size()])});
    CHECK(error < 1e-12);
  }
}

TEST_CASE("nodal stress does not depend on the number of ranks") {
  const Field field = [](std::span<const double> x) {
    return std::array<double, 3>{std::sin(x[0] + 2 * x[1]), x[0] * x[1], std::cos(x[0]) * x[2]};
  };
  for (const ElementType type : {ElementType::Hexahedron8, ElementType::Tetrahedron10}) {
    const Mesh alone = small_mesh(type), spread = small_mesh(type, PETSC_COMM_WORLD);
    const DofLayout layout_alone(alone, {}, {}), layout_spread(spread, {}, {});
    BulkForm form_alone(layout_alone, Space::Solid, {soft});
    BulkForm form_spread(layout_spread, Space::Solid, {soft});
    const Eigen::VectorXd u_alone = nodal_values(alone, field), u_spread = nodal_values(spread, field);
    const auto wanted = nodal_stress(form_alone, alone, state_of(u_alone)).stress;
    const auto got = nodal_stress(form_spread, spread, state_of(u_spread)).stress;
    std::map<std::uint64_t, std::int32_t> by_key;
    for (std::int32_t node = 0; node < alone.num_local(); ++node)
      by_key[alone.keys[node]] = node;
    double error = 0, largest = 0;
    for (std::int32_t node = 0; node < spread.num_local(); ++node)
      for (int i = 0; i < 6; ++i) {
        error = std::max(error, std::abs(got[node * 6 + i] - wanted[by_key.at(spread.keys[node]) * 6 + i]));
        largest = std::max(largest, std::abs(got[node * 6 + i]));
      }
    CHECK(largest > 0.5);
    CHECK(error < 1e-12);
  }
}

TEST_CASE("every element couples its own unknowns and no others") {
  struct Recorder : Coupling {
    void add(std::span<const PetscInt> equations) override { sets.emplace_back(equations.begin(), equations.end()); }
    std::vector<std::vector<PetscInt>> sets;
  } recorder;
  const Mesh mesh = small_mesh(ElementType::Quadrilateral9);
  const DofLayout layout(mesh, {}, {});
  const BulkForm form(layout, Space::PlaneStrain, {soft});
  form.couple(recorder);
  REQUIRE(recorder.sets.size() == std::size_t(mesh.blocks[0].size()));
  for (std::int32_t c = 0; c < mesh.blocks[0].size(); ++c)
    for (int a = 0; a < 9; ++a)
      for (int i = 0; i < 2; ++i)
        CHECK(recorder.sets[c][a * 2 + i] == layout.equation(mesh.blocks[0].cell(c)[a], i));
}

TEST_CASE("inverted cells and cells across the axis are refused with their place") {
  const Mesh mirrored = box_mesh(PETSC_COMM_SELF, ElementType::Triangle3, {1, 1, 1}, [](auto p) {
    return std::array<double, 3>{-p[0], p[1], 0};
  });
  const DofLayout layout(mirrored, {}, {});
  const auto make = [&layout](Space space) { BulkForm(layout, space, {soft}); };
  CHECK_THROWS_WITH_AS(make(Space::PlaneStrain), doctest::Contains("'block' near (-0."), UserError);

  const Mesh across = box_mesh(PETSC_COMM_SELF, ElementType::Triangle3, {1, 1, 1}, [](auto p) {
    return std::array<double, 3>{p[0] - 2, p[1], 0};
  });
  const DofLayout layout_across(across, {}, {});
  const auto make_across = [&](Space space) { BulkForm(layout_across, space, {soft}); };
  CHECK_NOTHROW(make_across(Space::PlaneStress));
  CHECK_THROWS_WITH_AS(make_across(Space::Axisymmetric), doctest::Contains("radius"), UserError);
}
