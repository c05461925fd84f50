// Newton's method on forms of its own: what counts as convergence.
#include "solve/newton.hpp"
#include "solver_support.hpp"
#include "two_blocks.hpp"

#include <cmath>
#include <doctest/doctest.h>
#include <functional>
#include <optional>

using namespace amontons;
using namespace amontons::test;

namespace {

/// Every displacement component for itself, by the same function of one variable.
class Pointwise : public Form {
 public:
  using Function = std::function<double(double)>;
  Pointwise(const DofLayout& layout, Function value, Function slope)
      : layout_(layout), value_(std::move(value)), slope_(std::move(slope)) {}

  const char* name() const override { return "pointwise"; }
  bool tangent_is_symmetric() const override { return false; } // so that backtracking is the line search
  void couple(Coupling& coupling) const override {
    for (std::int32_t node = 0; node < layout_.mesh().num_owned; ++node)
      coupling.add(equations(node));
  }
  void add_residual(const State& state, Residual& residual) override {
    for (std::int32_t i = 0; i < layout_.mesh().num_owned * 2; ++i)
      residual.nodal()[i] += value_(state.displacement[i]);
  }
  void add_tangent(const State& state, Tangent& tangent) override {
    for (std::int32_t node = 0; node < layout_.mesh().num_owned; ++node) {
      const auto slope = [&](std::int32_t i) { return slope_(state.displacement[i]); };
      const double block[] = {slope(2 * node), 0.0, 0.0, slope(2 * node + 1)};
      tangent.add(equations(node), block);
    }
  }

 private:
  std::array<PetscInt, 2> equations(std::int32_t node) const {
    return {layout_.equation(node, 0), layout_.equation(node, 1)};
  }
  const DofLayout& layout_;
  Function value_, slope_;
};

/// Newton's method on value(u) = load, with the default solver.
struct PointwiseProblem {
  PointwiseProblem(Pointwise::Function value, Pointwise::Function slope, double load)
      : mesh(two_blocks_mesh(PETSC_COMM_WORLD, 2, 2, 2, 0.0)), layout(mesh, {}, {}),
        problem(layout, forms(layout, std::move(value), std::move(slope), load), {}), unknowns(layout.new_vector()) {
    choose_linear_solver(problem);
    newton.emplace(problem, nullptr);
    problem.begin_increment(1.0, unknowns);
  }
  ~PointwiseProblem() {
    for (const char* option : {"-pc_type", "-ksp_type", "-snes_linesearch_type"})
      PetscOptionsClearValue(nullptr, option);
  }
  SolveOutcome solve_from(double start) {
    VecSet(unknowns, start);
    return newton->solve(unknowns);
  }

  static std::vector<std::unique_ptr<Form>> forms(const DofLayout& layout, Pointwise::Function value,
                                                  Pointwise::Function slope, double load) {
    std::vector<std::unique_ptr<Form>> forms;
    forms.push_back(std::make_unique<Pointwise>(layout, std::move(value), std::move(slope)));
    const auto none = [](double) { return 0.0; };
    forms.push_back(std::make_unique<Pointwise>(
        layout, [load](double) { return -load; }, none));
    return forms;
  }
  const Mesh mesh;
  const DofLayout layout;
  Problem problem;
  VecHandle unknowns;
  std::optional<Newton> newton;
};

} // namespace

// PETSc compares the last step that it noted with stol |u| when a line search gives up: after a solve that ended with a
// short step everything would count as converged.
TEST_CASE("defaults of a solver are taken back, what the user has set is not") {
  const OptionScope scope;
  const auto is_set = [](const char* name) {
    PetscBool present = PETSC_FALSE;
    PetscOptionsHasName(nullptr, nullptr, name, &present);
    return present == PETSC_TRUE;
  };
  forget_default_options();
  PetscOptionsSetValue(nullptr, "-snes_rtol", "1e-7");
  {
    const PointwiseProblem any([](double u) { return u; }, [](double) { return 1.0; }, 0.0);
    CHECK(is_set("-pc_type"));
    forget_default_options();
    CHECK(!is_set("-pc_type"));
  }
  CHECK(is_set("-snes_rtol"));
}

TEST_CASE("a residual whose minimum is not zero is not taken for solved") {
  double floor = -0.25; // roots at 1 ± floor for floor <= 0, none above
  PointwiseProblem valley([&](double u) { return floor + std::abs(u - 1.0); },
                          [](double u) { return u < 1.0 ? -1.0 : 1.0; }, 0.0);
  const auto with_root = valley.solve_from(1.25 + 1e-9);
  CHECK(with_root.converged);
  CHECK(with_root.newton == 1);
  floor = 0.25;
  const auto without = valley.solve_from(1.0);
  CAPTURE(without.reason);
  CHECK_FALSE(without.converged);
  CHECK(without.residual > 0.1);
}

// u³ = 1 from 3 by Newton's method: residuals 26, 7.4, 2.0, 0.40, ...
TEST_CASE("a loop around may ask for a part of the way") {
  PointwiseProblem cube([](double u) { return u * u * u; }, [](double u) { return 3.0 * u * u; }, 1.0);
  const auto whole = cube.solve_from(3.0);
  CHECK(whole.converged);
  CHECK(whole.residual < 1e-10);
  for (const auto& [reduction, iterations] : {std::pair{0.5, 1}, {0.1, 2}, {0.05, 3}}) {
    cube.newton->set_reduction(reduction);
    const auto part = cube.solve_from(3.0);
    CHECK(part.converged);
    CHECK(part.newton == iterations);
    cube.newton->set_reduction(0.0);
    const auto rest = cube.newton->solve(cube.unknowns);
    CHECK(part.newton + rest.newton == whole.newton);
    CHECK(rest.residual == doctest::Approx(whole.residual));
  }
}

// PETSc 3.18 would not make another factorization after one that failed: the next solve had none and ended the program.
TEST_CASE("a tangent that is singular spoils no later solve") {
  double floor = 0.25, steepness = 0.0;
  PointwiseProblem valley([&](double u) { return floor + steepness * std::abs(u - 1.0); },
                          [&](double u) { return u < 1.0 ? -steepness : steepness; }, 0.0);
  CHECK_FALSE(valley.solve_from(2.0).converged);
  floor = -0.25;
  steepness = 1.0;
  CHECK(valley.solve_from(2.0).converged);
  PetscReal largest = 0.0;
  VecMax(valley.unknowns, nullptr, &largest);
  CHECK(largest == doctest::Approx(1.25));
}
