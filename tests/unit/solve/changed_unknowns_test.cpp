// The solvers with conditions or bounds on unknowns notice when they get nowhere, say where, and the conditions climb
// the same ladder as other contact. Here û = u.
#include "form/bounded_unknowns.hpp"
#include "form/condensed_unknowns.hpp"
#include "made_up_forms.hpp"
#include "solve/bounded_newton.hpp"
#include "solve/condensed_newton.hpp"
#include "solve/ladder.hpp"
#include "two_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

namespace {

/// PETSc options as they were before.
class Options {
 public:
  ~Options() {
    for (const char* option : {"-pc_type", "-ksp_type", "-snes_linesearch_type", "-snes_vi_zero_tolerance"})
      PetscOptionsClearValue(nullptr, option);
  }
};

MatHandle identity(const DofLayout& layout) {
  MatHandle matrix;
  const auto ones = layout.new_vector();
  VecSet(ones, 1.0);
  MatCreateAIJ(PETSC_COMM_WORLD, layout.num_owned(), layout.num_owned(), PETSC_DETERMINE, PETSC_DETERMINE, 1, nullptr,
               0, nullptr, matrix.put());
  MatDiagonalSet(matrix, ones, INSERT_VALUES);
  return matrix;
}

/// Conditions z_i = 0 in place of equilibrium w_i = 0 where z_i <= w_i: min(z, w) = 0, component by component.
class ZeroOrBalanced : public CondensedUnknowns, public SwitchedComponents {
 public:
  explicit ZeroOrBalanced(const DofLayout& layout)
      : SwitchedComponents(layout, "conditions"), layout_(layout), identity_(identity(layout)) {}

  bool update(double) override { return false; }
  Mat transform() const override { return identity_; }
  Mat inverse() const override { return identity_; }
  void release() override {}
  using SwitchedComponents::hold;
  void hold() override {}
  void evaluate(Vec changed, Vec forces, Evaluation, Vec residual) override {
    const VecReader z(changed), w(forces);
    VecArray values(residual);
    const int d = layout_.dim();
    rows_.clear();
    for (std::size_t i = 0; i < num_components(); ++i) {
      const auto unknown = static_cast<PetscInt>(i);
      const bool is_closed = turn(i, z[unknown] <= w[unknown]);
      if (is_closed) values[unknown] = z[unknown];
      if (i % d == 0) {
        rows_.push_back({.size = d});
        for (int r = 0; r < d; ++r)
          rows_.back().equations[r] = layout_.first_equation() + unknown + r;
      }
      rows_.back().forces[i % d][i % d] = is_closed ? 0.0 : 1.0;
      rows_.back().motion[i % d][i % d] = is_closed ? 1.0 : 0.0;
    }
  }
  std::span<const ConditionRows> rows() const override { return rows_; }
  std::vector<Switching*> switching() override { return {this}; }

 private:
  const DofLayout& layout_;
  MatHandle identity_;
  std::vector<ConditionRows> rows_;
};

/// û >= 0 everywhere.
class NotNegative : public BoundedUnknowns {
 public:
  explicit NotNegative(const DofLayout& layout)
      : layout_(layout), identity_(identity(layout)), lower_(layout.new_vector()) {}

  bool update(double) override { return false; }
  Mat transform() const override { return identity_; }
  Mat inverse() const override { return identity_; }
  std::vector<Set> sets() const override {
    Set set{.name = "bounds", .places = {}, .unknowns = {}};
    for (PetscInt i = 0; i < layout_.num_owned(); ++i) {
      auto& place = set.places.emplace_back();
      std::ranges::copy(layout_.mesh().position(static_cast<std::int32_t>(i) / layout_.dim()), place.begin());
      set.unknowns.push_back(i);
    }
    return {set};
  }
  Vec lower() const override { return lower_; }
  void hold_forces(Vec) override {}
  void release() override {}

