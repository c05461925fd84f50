// Whole elastic problems with closed-form solutions: orders of convergence, and no locking near incompressibility.
#include "dense_system.hpp"
#include "form/bulk.hpp"
#include "form/loads.hpp"
#include "material/elastic.hpp"

#include <doctest/doctest.h>
#include <numbers>

using namespace amontons;
using namespace amontons::testing;
using std::numbers::pi;

namespace {

constexpr double inner = 1.0, outer = 2.0, pressure = 3.0;

/// Lamé's thick cylinder under inner pressure, ε_zz = 0 or (with the constants of plane stress) σ_zz = 0:
/// u_r = A r + B / r with 2 (λ + G) A = p a² / (b² - a²), 2 G B = p a² b² / (b² - a²); then
/// σ_rr = 2 (λ + G) A - 2 G B / r² is -p at a and 0 at b.
struct ThickCylinder {
  double A, B;
  explicit ThickCylinder(const Lame& lame) {
    const double scale = pressure * inner * inner / (outer * outer - inner * inner);
    A = scale / (2 * (lame.lambda + lame.G));
    B = scale * outer * outer / (2 * lame.G);
  }
  double radial(double r) const { return A * r + B / r; }
};

/// A ring sector of 45 degrees (plane, solid with height 1/2) or the meridian rectangle (axisymmetric).
Mesh cylinder_mesh(ElementType type, Space space, int n) {
  return box_mesh(PETSC_COMM_SELF, type, {n, n, 1}, [space](auto p) -> std::array<double, 3> {
    const double r = inner + (outer - inner) * p[0], angle = pi / 4 * p[1];
    if (space == Space::Axisymmetric) return {r, 0.5 * p[1], 0};
    return {r * std::cos(angle), r * std::sin(angle), 0.5 * p[2]};
  });
}

void prescribe(std::map<Eigen::Index, double>& prescribed, const Mesh& mesh, const std::string& group, int component,
               const Field& exact) {
  for (const auto node : mesh.node_groups.at(group))
    prescribed[node * mesh.dim + component] = exact(mesh.position(node))[component];
}

/// Displacement error of the cylinder, relative to the size of the displacement.
double cylinder_error(ElementType type, Space space, double nu, int n) {
  const Elastic material{100.0, nu};
  const ThickCylinder solution(lame_constants(material, space));
  const Mesh mesh = cylinder_mesh(type, space, n);
  const DofLayout layout(mesh, {}, {});
  BulkForm solid(layout, space, {make_law(material, space)});
  LoadForm loads(layout, space, {{"x-", {}, pressure}}, {}, {});
  const Field exact = [&](std::span<const double> x) -> std::array<double, 3> {
    if (space == Space::Axisymmetric) return {solution.radial(x[0]), 0, 0};
    const double r = std::hypot(x[0], x[1]), u = solution.radial(r);
    return {u * x[0] / r, u * x[1] / r, 0};
  };
  std::map<Eigen::Index, double> prescribed;
  prescribe(prescribed, mesh, "y-", 1, exact);
  // The upper side: on the 45 degree line the exact displacement stands for symmetry.
  prescribe(prescribed, mesh, "y+", 1, exact);
  if (space != Space::Axisymmetric) prescribe(prescribed, mesh, "y+", 0, exact);
  if (space == Space::Solid)
    for (const auto* side : {"z-", "z+"})
      prescribe(prescribed, mesh, side, 2, exact);
  const Eigen::VectorXd u = solve_linear(layout, solid, loads, prescribed);
  return displacement_error(mesh, u, exact) / solution.radial(inner);
}

struct Case {
  ElementType type;
  Space space;
};

/// A divergence-free field: stress 2 G ε and body force -div σ do not depend on Poisson's ratio, so neither should the
/// error of the approximation.
struct Isochoric {
  Field displacement;
  std::array<std::string, 3> force; // per G
};

Isochoric isochoric(Space space) {
  switch (space) {
  case Space::PlaneStrain: // u = (sin πx cos πy, -cos πx sin πy), -Δu = 2 π² u
    return {[](std::span<const double> x) -> std::array<double, 3> {
              return {std::sin(pi * x[0]) * std::cos(pi * x[1]), -std::cos(pi * x[0]) * std::sin(pi * x[1]), 0};
            },
            {"2*pi^2*sin(pi*x)*cos(pi*y)", "-2*pi^2*cos(pi*x)*sin(pi*y)", ""}};
  case Space::Axisymmetric: // u = (-½ r cos z, sin z): tr ε = -cos z + cos z; f = (-½ r cos z, sin z)
    return {[](std::span<const double> x) -> std::array<double, 3> {
              return {-0.5 * x[0] * std::cos(x[1]), std::sin(x[1]), 0};
            },
            {"-0.5*x*cos(y)", "sin(y)", ""}};
  default: // u = (2 s c c, -c s c, -c c s), -Δu = 3 π² u
    return {[](std::span<const double> x) -> std::array<double, 3> {
              const auto s = [&](int i) { return std::sin(pi * x[i]); };
              const auto c = [&](int i) { return std::cos(pi * x[i]); };
              return {2 * s(0) * c(1) * c(2), -c(0) * s(1) * c(2), -c(0) * c(1) * s(2)};
            },
            {"6*pi^2*sin(pi*x)*cos(pi*y)*cos(pi*z)", "-3*pi^2*cos(pi*x)*sin(pi*y)*cos(pi*z)",
             "-3*pi^2*cos(pi*x)*cos(pi*y)*sin(pi*z)"}};
  }
}

double isochoric_error(ElementType type, Space space, double nu, int n) {
  const double G = 1.0;
  const Elastic material{2 * G * (1 + nu), nu};
  const Isochoric problem = isochoric(space);
  const Mesh mesh = box_mesh(PETSC_COMM_SELF, type, {n, n, n}, [space](auto p) -> std::array<double, 3> {
    if (space == Space::Axisymmetric) return {1 + p[0], p[1], 0};
    if (space == Space::Solid) return {0.5 * p[0], 0.5 * p[1], 0.5 * p[2]};
    return p;
  });
  const DofLayout layout(mesh, {}, {});
  BulkForm solid(layout, space, {make_law(material, space)});
  BodyLoad force{"block", {}};
  for (int i = 0; i < mesh.dim; ++i)
    force.force[i] = Expression(problem.force[i], {});
  std::map<Eigen::Index, double> prescribed;
  for (const auto& [group, nodes] : mesh.node_groups)
    if (space == Space::PlaneStrain || group != "x+")
      for (int i = 0; i < mesh.dim; ++i)
        prescribe(prescribed, mesh, group, i, problem.displacement);
  // Where the normal displacement is not zero, a side must be free for the approximation to keep its volume.
  std::vector<SurfaceLoad> tractions;
  if (space == Space::Axisymmetric) // r = 2: σ_rr = -G cos z, σ_rz = ½ G r sin z
    tractions.push_back({"x+", {Expression("-cos(y)", {}), Expression("0.5*x*sin(y)", {}), std::nullopt}, {}});
  if (space == Space::Solid) // x = ½: σ_xx = 0, σ_xy = -π G s c, σ_xz = -π G c s in y and z
    tractions.push_back(
        {"x+", {0.0, Expression("-pi*sin(pi*y)*cos(pi*z)", {}), Expression("-pi*cos(pi*y)*sin(pi*z)", {})}, {}});
  LoadForm loads(layout, space, tractions, {force}, {});
  const Eigen::VectorXd u = solve_linear(layout, solid, loads, prescribed);
  return displacement_error(mesh, u, problem.displacement);
}

} // namespace

