// The estimated error of figures against their true error: a block between two planes of symmetry, pressed by an uneven
// load from above; the figures are the work of the load and a weighted mean of the motion of the side. No closed form:
// the truth is the value on a fine mesh of order 2, whose error by the order of convergence is far below those looked
// at.
#include "../form/dense_system.hpp"
#include "accuracy/goal_error.hpp"
#include "form/bulk.hpp"
#include "form/loads.hpp"
#include "material/elastic.hpp"

#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::testing;

namespace {

const Elastic material{100.0, 0.3};

const ElementType types[] = {ElementType::Triangle3, ElementType::Quadrilateral4, ElementType::Triangle6,
                             ElementType::Quadrilateral9};

/// The work of the load and the motion of the side.
struct Figures {
  double work, motion;
  GoalError work_error, motion_error;
};

Figures figures(ElementType type, int n) {
  const Mesh mesh = enclosed(box_mesh(PETSC_COMM_SELF, type, {n, n, n}, [](auto p) { return p; }));
  const DofLayout layout(mesh, {}, {});
  BulkForm solid(layout, Space::PlaneStrain, {material});
  // Even about the planes of symmetry, and nothing at the free corner: both fields are smooth.
  const SurfaceLoad above{"y+", {std::nullopt, Expression("-(1-x^2)^2", {}), std::nullopt}, {}};
  const SurfaceLoad beside{"x+", {Expression("(1-y^2)^2", {}), std::nullopt, std::nullopt}, {}};
  LoadForm load(layout, Space::PlaneStrain, {above}, {}, {}), weight(layout, Space::PlaneStrain, {beside}, {}, {});
  std::map<Eigen::Index, double> prescribed;
  for (const auto node : mesh.node_groups.at("x-"))
    prescribed[node * 2] = 0.0;
  for (const auto node : mesh.node_groups.at("y-"))
    prescribed[node * 2 + 1] = 0.0;
  const Eigen::VectorXd u = solve_linear(layout, solid, load, prescribed);
  const Eigen::VectorXd z = solve_linear(layout, solid, weight, prescribed);
  const std::vector<std::vector<double>> influences = {{u.begin(), u.end()}, {z.begin(), z.end()}};
  const auto errors = estimate_goal_errors(solid, mesh, state_of(u), influences);
  return {-residual_of(layout, load, u).dot(u), -residual_of(layout, weight, u).dot(u), errors[0], errors[1]};
}

} // namespace

TEST_CASE(
    "error of a figure: of the work of the load, half to twice the true one, with twice the order of the element") {
  const double truth = figures(ElementType::Quadrilateral9, 12).work;
  for (const auto type : types) {
    CAPTURE(int(type));
    const int order = element_order(type), n = order == 1 ? 6 : 4;
    const Figures coarse = figures(type, n), fine = figures(type, 2 * n);
    const double effectivity = coarse.work_error.error / (truth - coarse.work);
    CAPTURE(effectivity);
    CHECK(std::abs(truth - coarse.work) > 1e-5 * truth);
    // On even meshes the work of these converges faster than the rest: what is estimated is above it.
    if (type == ElementType::Quadrilateral9)
      CHECK(coarse.work_error.bound > std::abs(truth - coarse.work));
    else {
      CHECK(effectivity > 0.5);
      CHECK(effectivity < 2.0);
    }
    CHECK(std::log2(coarse.work_error.error / fine.work_error.error) > 2 * order - 0.7);
  }
}

TEST_CASE("error of a figure: without cancelling not below half of the true one, and the sum of its cells") {
  const double truth = figures(ElementType::Quadrilateral9, 12).motion;
  for (const auto type : types) {
    CAPTURE(int(type));
    const int order = element_order(type), n = order == 1 ? 6 : 4;
    const Figures coarse = figures(type, n), fine = figures(type, 2 * n);
    const auto& error = coarse.motion_error;
    CHECK(std::abs(truth - coarse.motion) > 1e-8 * truth);
    CHECK(error.bound > 0.5 * std::abs(truth - coarse.motion));
    CHECK(error.bound < 0.05 * truth);
    CHECK(error.bound >= std::abs(error.error));
    CHECK(std::log2(error.bound / fine.motion_error.bound) > 2 * order - 0.7);
    double sum = 0.0;
    for (const double part : error.cells)
      sum += part;
    CHECK(sum == doctest::Approx(error.bound));
  }
}