 private:
  const DofLayout& layout_;
  MatHandle identity_;
  VecHandle lower_;
};

/// Equilibrium w = M z + q = 0 at every node, with the matrix of ladder_test.cpp: Newton's method on min(z, w) goes
/// round in a cycle of three from where one component is not closed; the solution is z = 0.
std::vector<std::unique_ptr<Form>> linear(const DofLayout& layout) {
  auto form = std::make_unique<Complementarity>(layout, Complementarity::Matrix{{1, 0, 2}, {2, 1, 0}, {0, 2, 1}},
                                                std::vector<double>{1, 1, 1});
  form->hold(std::vector<Switching::Hold>(form->branches().size(), Switching::Hold::On));
  std::vector<std::unique_ptr<Form>> all;
  all.push_back(std::move(form));
  return all;
}

} // namespace

TEST_CASE("conditions that go round in a cycle are noticed and named, and holding them one at a time breaks it") {
  const Options options;
  PetscOptionsSetValue(nullptr, "-snes_linesearch_type", "basic");
  const Mesh mesh = two_blocks_mesh(PETSC_COMM_WORLD, 3, 1, 1, 0.5);
  const DofLayout layout(mesh, {}, {});
  Problem problem(layout, linear(layout), {});
  ZeroOrBalanced conditions(layout);
  choose_linear_solver(problem);
  CondensedNewton newton(problem, conditions, nullptr);
  const auto u = layout.new_vector();
  const auto restart = [&] {
    {
      VecArray values(u);
      for (PetscInt i = 0; i < values.size(); ++i)
        values[i] = i % 3 == 2 ? -2.0 : 0.0;
    }
    problem.roll_back();
    problem.begin_increment(1.0, u);
  };
  restart();
  const auto failed = newton.solve(u);
  CHECK_FALSE(failed.converged);
  CHECK(failed.newton < 15);
  const auto trouble = newton.trouble();
  const auto words = in_words(trouble);
  CAPTURE(words);
  CHECK(trouble.cycle == 3);
  CHECK(trouble.num_flipping == 3 * mesh.num_global);
  CHECK(words.find("cycle of 3 iterations") != std::string::npos);
  CHECK(words.find("'conditions' at (0, 0, 0)") != std::string::npos);

  std::string log;
  Ladder ladder(problem, newton,
                {.restart = restart,
                 .solve = [&] { return newton.solve(u); },
                 .loop = nullptr,
                 .make_support = nullptr,
                 .tell = [&](const std::string& line) { log += line + "\n"; }});
  const auto alone = ladder.attempt(HeldPoints{}, u);
  CAPTURE(alone.reason);
  CHECK(alone.converged);
  PetscReal largest = 0.0;
  VecNorm(u, NORM_INFINITY, &largest);
  CHECK(largest < 1e-9);
  restart();
  CHECK_FALSE(newton.solve(u).converged); // nothing is held any more
}

TEST_CASE("with bounds, forces that do not change while unknowns run away end the solve and are told") {
  const Options options;
  const Mesh mesh = two_blocks_mesh(PETSC_COMM_WORLD, 2, 1, 1, 0.5);
  const DofLayout layout(mesh, {}, {});
  // Pulled off with a force of 1, against a stiffness that the residual does not have.
  std::vector<std::unique_ptr<Form>> forms;
  forms.push_back(std::make_unique<Scalar>(
      layout, [](double) { return -1.0; }, [](double) { return 1.0; }));
  Problem problem(layout, std::move(forms), {});
  NotNegative bounds(layout);
  choose_bounded_solver(problem);
  BoundedNewton newton(problem, bounds, nullptr);
  const auto u = layout.new_vector();
  problem.begin_increment(1.0, u);
  const auto outcome = newton.solve(u);
  CHECK_FALSE(outcome.converged);
  CHECK(outcome.newton < 25); // 12 full steps, 8 at rest; without detection 50
  const auto trouble = newton.trouble();
  CHECK(trouble.rests);
  CHECK(trouble.num_flipping == 0);
  CHECK(trouble.cycle == 0);
  CHECK(in_words(trouble).find("with this status there is no equilibrium") != std::string::npos);
}