TEST_CASE("thick cylinder: displacements converge with the order of the element plus one") {
  const Case cases[] = {
      {ElementType::Triangle3, Space::PlaneStrain},       {ElementType::Triangle6, Space::PlaneStrain},
      {ElementType::Quadrilateral4, Space::PlaneStrain},  {ElementType::Quadrilateral9, Space::PlaneStrain},
      {ElementType::Triangle3, Space::PlaneStress},       {ElementType::Triangle6, Space::PlaneStress},
      {ElementType::Quadrilateral4, Space::PlaneStress},  {ElementType::Quadrilateral9, Space::PlaneStress},
      {ElementType::Triangle3, Space::Axisymmetric},      {ElementType::Triangle6, Space::Axisymmetric},
      {ElementType::Quadrilateral4, Space::Axisymmetric}, {ElementType::Quadrilateral9, Space::Axisymmetric},
      {ElementType::Tetrahedron4, Space::Solid},          {ElementType::Tetrahedron10, Space::Solid},
      {ElementType::Hexahedron8, Space::Solid},           {ElementType::Hexahedron27, Space::Solid}};
  for (const auto& [type, space] : cases) {
    CAPTURE(int(type));
    CAPTURE(int(space));
    const int order = element_order(type), n = order == 1 ? 6 : 3;
    const double coarse = cylinder_error(type, space, 0.3, n), fine = cylinder_error(type, space, 0.3, 2 * n);
    CHECK(fine < (order == 1 ? 1e-2 : 1e-3));
    CHECK(std::log2(coarse / fine) > order + 1 - 0.25);
  }
}

TEST_CASE("no locking at nu = 0.4999: the error of an isochoric solution is that of nu = 0.3") {
  const Case cases[] = {
      {ElementType::Quadrilateral4, Space::PlaneStrain},  {ElementType::Quadrilateral9, Space::PlaneStrain},
      {ElementType::Quadrilateral4, Space::Axisymmetric}, {ElementType::Quadrilateral9, Space::Axisymmetric},
      {ElementType::Hexahedron8, Space::Solid},           {ElementType::Hexahedron27, Space::Solid}};
  for (const auto& [type, space] : cases) {
    CAPTURE(int(type));
    CAPTURE(int(space));
    const int order = element_order(type), n = space == Space::Solid ? (order == 1 ? 6 : 3) : (order == 1 ? 12 : 6);
    const double compressible = isochoric_error(type, space, 0.3, n), nearly = isochoric_error(type, space, 0.4999, n);
    CHECK(nearly < 2 * compressible);
  }
}

TEST_CASE(
    "triangles and tetrahedra of order 2 do not lock: near incompressibility they still converge, an order lower") {
  const Case cases[] = {{ElementType::Triangle6, Space::PlaneStrain},
                        {ElementType::Triangle6, Space::Axisymmetric},
                        {ElementType::Tetrahedron10, Space::Solid}};
  for (const auto& [type, space] : cases) {
    CAPTURE(int(type));
    CAPTURE(int(space));
    const int n = space == Space::Solid ? 2 : 6;
    const double coarse = isochoric_error(type, space, 0.4999, n), fine = isochoric_error(type, space, 0.4999, 2 * n);
    CHECK(std::log2(coarse / fine) > 1.75);
  }
}

TEST_CASE("what locking looks like: the three-node triangle, which the tests above must be able to tell apart") {
  CHECK(isochoric_error(ElementType::Triangle3, Space::PlaneStrain, 0.4999, 12) >
        5 * isochoric_error(ElementType::Triangle3, Space::PlaneStrain, 0.3, 12));
}
