// Cell bubbles under body force: their loads, their part in equilibrium, stress and energy.
#include "dense_system.hpp"
#include "form/bulk.hpp"
#include "form/loads.hpp"
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
constexpr Case cases[] = {{ElementType::Triangle6, Space::PlaneStrain},
                          {ElementType::Triangle6, Space::Axisymmetric},
                          {ElementType::Tetrahedron10, Space::Solid}};

/// A box at x > 0 with straight sides and no pattern.
Mesh rough_mesh(ElementType type) {
  Mesh mesh = box_mesh(PETSC_COMM_SELF, type, {2, 2, 2}, [](auto p) {
    return std::array<double, 3>{0.5 + p[0] + 0.2 * p[1], p[1], p[2]};
  });
  roughen(mesh, 0.05);
  return mesh;
}

std::map<Eigen::Index, double> on_boundary(const Mesh& mesh, const Field& value) {
  std::map<Eigen::Index, double> prescribed;
  for (const auto& [group, nodes] : mesh.node_groups)
    for (const auto node : nodes)
      for (int i = 0; i < mesh.dim; ++i)
        prescribed[node * mesh.dim + i] = value(mesh.position(node))[i];
  return prescribed;
}

/// A quadratic displacement, the constant body force that it needs, and its strain.
struct Quadratic {
  Field displacement;
  std::array<double, 3> force;
  std::function<std::vector<double>(std::span<const double>)> strain;
};

/// With f = -G Δu - (λ + G) ∇ div u; axisymmetric: σ_rr = (4 G + 3 λ) r and σ_θθ = (2 G + 3 λ) r of u_r = r² need
/// f_r = -(6 G + 3 λ).
Quadratic quadratic(Space space, const Lame& lame) {
  const double G = lame.G, both = lame.lambda + lame.G;
  if (space == Space::Axisymmetric)
    return {[](auto x) {
              return std::array<double, 3>{x[0] * x[0], 0, 0};
            },
            {-6 * G - 3 * lame.lambda, 0, 0},
            [](auto x) {
              return std::vector<double>{2 * x[0], 0, x[0], 0};
            }};
  if (space == Space::PlaneStrain) // Δu = (0, -1), div u = 5 x + 2 y
    return {[](auto x) {
              return std::array<double, 3>{x[0] * x[0] + 2 * x[0] * x[1] - x[1] * x[1],
                                           3 * x[0] * x[1] - 0.5 * x[0] * x[0], 0};
            },
            {-5 * both, G - 2 * both, 0},
            [](auto x) {
              return std::vector<double>{2 * x[0] + 2 * x[1], 3 * x[0], 0, x[0] + x[1]};
            }};
  // Δu = (2, -1, 2), div u = 6 x + 2 y + z
  return {[](auto x) {
            return std::array<double, 3>{x[0] * x[0] + 2 * x[0] * x[1] - x[1] * x[1] + x[2] * x[2],
                                         3 * x[0] * x[1] - 0.5 * x[0] * x[0] + x[1] * x[2], x[0] * x[2] + x[1] * x[1]};
          },
          {-2 * G - 6 * both, G - 2 * both, -2 * G - both},
          [](auto x) {
            return std::vector<double>{2 * x[0] + 2 * x[1], 3 * x[0] + x[2], x[0], x[0] + x[1], 3 * x[1], 3 * x[2]};
          }};
}

} // namespace

