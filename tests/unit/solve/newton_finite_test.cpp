// Newton's method on bodies at finite strain: bodies moved along with their supports, states without a residual.
#include "form/finite_bulk.hpp"
#include "solve/newton.hpp"
#include "two_blocks.hpp"

#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

namespace {

/// Two rubber blocks held at their bottoms; the top of the lower one moves by `motion`, an expression of t.
struct Blocks {
  Mesh mesh;
  DofLayout layout;
  Problem problem;

  explicit Blocks(const std::string& motion)
      : mesh(two_blocks_mesh(PETSC_COMM_WORLD, 2, 6, 2, 1.0)), layout(mesh, {}, {}),
        problem(layout, forms(layout), supports(motion)) {}

  static std::vector<std::unique_ptr<Form>> forms(const DofLayout& layout) {
    std::vector<std::unique_ptr<Form>> result;
    const FiniteLaw rubber = NeoHookean{{10.0, 0.45}};
    result.push_back(std::make_unique<FiniteBulkForm>(layout, Space::PlaneStrain, std::vector{rubber, rubber}));
    return result;
  }
  static std::vector<PrescribedDisplacement> supports(const std::string& motion) {
    std::vector<PrescribedDisplacement> result;
    for (const char* group : {"bottom", "upper_bottom"})
      for (int c = 0; c < 2; ++c)
        result.push_back({group, c, Expression(0.0)});
    result.push_back({"lower_top", 1, Expression(motion, {})});
    return result;
  }
};

/// The increment to t = 1 from rest.
SolveOutcome solve_increment(Blocks& blocks, Vec u) {
  choose_linear_solver(blocks.problem);
  Newton newton(blocks.problem, nullptr);
  blocks.problem.begin_increment(1.0, u);
  return newton.solve(u);
}

} // namespace

TEST_CASE("the load of a prediction is the change of the residual with the motion of the supports") {
  Blocks blocks("0.1*t*(1+x)");
  auto& problem = blocks.problem;
  MatHandle matrix = problem.new_matrix();
  const auto u = blocks.layout.new_vector(), start = blocks.layout.new_vector(), load = blocks.layout.new_vector(),
             moved = blocks.layout.new_vector(), up = blocks.layout.new_vector(), down = blocks.layout.new_vector();
  {
    VecArray values(u); // some state that is not at rest, zero at the supports
    for (PetscInt i = 0; i < values.size(); ++i)
      if (!problem.is_prescribed(blocks.layout.first_equation() + i))
        values[i] = 0.02 * std::sin(1.0 + 3.0 * double(blocks.layout.first_equation() + i));
  }
  VecCopy(u, start);
  problem.begin_increment(1.0, u);
  REQUIRE(problem.wants_prediction());
  VecWAXPY(moved, -1.0, start, u); // the motion Δ
  REQUIRE(problem.begin_prediction(u, matrix, load));
  CHECK_FALSE(problem.wants_prediction());
  VecAXPY(start, -1.0, u);
  double norm = 0.0;
  VecNorm(start, NORM_2, &norm);
  CHECK(norm < 1e-14); // back at the start
  const double h = 1e-5;
  VecWAXPY(start, h, moved, u);
  REQUIRE(problem.residual(start, up));
  VecWAXPY(start, -h, moved, u);
  REQUIRE(problem.residual(start, down));
  VecAXPY(up, -1.0, down);
  VecScale(up, 0.5 / h);
  REQUIRE(problem.residual(u, down));
  VecAXPY(up, 1.0, down); // r + K Δ
  double size = 0.0, residual_size = 0.0;
  VecNorm(load, NORM_2, &size);
  VecNorm(down, NORM_2, &residual_size);
  CHECK(size > 1.2 * residual_size);
  VecAXPY(up, -1.0, load);
  VecNorm(up, NORM_2, &norm);
  CHECK(norm < 1e-8 * size);
}

TEST_CASE("supports may move further than a cell in one increment") {
  Blocks blocks("-0.25*t"); // cells are 1/6 high
  const auto u = blocks.layout.new_vector();
  const auto outcome = solve_increment(blocks, u);
  CAPTURE(outcome.reason);
  CHECK(outcome.converged);
  CHECK(outcome.newton <= 8);
  CHECK(blocks.problem.stored_energy(u) > 0.1);
}

TEST_CASE("a body turned inside out is an outcome with the reason, the same on every rank") {
  Blocks blocks("-1.5*t");
  const auto u = blocks.layout.new_vector();
  const auto outcome = solve_increment(blocks, u);
  CHECK_FALSE(outcome.converged);
  CHECK(outcome.reason == "in body 'lower' det F is not positive");
  // And the problem goes on from where it was.
  blocks.problem.roll_back();
  VecSet(u, 0.0);
  const auto force = blocks.layout.new_vector();
  CHECK(blocks.problem.residual(u, force));
  CHECK(blocks.problem.failure().empty());
  for (const char* option : {"-pc_type", "-ksp_type", "-snes_linesearch_type"})
    PetscOptionsClearValue(nullptr, option);
}
