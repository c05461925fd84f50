// Loads against closed forms of their totals, on any number of ranks.
#include "base/error.hpp"
#include "dense_system.hpp"
#include "form/loads.hpp"

#include <doctest/doctest.h>
#include <numbers>

using namespace amontons;
using namespace amontons::testing;
using std::numbers::pi;

namespace {

constexpr ElementType plane_types[] = {ElementType::Triangle3, ElementType::Triangle6, ElementType::Quadrilateral4,
                                       ElementType::Quadrilateral9};
constexpr ElementType solid_types[] = {ElementType::Tetrahedron4, ElementType::Tetrahedron10, ElementType::Hexahedron8,
                                       ElementType::Hexahedron27};

/// Sum of the load (minus the residual) over all nodes, per component.
std::array<double, 3> total(const DofLayout& layout, LoadForm& form, double time = 0) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(std::size_t(layout.mesh().num_local()) * layout.dim());
  const Eigen::VectorXd residual = residual_of(layout, form, none, time);
  std::array<double, 3> sum{};
  for (Eigen::Index i = 0; i < residual.size(); ++i)
    sum[i % layout.dim()] -= residual[i];
  MPI_Allreduce(MPI_IN_PLACE, sum.data(), 3, MPI_DOUBLE, MPI_SUM, layout.mesh().comm);
  return sum;
}

/// Quarter ring, inner radius 1 at x-, outer radius 2 at x+; z from 0 to 3.
std::array<double, 3> quarter_ring(std::array<double, 3> p) {
  const double r = 1 + p[0], angle = pi / 2 * p[1];
  return {r * std::cos(angle), r * std::sin(angle), 3 * p[2]};
}

/// Rectangle or block [1, 3] x [0, 3] x [0, 4].
std::array<double, 3> block(std::array<double, 3> p) { return {1 + 2 * p[0], 3 * p[1], 4 * p[2]}; }

Mesh parallel_mesh(ElementType type, const Shape& shape) { return box_mesh(PETSC_COMM_WORLD, type, {4, 4, 2}, shape); }

using Components = std::array<std::optional<Expression>, 3>;

SurfaceLoad pressure_on(const std::string& group, const Expression& p) { return {group, {}, p}; }

} // namespace

TEST_CASE("pressure on a quarter arc pushes with p times the projected area") {
  // Exact for every mesh whose ends lie on the arc: the integral of the normal depends on the ends alone.
  for (const ElementType type : plane_types) {
    const Mesh mesh = parallel_mesh(type, quarter_ring);
    const DofLayout layout(mesh, {}, {});
    LoadForm inner(layout, Space::PlaneStrain, {pressure_on("x-", Expression("2*t", {}))}, {}, {});
    LoadForm outer(layout, Space::PlaneStrain, {pressure_on("x+", 2.0)}, {}, {});
    const auto outward = total(layout, inner, 3.0), inward = total(layout, outer);
    for (int i = 0; i < 2; ++i) {
      CHECK(outward[i] == doctest::Approx(6.0).epsilon(1e-12)); // on radius 1
      CHECK(inward[i] == doctest::Approx(-4.0).epsilon(1e-12)); // on radius 2
    }
  }
  for (const ElementType type : solid_types) {
    const Mesh mesh = parallel_mesh(type, quarter_ring);
    const DofLayout layout(mesh, {}, {});
    LoadForm inner(layout, Space::Solid, {pressure_on("x-", 2.0)}, {}, {});
    const auto outward = total(layout, inner);
    CHECK(outward[0] == doctest::Approx(6.0).epsilon(1e-12)); // radius 1, height 3
    CHECK(outward[1] == doctest::Approx(6.0).epsilon(1e-12));
    CHECK(std::abs(outward[2]) < 1e-12);
  }
}

TEST_CASE("traction on a quarter arc sums to the arc length, closer with the element's order") {
  for (const ElementType type : {ElementType::Quadrilateral4, ElementType::Quadrilateral9}) {
    std::vector<double> errors;
    for (const int n : {4, 8}) {
      const Mesh mesh = box_mesh(PETSC_COMM_SELF, type, {1, n, 1}, quarter_ring);
      const DofLayout layout(mesh, {}, {});
      LoadForm form(layout, Space::PlaneStress, {{"x+", Components{1.0, std::nullopt, std::nullopt}, std::nullopt}}, {},
                    {});
      errors.push_back(std::abs(total(layout, form)[0] - pi));
    }
    const int order = element_order(type) == 1 ? 2 : 4;
    CHECK(std::log2(errors[0] / errors[1]) == doctest::Approx(order).epsilon(0.05));
  }
}

