// Each rung of the ladder by itself, on a problem that Newton's method does not solve and that the rung does.
#include "solve/ladder.hpp"

#include "form/viscous.hpp"
#include "made_up_forms.hpp"
#include "solve/newton.hpp"
#include "two_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

namespace {

/// Options for a test and what they were before.
class FullSteps {
 public:
  FullSteps() { PetscOptionsSetValue(nullptr, "-snes_linesearch_type", "basic"); }
  ~FullSteps() {
    for (const char* option : {"-pc_type", "-ksp_type", "-snes_linesearch_type"})
      PetscOptionsClearValue(nullptr, option);
  }
};

/// One form on a mesh of two blocks, with Newton's method and the ladder around it.
struct Case {
  FullSteps options;
  Mesh mesh;
  DofLayout layout;
  Problem problem;
  VecHandle u;
  std::vector<double> start; // of the components of each node
  std::string log;
  Newton newton;
  Ladder ladder;

  Case(int dim, std::vector<double> from, const std::function<std::unique_ptr<Form>(const DofLayout&)>& make,
       double weight = 0.0, const std::function<SolveOutcome()>& loop = nullptr)
      : mesh(two_blocks_mesh(PETSC_COMM_WORLD, dim, 1, 1, 0.5)), layout(mesh, {}, {}),
        problem(layout, forms(layout, make, weight), {}), u(layout.new_vector()), start(std::move(from)),
        newton((choose_linear_solver(problem), problem), nullptr),
        ladder(problem, newton,
               {.restart = [this] { restart(); },
                .solve = [this] { return newton.solve(u); },
                .loop = loop,
                .make_support =
                    [this](double ratio) {
                      auto support = std::make_unique<ViscousForm>(layout, dim_space(), std::vector<double>{10.0, 10.0},
                                                                   ratio, 1.0);
                      const auto accepted = layout.new_vector();
                      put_start(accepted);
                      auto state = problem.state_at(accepted);
                      state.time = 0.0;
                      support->commit(state);
                      return support;
                    },
                .tell = [this](const std::string& line) { log += line + "\n"; }}) {}

  Space dim_space() const { return mesh.dim == 2 ? Space::PlaneStrain : Space::Solid; }
  static std::vector<std::unique_ptr<Form>>
  forms(const DofLayout& layout, const std::function<std::unique_ptr<Form>(const DofLayout&)>& make, double weight) {
    std::vector<std::unique_ptr<Form>> all;
    all.push_back(make(layout));
    all.push_back(std::make_unique<Scalar>(
        layout, [weight](double) { return weight; }, [](double) { return 0.0; }));
    return all;
  }
  void put_start(Vec to) const {
    VecArray values(to);
    for (PetscInt i = 0; i < values.size(); ++i)
      values[i] = start[i % mesh.dim];
  }
  void restart() {
    put_start(u);
    problem.roll_back();
    problem.begin_increment(1.0, u);
  }
  SolveOutcome plain() {
    restart();
    return newton.solve(u);
  }
  /// Largest difference of an unknown from the value for its component, over all ranks.
  double error(const std::vector<double>& expected) {
    double largest = 0.0;
    VecReader values(u);
    for (PetscInt i = 0; i < values.size(); ++i)
      largest = std::max(largest, std::abs(values[i] - expected[i % mesh.dim]));
    MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
    return largest;
  }
};

/// Stiff near its root u = 0.25, soft away from it, and the derivative of a convex energy: full steps from beyond the
/// knees jump to and fro for ever.
double knee(double u) {
  const double v = u - 0.25;
  return std::abs(v) <= 1.0 ? 10.0 * v : std::copysign(10.0 + 0.1 * (std::abs(v) - 1.0), v);
}
double knee_slope(double u) { return std::abs(u - 0.25) <= 1.0 ? 10.0 : 0.1; }

/// O. Ben Gharbia, J. C. Gilbert, Math. Program. 134 (2012) 349-364: with this P-matrix and q = (1, 1, 1) Newton's
/// method on min(z, M z + q) goes round in a cycle of three when exactly one component is on at the start. The
/// solution is z = 0: on paper, from {1} the next z is (−1, 0, 0), where w = (0, −1, 1) makes the second the only one
/// that is on, and so on.
const Complementarity::Matrix cyclic = {{1, 0, 2}, {2, 1, 0}, {0, 2, 1}};
std::unique_ptr<Form> make_cyclic(const DofLayout& layout) {
  return std::make_unique<Complementarity>(layout, cyclic, std::vector<double>{1, 1, 1});
}

/// A wall from 1 to 10 that what has passed through no longer feels, and a weight that drives there.
double wall(double u) { return u > 1.0 && u < 10.0 ? 100.0 * (u - 1.0) : 0.0; }
double wall_slope(double u) { return u > 1.0 && u < 10.0 ? 100.0 : 1e-8; }

} // namespace

TEST_CASE("a cycle is noticed, ends the iteration, and is named with its length and its points") {
  Case one(3, {0.0, 0.0, -2.0}, make_cyclic);
  const auto outcome = one.plain();
  CHECK_FALSE(outcome.converged);
  CHECK(outcome.newton < 15);
  const auto trouble = one.newton.trouble();
  CAPTURE(in_words(trouble));
  CHECK(trouble.cycle == 3);
  CHECK(trouble.num_flipping == 3 * one.mesh.num_global);
  REQUIRE(trouble.points.size() == 3);
  CHECK(trouble.points[0].name == "pairs");
  CHECK(trouble.points[0].place == std::array<double, 3>{0.0, 0.0, 0.0}); // by place
  CHECK(std::is_sorted(trouble.points.begin(), trouble.points.end()));
  const auto words = in_words(trouble);
  CAPTURE(words);
  CHECK(words.find("cycle of 3 iterations") != std::string::npos);
  CHECK(words.find("'pairs' at (0, 0, 0)") != std::string::npos);
}