TEST_CASE("a quadratic displacement under its body force is found exactly, with the bubbles at rest") {
  for (const auto& [type, space] : cases) {
    CAPTURE(int(type));
    CAPTURE(int(space));
    const Quadratic problem = quadratic(space, lame_constants(soft, space));
    const Mesh mesh = rough_mesh(type);
    const DofLayout layout(mesh, {}, {});
    const BodyLoad load{"block", {problem.force[0], problem.force[1], std::nullopt}};
    BodyLoad body = load;
    if (space == Space::Solid) body.force[2] = problem.force[2];
    BulkForm solid(layout, space, {soft}, {body});
    LoadForm loads(layout, space, {}, {body}, {});
    const Eigen::VectorXd u = solve_linear(layout, solid, loads, on_boundary(mesh, problem.displacement));
    const Eigen::VectorXd exact = nodal_values(mesh, problem.displacement);
    REQUIRE(exact.norm() > 1);
    CHECK((u - exact).norm() < 1e-12 * exact.norm());
    const LoadedBubbles bubbles = solid.loaded_bubbles(state_of(u));
    REQUIRE(bubbles.displacements.size() == std::size_t(mesh.blocks[0].size()) * mesh.dim);
    REQUIRE(std::abs(bubbles.forces[0]) > 1e-3);
    for (const double displacement : bubbles.displacements)
      CHECK(std::abs(displacement) < 1e-12);
    double error = 0, largest = 0;
    solid.for_each_batch(state_of(u), [&](const PointBatch& batch) {
      const std::size_t size = batch.strain.size() / batch.weights.size();
      const auto points = static_cast<std::size_t>(batch.table->rule->size());
      for (std::size_t p = 0; p < batch.weights.size(); ++p) {
        std::array<double, 3> x{};
        const auto nodes = batch.block->cell(batch.first_cell + static_cast<std::int32_t>(p / points));
        for (std::size_t a = 0; a < nodes.size(); ++a)
          for (int i = 0; i < mesh.dim; ++i)
            x[i] += batch.table->value(static_cast<int>(p % points))[a] * mesh.position(nodes[a])[i];
        const auto wanted = problem.strain(x);
        for (std::size_t i = 0; i < size; ++i) {
          error = std::max(error, std::abs(batch.strain[p * size + i] - wanted[i]));
          largest = std::max(largest, std::abs(wanted[i]));
        }
      }
    });
    CHECK(largest > 1);
    CHECK(error < 1e-11);
  }
}

TEST_CASE("work of a body force on nodes and bubbles is twice the energy, and follows the force in time") {
  for (const auto& [type, space] : cases) {
    CAPTURE(int(type));
    CAPTURE(int(space));
    const Mesh mesh = rough_mesh(type);
    const DofLayout layout(mesh, {}, {});
    const BodyLoad load{"block", {Expression("(1+t)*exp(2*x)", {}), Expression("(1+t)*y", {}), std::nullopt}};
    BulkForm solid(layout, space, {soft}, {load});
    LoadForm loads(layout, space, {}, {load}, {});
    const auto fixed = on_boundary(mesh, [](auto) { return std::array<double, 3>{}; });
    const Eigen::VectorXd u = solve_linear(layout, solid, loads, fixed);
    const LoadedBubbles bubbles = solid.loaded_bubbles(state_of(u));
    const auto& nodal = loads.nodal_forces(0);
    double nodes_work = 0, bubble_work = 0;
    for (std::size_t i = 0; i < nodal.size(); ++i)
      nodes_work += nodal[i] * u[Eigen::Index(i)];
    for (std::size_t i = 0; i < bubbles.forces.size(); ++i)
      bubble_work += bubbles.forces[i] * bubbles.displacements[i];
    CHECK(std::abs(bubble_work) > 1e-3 * nodes_work);
    CHECK(nodes_work + bubble_work == doctest::Approx(2 * solid.stored_energy(state_of(u))).epsilon(1e-12));
    const auto later = solid.loaded_bubbles(state_of(u, 1.0)).forces;
    for (std::size_t i = 0; i < later.size(); ++i)
      CHECK(later[i] == doctest::Approx(2 * bubbles.forces[i]));
  }
}

TEST_CASE("plane stress has no bubbles, and other elements have none") {
  const BodyLoad load{"block", {1.0, 2.0, std::nullopt}};
  for (const auto& [type, space] :
       {Case{ElementType::Triangle6, Space::PlaneStress}, Case{ElementType::Triangle3, Space::PlaneStrain},
        Case{ElementType::Quadrilateral9, Space::PlaneStrain}}) {
    const Mesh mesh = rough_mesh(type);
    const DofLayout layout(mesh, {}, {});
    BulkForm solid(layout, space, {soft}, {load});
    CHECK(solid.loaded_bubbles(state_of(Eigen::VectorXd::Zero(layout.num_global()))).forces.empty());
  }
}