TEST_CASE("tractions that vary in time and place are integrated exactly on flat sides") {
  for (const ElementType type : plane_types) {
    const Mesh mesh = parallel_mesh(type, block);
    const DofLayout layout(mesh, {}, {});
    LoadForm form(layout, Space::PlaneStrain,
                  {{"y+", Components{Expression("x^2*t", {}), Expression("x*y", {}), std::nullopt}, std::nullopt}}, {},
                  {});
    CHECK(total(layout, form, 2.0)[0] == doctest::Approx(2 * 26.0 / 3).epsilon(1e-12)); // ∫_1^3 x² dx = 26/3
    CHECK(total(layout, form, 4.0)[0] == doctest::Approx(4 * 26.0 / 3).epsilon(1e-12));
    CHECK(total(layout, form, 4.0)[1] == doctest::Approx(12.0).epsilon(1e-12)); // 3 ∫ x dx
  }
  for (const ElementType type : solid_types) {
    const Mesh mesh = parallel_mesh(type, block);
    const DofLayout layout(mesh, {}, {});
    LoadForm form(layout, Space::Solid,
                  {{"z+", Components{std::nullopt, std::nullopt, Expression("x*y^2*z", {})}, std::nullopt}}, {}, {});
    CHECK(total(layout, form)[2] == doctest::Approx(4 * 4.0 * 9.0).epsilon(1e-12)); // z ∫ x dx ∫ y² dy
  }
}

TEST_CASE("axisymmetric loads act on the whole circumference") {
  for (const ElementType type : plane_types) {
    const Mesh mesh = parallel_mesh(type, block);
    const DofLayout layout(mesh, {}, {});
    LoadForm bore(layout, Space::Axisymmetric, {pressure_on("x-", 2.0)}, {}, {});
    CHECK(total(layout, bore)[0] == doctest::Approx(2 * 2 * pi * 1 * 3).epsilon(1e-12)); // p 2 π r h
    LoadForm lid(layout, Space::Axisymmetric, {pressure_on("y+", 2.0)}, {}, {});
    CHECK(total(layout, lid)[1] == doctest::Approx(-2 * pi * (9 - 1)).epsilon(1e-12));
    LoadForm weight(layout, Space::Axisymmetric, {}, {{"block", Components{std::nullopt, -5.0, std::nullopt}}}, {});
    CHECK(total(layout, weight)[1] == doctest::Approx(-5 * pi * (9 - 1) * 3).epsilon(1e-12));
  }
}

TEST_CASE("body forces sum to force per volume times volume") {
  for (const ElementType type : solid_types) {
    const Mesh mesh = parallel_mesh(type, block);
    const DofLayout layout(mesh, {}, {});
    LoadForm form(layout, Space::Solid, {}, {{"block", Components{Expression("x*z", {}), std::nullopt, -9.81}}}, {});
    const auto sum = total(layout, form);
    CHECK(sum[0] == doctest::Approx(4 * 3 * 8.0).epsilon(1e-12)); // ∫ x dx ∫ dy ∫ z dz
    CHECK(sum[1] == 0);
    CHECK(sum[2] == doctest::Approx(-9.81 * 24).epsilon(1e-12));
  }
  for (const ElementType type : plane_types) {
    const Mesh mesh = parallel_mesh(type, block);
    const DofLayout layout(mesh, {}, {});
    LoadForm form(layout, Space::PlaneStress, {}, {{"block", Components{3.0, std::nullopt, std::nullopt}}}, {});
    CHECK(total(layout, form)[0] == doctest::Approx(18.0).epsilon(1e-12));
  }
}

TEST_CASE("a resultant is one force on the equation of its group, whatever the number of ranks") {
  const Mesh mesh = parallel_mesh(ElementType::Quadrilateral4, block);
  const DofLayout layout(mesh, {{"y+", 1}, {"x+", 0}}, {});
  LoadForm form(layout, Space::PlaneStrain, {}, {}, {{0, Expression("-35*t", {})}, {1, 4.0}});
  const auto sum = total(layout, form, 2.0);
  CHECK(sum[0] == doctest::Approx(4.0));
  CHECK(sum[1] == doctest::Approx(-70.0));
}

TEST_CASE("loads on names that the mesh lacks are refused with the names that it has") {
  const Mesh mesh = parallel_mesh(ElementType::Quadrilateral4, block);
  const DofLayout layout(mesh, {}, {});
  const auto surface = [&](const std::string& name) {
    LoadForm(layout, Space::PlaneStrain, {pressure_on(name, 1.0)}, {}, {});
  };
  CHECK_THROWS_WITH_AS(surface("x"), doctest::Contains("y-"), UserError);
  const auto body = [&](const std::string& name) {
    LoadForm(layout, Space::PlaneStrain, {}, {{name, Components{std::nullopt, std::nullopt, 1.0}}}, {});
  };
  CHECK_THROWS_WITH_AS(body("blok"), doctest::Contains("did you mean 'block'?"), UserError);
  CHECK_THROWS_WITH_AS(body("block"), doctest::Contains("z component"), UserError);
}
