// Whole elastic problems with closed-form solutions: orders of convergence, and no locking near incompressibility.
#include "dense_system.hpp"
#include "form/bulk.hpp"
#include "form/loads.hpp"
#include "material/elastic.hpp"
#include "mesh/build.hpp"

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
  BulkForm solid(layout, space, {material});
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

/// 2 G ε of a displacement without change of volume, by central differences.
std::vector<double> isochoric_stress(Space space, const Field& displacement, double G, std::array<double, 3> x) {
  const double h = 1e-5;
  Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
  for (int j = 0; j < space_dim(space); ++j) {
    auto after = x, before = x;
    after[j] += h;
    before[j] -= h;
    const auto u = displacement(after), v = displacement(before);
    for (int i = 0; i < 3; ++i)
      gradient(i, j) = (u[i] - v[i]) / (2 * h);
  }
  if (space == Space::Axisymmetric) gradient(2, 2) = displacement(x)[0] / x[0];
  const Eigen::Matrix3d s = G * (gradient + gradient.transpose());
  if (space_dim(space) == 2) return {s(0, 0), s(1, 1), s(2, 2), s(0, 1)};
  return {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0)};
}

/// Errors of an isochoric solution, in the displacement (L2), in the energy norm, sqrt(∫ Δσ : C⁻¹ : Δσ), and in the
/// pressure (L2), which the energy norm hardly sees near incompressibility.
struct Errors {
  double displacement, energy, pressure;
};

Errors stress_errors(BulkForm& solid, const Mesh& mesh, const Eigen::VectorXd& u, const Field& exact,
                     const Lame& lame) {
  const double bulk = lame.lambda + 2 * lame.G / 3;
  Errors sums{};
  solid.for_each_batch(state_of(u), [&](const PointBatch& batch) {
    const std::size_t size = batch.stress.size() / batch.weights.size();
    const auto points = static_cast<std::size_t>(batch.table->rule->size());
    for (std::size_t p = 0; p < batch.weights.size(); ++p) {
      std::array<double, 3> x{};
      const auto nodes = batch.block->cell(batch.first_cell + static_cast<std::int32_t>(p / points));
      for (std::size_t a = 0; a < nodes.size(); ++a)
        for (int i = 0; i < mesh.dim; ++i)
          x[i] += batch.table->value(static_cast<int>(p % points))[a] * mesh.position(nodes[a])[i];
      auto difference = isochoric_stress(solid.space(), exact, lame.G, x);
      for (std::size_t i = 0; i < size; ++i)
        difference[i] -= batch.stress[p * size + i];
      const double mean = (difference[0] + difference[1] + difference[2]) / 3;
      double deviator = 0;
      for (std::size_t i = 0; i < size; ++i)
        deviator += i < 3 ? std::pow(difference[i] - mean, 2) : 2 * difference[i] * difference[i];
      sums.energy += batch.weights[p] * (deviator / (2 * lame.G) + mean * mean / bulk);
      sums.pressure += batch.weights[p] * mean * mean;
    }
  });
  return {0, std::sqrt(sums.energy), std::sqrt(sums.pressure)};
}

/// A box of n cells a direction; tetrahedra without the pattern of cubes cut into six.
Mesh isochoric_mesh(ElementType type, Space space, int n) {
  Mesh mesh = box_mesh(PETSC_COMM_SELF, type, {n, n, n}, [space](auto p) -> std::array<double, 3> {
    if (space == Space::Axisymmetric) return {1 + p[0], p[1], 0};
    if (space == Space::Solid) return {0.5 * p[0], 0.5 * p[1], 0.5 * p[2]};
    return p;
  });
  if (type == ElementType::Tetrahedron10) roughen(mesh, 0.1 / n);
  return mesh;
}

