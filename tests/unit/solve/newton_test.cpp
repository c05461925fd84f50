// Newton's method on forms of its own: what counts as convergence.
#include "solve/newton.hpp"
#include "two_blocks.hpp"

#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

namespace {

/// Every displacement component for itself: F(u) = floor + (u − 1)², no root for floor > 0, and a root at 1 −
/// sqrt(−floor) for floor < 0.
class Bowl : public Form {
 public:
  Bowl(const DofLayout& layout, double floor) : layout_(layout), floor_(floor) {}
  const char* name() const override { return "bowl"; }
  bool tangent_is_symmetric() const override { return false; } // so that backtracking is the line search
  void couple(Coupling& coupling) const override {
    for (std::int32_t node = 0; node < layout_.mesh().num_owned; ++node)
      coupling.add(equations(node));
  }
  void add_residual(const State& state, Residual& residual) override {
    for (std::int32_t i = 0; i < layout_.mesh().num_owned * 2; ++i)
      residual.nodal()[i] += floor_ + (state.displacement[i] - 1.0) * (state.displacement[i] - 1.0);
  }
  void add_tangent(const State& state, Tangent& tangent) override {
    for (std::int32_t node = 0; node < layout_.mesh().num_owned; ++node) {
      const double slope[] = {2.0 * (state.displacement[2 * node] - 1.0),
                              2.0 * (state.displacement[2 * node + 1] - 1.0)};
      const double block[] = {slope[0], 0.0, 0.0, slope[1]};
      tangent.add(equations(node), block);
    }
  }

 private:
  std::array<PetscInt, 2> equations(std::int32_t node) const {
    return {layout_.equation(node, 0), layout_.equation(node, 1)};
  }
  const DofLayout& layout_;
  double floor_;
};

SolveOutcome solve_bowl(double floor) {
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, 2, 2, 2, 0.0);
  const DofLayout layout(mesh, {}, {});
  std::vector<std::unique_ptr<Form>> forms;
  forms.push_back(std::make_unique<Bowl>(layout, floor));
  Problem problem(layout, std::move(forms), {});
  choose_linear_solver(problem);
  Newton newton(problem, nullptr);
  const auto u = layout.new_vector();
  VecSet(u, -0.7);
  problem.begin_increment(1.0, u);
  const auto outcome = newton.solve(u);
  for (const char* option : {"-pc_type", "-ksp_type", "-snes_linesearch_type"})
    PetscOptionsClearValue(nullptr, option);
  return outcome;
}

} // namespace

TEST_CASE("a residual with a root is solved, one whose minimum is not zero is not taken for solved") {
  const auto with_root = solve_bowl(-0.25);
  CHECK(with_root.converged);
  CHECK(with_root.residual < 1e-9);
  const auto without = solve_bowl(0.25);
  CHECK_FALSE(without.converged);
  CHECK(without.residual > 0.1);
}
