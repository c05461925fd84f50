// Pressure on deformed surfaces: against the volume enclosed, the dead load at rest, and finite differences.
#include "base/error.hpp"
#include "dense_system.hpp"
#include "form/follower_pressure.hpp"
#include "form/loads.hpp"

#include <doctest/doctest.h>
#include <numbers>

using namespace amontons;
using namespace amontons::testing;

namespace {

Mesh block(ElementType type) {
  return box_mesh(PETSC_COMM_SELF, type, {2, 1, 1}, [](std::array<double, 3> p) {
    const auto [x, y, z] = p;
    return std::array<double, 3>{1 + x + 0.2 * y, y - 0.15 * x + 0.1 * x * y, z + 0.1 * x * y};
  });
}

std::vector<FollowerPressure> on_sides(const std::vector<std::string>& sides, const Expression& pressure) {
  std::vector<FollowerPressure> loads;
  for (const auto& side : sides)
    loads.push_back({side, pressure});
  return loads;
}

std::vector<std::string> all_sides(const Mesh& mesh) {
  std::vector<std::string> sides;
  for (const auto& [name, facets] : mesh.surfaces)
    if (facets.size() > 0) sides.push_back(name);
  return sides;
}

/// Volume of the deformed mesh; of the full turn when axisymmetric.
double volume(const Mesh& mesh, Space space, const Eigen::VectorXd& u) {
  double sum = 0;
  for (const auto& cells : mesh.blocks) {
    const Tabulation& table = tabulation(cells.type, 7);
    for (std::int32_t c = 0; c < cells.size(); ++c)
      for (int q = 0; q < table.rule->size(); ++q) {
        Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(mesh.dim, mesh.dim);
        double r = 0;
        const auto nodes = cells.cell(c);
        for (std::size_t a = 0; a < nodes.size(); ++a)
          for (int i = 0; i < mesh.dim; ++i) {
            const double x = mesh.position(nodes[a])[i] + u[nodes[a] * mesh.dim + i];
            if (i == 0) r += table.value(q)[a] * x;
            for (int j = 0; j < mesh.dim; ++j)
              jacobian(i, j) += table.gradient(q)[a * mesh.dim + j] * x;
          }
        sum += table.rule->weights[q] * jacobian.determinant() * circumference(space, r);
      }
  }
  return sum;
}

} // namespace

TEST_CASE("follower pressure: uniform on a closed surface it works on the change of volume") {
  for (const auto& [type, space] : finite_cases()) {
    CAPTURE(int(type));
    CAPTURE(int(space));
    const Mesh mesh = block(type);
    const DofLayout layout(mesh, {}, {});
    FollowerPressureForm form(layout, space, on_sides(all_sides(mesh), Expression(3.0)));
    const Eigen::VectorXd u = 0.1 * random_vector(layout.num_global(), 1), v = random_vector(u.size(), 2);
    const Eigen::VectorXd residual = residual_of(layout, form, u);
    // δV is a cubic of the step at most: the five-point difference is exact.
    const auto V = [&](double h) { return volume(mesh, space, u + h * v); };
    const double h = 0.1, slope = (8 * (V(h) - V(-h)) - (V(2 * h) - V(-2 * h))) / (12 * h);
    REQUIRE(std::abs(slope) > 1e-2);
    CHECK(residual.dot(v) == doctest::Approx(3 * slope).epsilon(1e-11)); // the residual is minus the force
  }
}

TEST_CASE("follower pressure: the tangent is the derivative of the residual, on part of the surface too") {
  for (const auto& [type, space] : finite_cases()) {
    CAPTURE(int(type));
    CAPTURE(int(space));
    const Mesh mesh = block(type);
    const DofLayout layout(mesh, {}, {});
    FollowerPressureForm form(layout, space, on_sides({"x+", "y-"}, Expression("1 + x*y", {})));
    CHECK(!form.tangent_is_symmetric());
    const Eigen::VectorXd u = 0.1 * random_vector(layout.num_global(), 1), v = random_vector(u.size(), 2);
    const Eigen::MatrixXd K = tangent_of(layout, form, u);
    REQUIRE((K * v).norm() > 0.05);
    const double h = 0.01; // the residual is a polynomial of degree 3 at most
    const auto r = [&](double s) -> Eigen::VectorXd { return residual_of(layout, form, u + s * h * v); };
    const Eigen::VectorXd slope = (8 * (r(1) - r(-1)) - (r(2) - r(-2))) / (12 * h);
    CHECK((slope - K * v).norm() < 1e-11 * (K * v).norm());
  }
}

TEST_CASE("follower pressure: at rest it is the dead pressure, and it turns with the body") {
  for (const auto& [type, space] : finite_cases()) {
    CAPTURE(int(type));
    CAPTURE(int(space));
    const Mesh mesh = block(type);
    const DofLayout layout(mesh, {}, {});
    FollowerPressureForm follower(layout, space, on_sides({"x+"}, Expression(2.0)));
    LoadForm dead(layout, space, {{"x+", {}, Expression(2.0)}}, {}, {});
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(layout.num_global());
    const Eigen::VectorXd force = residual_of(layout, dead, none);
    REQUIRE(force.norm() > 0.1);
    CHECK((residual_of(layout, follower, none) - force).norm() < 1e-12 * force.norm());
    if (space == Space::Axisymmetric) continue;
    const Eigen::VectorXd turned = nodal_values(mesh, [](auto X) { // by a right angle about z
      return std::array<double, 3>{-X[1] - X[0], X[0] - X[1], 0};
    });
    const Eigen::VectorXd after = residual_of(layout, follower, turned);
    for (std::int32_t node = 0; node < mesh.num_local(); ++node) {
      CHECK(after[node * mesh.dim] == doctest::Approx(-force[node * mesh.dim + 1]).epsilon(1e-12));
      CHECK(after[node * mesh.dim + 1] == doctest::Approx(force[node * mesh.dim]).epsilon(1e-12));
    }
  }
}

TEST_CASE("follower pressure: a surface that the mesh lacks is refused") {
  const Mesh mesh = block(ElementType::Quadrilateral4);
  const DofLayout layout(mesh, {}, {});
  CHECK_THROWS_WITH_AS(FollowerPressureForm(layout, Space::PlaneStrain, on_sides({"lid"}, Expression(1.0))),
                       doctest::Contains("no surface group 'lid'"), UserError);
}