TEST_CASE("merit search: the energy finds the root that full steps jump over") {
  Case one(2, {3.0, -2.0}, [](const auto& layout) { return std::make_unique<Scalar>(layout, knee, knee_slope); });
  CHECK_FALSE(one.plain().converged);
  const auto outcome = one.ladder.attempt(MeritSearch{}, one.u);
  CAPTURE(outcome.reason);
  CHECK(outcome.converged);
  CHECK(one.error({0.25, 0.25}) < 1e-9);
  CHECK_FALSE(one.plain().converged); // full steps are back
}

TEST_CASE("held points: one at a time breaks a cycle") {
  Case one(3, {0.0, 0.0, -2.0}, make_cyclic);
  const auto failed = one.plain();
  REQUIRE_FALSE(failed.converged);
  const auto outcome = one.ladder.climb(one.u, failed, one.newton.trouble());
  CAPTURE(one.log);
  CHECK(outcome.converged);
  CHECK(one.error({0.0, 0.0, 0.0}) < 1e-9);
  CHECK(one.ladder.uses()[1].tried + one.ladder.uses()[0].helped == 1);
  one.plain();
  const auto alone = one.ladder.attempt(HeldPoints{}, one.u);
  CAPTURE(alone.reason);
  CHECK(alone.converged);
  CHECK(one.error({0.0, 0.0, 0.0}) < 1e-9);
  CHECK_FALSE(one.plain().converged); // nothing is held any more
}

TEST_CASE("lagged limits: a bound that depends on what it bounds is found by taking it for given, again and again") {
  // h(u) = u − g(u) is soft beyond |u| = 1, where full steps jump from 18 to −18 and back: 18 − h(18) / 0.1 = −18. The
  // slope of g is −0.9 or 0.9, so u = g(u) contracts.
  const auto h = [](double u) {
    return std::abs(u) <= 1.0 ? 1.9 * u : std::copysign(1.9 + 0.1 * (std::abs(u) - 1.0), u);
  };
  Case one(2, {18.0, -18.0}, [&](const auto& layout) {
    return std::make_unique<SelfLimited>(
        layout, [h](double u) { return u - h(u); }, [](double u) { return std::abs(u) <= 1.0 ? -0.9 : 0.9; });
  });
  CHECK_FALSE(one.plain().converged);
  const auto outcome = one.ladder.attempt(LaggedLimits{}, one.u);
  CAPTURE(outcome.reason);
  CHECK(outcome.converged);
  CHECK(one.error({0.0, 0.0}) < 1e-9);
  CHECK_FALSE(one.plain().converged); // nothing is held any more
}

TEST_CASE("loop on multipliers: what counts is the solve of the true equations from where it ends") {
  Case* made = nullptr;
  bool gets_near = true;
  const auto loop = [&] {
    VecSet(made->u, gets_near ? 0.75 : 3.0);
    SolveOutcome outcome;
    outcome.newton = 2;
    outcome.converged = true;
    return outcome;
  };
  Case one(
      2, {3.0, -2.0}, [](const auto& layout) { return std::make_unique<Scalar>(layout, knee, knee_slope); }, 0.0, loop);
  made = &one;
  CHECK_FALSE(one.plain().converged);
  const auto outcome = one.ladder.attempt(LoopOnMultipliers{}, one.u);
  CHECK(outcome.converged);
  CHECK(outcome.newton > 2); // both together
  CHECK(one.error({0.25, 0.25}) < 1e-9);
  gets_near = false;
  CHECK_FALSE(one.ladder.attempt(LoopOnMultipliers{}, one.u).converged);
}

TEST_CASE("vanishing support: what would pass through a wall is led up to it, and nothing of the support is left") {
  Case one(
      2, {0.0, 0.0}, [](const auto& layout) { return std::make_unique<Scalar>(layout, wall, wall_slope); }, -0.5);
  const auto failed = one.plain();
  CHECK_FALSE(failed.converged);
  const auto outcome = one.ladder.attempt(VanishingSupport{}, one.u);
  CAPTURE(outcome.reason);
  CHECK(outcome.converged);
  CHECK(one.error({1.005, 1.005}) < 1e-9); // 100 (u − 1) = 0.5
}

TEST_CASE("a rung that failed is left out until an increment has been accepted, and no rung solves the unsolvable") {
  // |u| + 1 has no root.
  Case one(2, {3.0, 3.0}, [](const auto& layout) {
    return std::make_unique<Scalar>(
        layout, [](double u) { return std::abs(u) + 1.0; }, [](double u) { return u < 0.0 ? -1.0 : 1.0; });
  });
  const auto failed = one.plain();
  REQUIRE_FALSE(failed.converged);
  const auto trouble = one.newton.trouble();
  CHECK_FALSE(one.ladder.climb(one.u, failed, trouble).converged);
  CHECK(one.ladder.uses()[0].tried == 1);
  one.ladder.climb(one.u, failed, trouble);
  CHECK(one.ladder.uses()[0].tried == 1);
  one.ladder.release_rungs();
  one.ladder.climb(one.u, failed, trouble);
  CHECK(one.ladder.uses()[0].tried == 2);
  CHECK(one.ladder.uses()[0].helped == 0);
}
