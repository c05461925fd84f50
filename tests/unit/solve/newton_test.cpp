// Newton's method on forms of its own: what counts as convergence.
#include "solve/newton.hpp"
#include "two_blocks.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

namespace {

/// Every displacement component for itself: F(u) = floor + steepness |u − 1|; for steepness 1 roots at 1 ± floor
/// for floor <= 0, none above.
class Valley : public Form {
 public:
  explicit Valley(const DofLayout& layout) : layout_(layout) {}
  double floor = 0.0, steepness = 1.0;

  const char* name() const override { return "valley"; }
  bool tangent_is_symmetric() const override { return false; } // so that backtracking is the line search
  void couple(Coupling& coupling) const override {
    for (std::int32_t node = 0; node < layout_.mesh().num_owned; ++node)
      coupling.add(equations(node));
  }
  void add_residual(const State& state, Residual& residual) override {
    for (std::int32_t i = 0; i < layout_.mesh().num_owned * 2; ++i)
      residual.nodal()[i] += floor + steepness * std::abs(state.displacement[i] - 1.0);
  }
  void add_tangent(const State& state, Tangent& tangent) override {
    for (std::int32_t node = 0; node < layout_.mesh().num_owned; ++node) {
      const auto slope = [&](std::int32_t i) { return state.displacement[i] < 1.0 ? -steepness : steepness; };
      const double block[] = {slope(2 * node), 0.0, 0.0, slope(2 * node + 1)};
      tangent.add(equations(node), block);
    }
  }

 private:
  std::array<PetscInt, 2> equations(std::int32_t node) const {
    return {layout_.equation(node, 0), layout_.equation(node, 1)};
  }
  const DofLayout& layout_;
};

} // namespace

// PETSc compares the last step that it noted with stol |u| when a line search gives up: after a solve that ended with a
// short step everything would count as converged.
TEST_CASE("a residual whose minimum is not zero is not taken for solved") {
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, 2, 2, 2, 0.0);
  const DofLayout layout(mesh, {}, {});
  std::vector<std::unique_ptr<Form>> forms;
  forms.push_back(std::make_unique<Valley>(layout));
  auto& valley = static_cast<Valley&>(*forms.front());
  Problem problem(layout, std::move(forms), {});
  choose_linear_solver(problem);
  Newton newton(problem, nullptr);
  const auto u = layout.new_vector();
  problem.begin_increment(1.0, u);
  valley.floor = -0.25;
  VecSet(u, 1.25 + 1e-9);
  const auto with_root = newton.solve(u);
  CHECK(with_root.converged);
  CHECK(with_root.newton == 1);
  valley.floor = 0.25;
  VecSet(u, 1.0);
  const auto without = newton.solve(u);
  CAPTURE(without.reason);
  CHECK_FALSE(without.converged);
  CHECK(without.residual > 0.1);
  for (const char* option : {"-pc_type", "-ksp_type", "-snes_linesearch_type"})
    PetscOptionsClearValue(nullptr, option);
}

// PETSc 3.18 would not make another factorization after one that failed: the next solve had none and ended the program.
TEST_CASE("a tangent that is singular spoils no later solve") {
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, 2, 2, 2, 0.0);
  const DofLayout layout(mesh, {}, {});
  std::vector<std::unique_ptr<Form>> forms;
  forms.push_back(std::make_unique<Valley>(layout));
  auto& valley = static_cast<Valley&>(*forms.front());
  Problem problem(layout, std::move(forms), {});
  choose_linear_solver(problem);
  Newton newton(problem, nullptr);
  const auto u = layout.new_vector();
  problem.begin_increment(1.0, u);
  valley.floor = 0.25;
  valley.steepness = 0.0;
  VecSet(u, 2.0);
  CHECK_FALSE(newton.solve(u).converged);
  valley.floor = -0.25;
  valley.steepness = 1.0;
  VecSet(u, 2.0);
  CHECK(newton.solve(u).converged);
  PetscReal largest = 0.0;
  VecMax(u, nullptr, &largest);
  CHECK(largest == doctest::Approx(1.25));
  for (const char* option : {"-pc_type", "-ksp_type", "-snes_linesearch_type"})
    PetscOptionsClearValue(nullptr, option);
}