Errors isochoric_errors(const Mesh& mesh, Space space, double nu) {
  const double G = 1.0;
  const Elastic material{2 * G * (1 + nu), nu};
  const Isochoric problem = isochoric(space);
  const DofLayout layout(mesh, {}, {});
  BodyLoad force{"block", {}};
  for (int i = 0; i < mesh.dim; ++i)
    force.force[i] = Expression(problem.force[i], {});
  BulkForm solid(layout, space, {material}, {force});
  std::map<Eigen::Index, double> prescribed;
  for (const auto& [group, nodes] : mesh.node_groups)
    if (mesh.surfaces.contains(group) && (space == Space::PlaneStrain || group != "x+"))
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
  Errors errors = stress_errors(solid, mesh, u, problem.displacement, lame_constants(material, space));
  errors.displacement = displacement_error(mesh, u, problem.displacement);
  return errors;
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

TEST_CASE("no locking at nu = 0.4999: the errors of an isochoric solution are those of nu = 0.3") {
  const Case cases[] = {
      {ElementType::Triangle6, Space::PlaneStrain},       {ElementType::Triangle6, Space::Axisymmetric},
      {ElementType::Quadrilateral4, Space::PlaneStrain},  {ElementType::Quadrilateral9, Space::PlaneStrain},
      {ElementType::Quadrilateral4, Space::Axisymmetric}, {ElementType::Quadrilateral9, Space::Axisymmetric},
      {ElementType::Hexahedron8, Space::Solid},           {ElementType::Hexahedron27, Space::Solid}};
  for (const auto& [type, space] : cases) {
    CAPTURE(int(type));
    CAPTURE(int(space));
    const int order = element_order(type), n = space == Space::Solid ? 2 : 8;
    const Mesh coarse_mesh = isochoric_mesh(type, space, n), fine_mesh = isochoric_mesh(type, space, 3 * n / 2);
    const Errors compressible = isochoric_errors(fine_mesh, space, 0.3);
    const Errors coarse = isochoric_errors(coarse_mesh, space, 0.4999),
                 fine = isochoric_errors(fine_mesh, space, 0.4999);
    CHECK(fine.displacement < 2 * compressible.displacement);
    CHECK(fine.energy < 2 * compressible.energy);
    CHECK(fine.pressure < 6 * compressible.pressure); // six-node triangles without their bubble: a thousand times
    CHECK(std::log(coarse.displacement / fine.displacement) / std::log(1.5) > order + 1 - 0.25);
    CHECK(std::log(coarse.energy / fine.energy) / std::log(1.5) > order - 0.25);
    CHECK(std::log(coarse.pressure / fine.pressure) / std::log(1.5) > order - 0.25);
  }
}

TEST_CASE("no locking of tetrahedra of order 2 on an unstructured mesh") {
  const MeshSource source{AMONTONS_SOURCE_DIR "/tests/unit/form/cube.geo", {{"h", 0.16}}, 2};
  const Mesh mesh = distribute_mesh(PETSC_COMM_SELF, read_mesh(source), {}, 0);
  REQUIRE(mesh.blocks[0].size() > 250);
  const Errors compressible = isochoric_errors(mesh, Space::Solid, 0.3);
  const Errors nearly = isochoric_errors(mesh, Space::Solid, 0.4999);
  CHECK(nearly.displacement < 2 * compressible.displacement);
  CHECK(nearly.energy < 2 * compressible.energy);
}

TEST_CASE("tetrahedra of order 2 near incompressibility keep their order on cubes cut into six that are not regular") {
  const Errors coarse =
      isochoric_errors(isochoric_mesh(ElementType::Tetrahedron10, Space::Solid, 2), Space::Solid, 0.4999);
  const Errors fine =
      isochoric_errors(isochoric_mesh(ElementType::Tetrahedron10, Space::Solid, 4), Space::Solid, 0.4999);
  CHECK(std::log2(coarse.displacement / fine.displacement) > 2.75);
  CHECK(std::log2(coarse.energy / fine.energy) > 1.75);
}

/// Cook's membrane in plane strain: the panel (0, 0), (48, 44), (48, 60), (0, 44), clamped on the left, sheared by a
/// total of 100 on the right, E = 240.565, nu = 0.4999. Rise of the upper corner.
double cook_rise(ElementType type, int n) {
  const Space space = Space::PlaneStrain;
  const Mesh mesh = box_mesh(PETSC_COMM_SELF, type, {n, n, 1}, [](auto p) -> std::array<double, 3> {
    return {48 * p[0], 44 * p[0] + p[1] * (44 - 28 * p[0]), 0};
  });
  const DofLayout layout(mesh, {}, {});
  BulkForm solid(layout, space, {Elastic{240.565, 0.4999}});
  LoadForm loads(layout, space, {{"x+", {std::nullopt, 100.0 / 16, std::nullopt}, {}}}, {}, {});
  std::map<Eigen::Index, double> prescribed;
  const Field none = [](auto) { return std::array<double, 3>{}; };
  prescribe(prescribed, mesh, "x-", 0, none);
  prescribe(prescribed, mesh, "x-", 1, none);
  const Eigen::VectorXd u = solve_linear(layout, solid, loads, prescribed);
  for (const auto node : mesh.node_groups.at("x+"))
    if (mesh.position(node)[1] > 60 - 1e-9) return u[2 * node + 1];
  return 0;
}

TEST_CASE("Cook's membrane at nu = 0.4999: triangles and quadrilaterals agree, but for triangles of order 1") {
  const double rise = cook_rise(ElementType::Quadrilateral9, 8);
  CHECK(rise > 1);
  CHECK(cook_rise(ElementType::Triangle6, 8) == doctest::Approx(rise).epsilon(0.02));
  CHECK(cook_rise(ElementType::Quadrilateral4, 16) == doctest::Approx(rise).epsilon(0.02));
  CHECK(cook_rise(ElementType::Triangle3, 16) < 0.5 * rise);
}

TEST_CASE("what locking looks like: the three-node triangle, which the test above must be able to tell apart") {
  const Mesh mesh = isochoric_mesh(ElementType::Triangle3, Space::PlaneStrain, 12);
  const Errors nearly = isochoric_errors(mesh, Space::PlaneStrain, 0.4999);
  const Errors compressible = isochoric_errors(mesh, Space::PlaneStrain, 0.3);
  CHECK(nearly.displacement > 5 * compressible.displacement);
}
