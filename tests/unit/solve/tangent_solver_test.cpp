// Newton's method with a factorization that serves many tangents, or with multigrid, finds what it finds with one for
// every tangent.
#include "base/error.hpp"
#include "form/bulk.hpp"
#include "material/elastic.hpp"
#include "solve/newton.hpp"
#include "solve/solver_choice.hpp"
#include "solver_support.hpp"
#include "two_blocks.hpp"

#include <algorithm>
#include <array>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

namespace {

/// Springs under the nodes of a group that only push back, F_z = −k max(0, depth), so that the tangent changes with the
/// set of those that push; and a swirl F_x = s u_y, F_y = −s u_x that makes it unsymmetric.
class Springs : public Form {
 public:
  Springs(const DofLayout& layout, std::string group, double stiffness, double swirl)
      : layout_(layout), group_(std::move(group)), stiffness_(stiffness), swirl_(swirl) {}
  const char* name() const override { return "springs"; }
  bool tangent_is_symmetric() const override { return swirl_ == 0.0; }
  void couple(Coupling& coupling) const override {
    for (const auto node : nodes())
      coupling.add(equations(node));
  }
  void add_residual(const State& state, Residual& residual) override {
    for (const auto node : nodes()) {
      const double push = stiffness_ * std::max(0.0, depth(state, node));
      residual.nodal()[std::size_t(node) * 3 + 2] -= push;
      residual.nodal()[std::size_t(node) * 3] += swirl_ * state.displacement[std::size_t(node) * 3 + 1];
      residual.nodal()[std::size_t(node) * 3 + 1] -= swirl_ * state.displacement[std::size_t(node) * 3];
    }
  }
  void add_tangent(const State& state, Tangent& tangent) override {
    for (const auto node : nodes()) {
      const double k = depth(state, node) > 0.0 ? stiffness_ : 0.0;
      const double block[] = {0.0, swirl_, 0.0, -swirl_, 0.0, 0.0, 0.0, 0.0, k};
      tangent.add(equations(node), block);
    }
  }

 protected:
  std::vector<std::int32_t> nodes() const {
    std::vector<std::int32_t> owned;
    for (const auto node : layout_.mesh().node_groups.at(group_))
      if (node < layout_.mesh().num_owned) owned.push_back(node);
    return owned;
  }
  /// The springs' feet stand at different heights, so that they close one after the other.
  double depth(const State& state, std::int32_t node) const {
    const auto place = layout_.mesh().position(node);
    return -0.004 * (place[0] + 0.5 * place[1]) - state.displacement[std::size_t(node) * 3 + 2];
  }
  std::array<PetscInt, 3> equations(std::int32_t node) const {
    return {layout_.equation(node, 0), layout_.equation(node, 1), layout_.equation(node, 2)};
  }
  const DofLayout& layout_;

 private:
  std::string group_;
  double stiffness_, swirl_;
};

/// Couples the nodes whose springs have pushed, so that the pattern grows with them.
class GrowingSprings : public Springs {
 public:
  GrowingSprings(const DofLayout& layout, std::string group, double stiffness)
      : Springs(layout, std::move(group), stiffness, 0.0), coupled_(layout.mesh().num_owned, 0) {}
  void couple(Coupling& coupling) const override {
    for (const auto node : nodes())
      if (coupled_[node]) coupling.add(equations(node));
  }
  bool coupling_changed(const State& state) override {
    bool has_grown = false;
    for (const auto node : nodes())
      if (!coupled_[node] && depth(state, node) > 0.0) {
        coupled_[node] = 1;
        has_grown = true;
      }
    return has_grown;
  }
  void add_tangent(const State& state, Tangent& tangent) override {
    class Coupled : public Tangent {
     public:
      explicit Coupled(Tangent& tangent) : tangent_(tangent) {}
      void add(std::span<const PetscInt> equations, std::span<const double> block) override {
        if (block[8] != 0.0) tangent_.add(equations, block);
      }

     private:
      Tangent& tangent_;
    };
    Coupled coupled(tangent);
    Springs::add_tangent(state, coupled);
  }

 private:
  std::vector<std::uint8_t> coupled_;
};

struct Found {
  VecHandle displacement; // at the end
  int newton = 0, factorizations = 0;
};

/// The upper block above the springs, held along x and y at a group and pressed down at its top.
std::unique_ptr<Problem> pressed_block(const DofLayout& layout, std::unique_ptr<Springs> springs,
                                       const char* held = "top") {
  std::vector<std::unique_ptr<Form>> forms;
  const Elastic law{100.0, 0.3};
  forms.push_back(std::make_unique<BulkForm>(layout, Space::Solid, std::vector<SmallLaw>{law, law}));
  forms.push_back(std::move(springs));
  std::vector<PrescribedDisplacement> prescribed;
  for (int c = 0; c < 3; ++c)
    prescribed.push_back({"bottom", c, Expression(0.0)});
  for (int c = 0; c < 2; ++c)
    prescribed.push_back({held, c, Expression(0.0)});
  prescribed.push_back({"top", 2, Expression("-0.01*t", {})});
  return std::make_unique<Problem>(layout, std::move(forms), prescribed);
}

/// `solver`: a type of PETSc's preconditioners, or one of -shell_solver; `search`: a type of its line searches.
void choose(const Problem& problem, const std::string& solver, const char* search) {
  const bool is_type = solver == PCLU || solver == PCGAMG;
  PetscOptionsSetValue(nullptr, "-pc_type", is_type ? solver.c_str() : PCSHELL);
  if (!is_type) PetscOptionsSetValue(nullptr, "-shell_solver", solver.c_str());
  PetscOptionsSetValue(nullptr, "-snes_linesearch_type", search);
  choose_newton_solver(problem);
}

/// That block pressed in five increments.
Found press(const DofLayout& layout, std::unique_ptr<Springs> springs, const std::string& solver,
            const char* held = "top", const char* search = "basic") {
  const auto pressed = pressed_block(layout, std::move(springs), held);
  Problem& problem = *pressed;
  const OptionScope scope;
  choose(problem, solver, search);
  Newton newton(problem, nullptr);
  Found found{.displacement = layout.new_vector()};
  for (int increment = 1; increment <= 5; ++increment) {
    problem.begin_increment(0.2 * increment, found.displacement);
    const auto outcome = newton.solve(found.displacement);
    CAPTURE(increment);
    CAPTURE(outcome.reason);
    REQUIRE(outcome.converged);
    found.newton += outcome.newton;
    found.factorizations += outcome.factorizations;
    problem.commit(found.displacement);
  }
  return found;
}

/// Largest difference relative to the largest displacement.
double difference(const Found& found, const Found& reference) {
  const double size = largest(reference.displacement);
  CHECK(size > 1e-3);
  VecAXPY(found.displacement, -1.0, reference.displacement);
  return largest(found.displacement) / size;
}

bool is_alone() {
  int ranks = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  return ranks == 1;
}

} // namespace

TEST_CASE("a factorization for many tangents leads to the same displacements with fewer factorizations") {
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, 3, 4, 5, 0.0);
  const DofLayout layout(mesh, {}, {});
  for (const double stiffness : {10.0, 1e4})
    for (const double swirl : {0.0, 3.0, 1e4}) { // the last is far from symmetric
      CAPTURE(stiffness);
      CAPTURE(swirl);
      const auto solve = [&](const std::string& solver) {
        return press(layout, std::make_unique<Springs>(layout, "upper_bottom", stiffness, swirl), solver);
      };
      const auto reference = solve("lu"), kept = solve("kept");
      CHECK(difference(kept, reference) < 1e-9);
      CHECK(reference.factorizations > 5); // the tangent really changes
      if (swirl == 0.0) CHECK(kept.factorizations < reference.factorizations);
      if (!is_alone() && swirl != 3.0) continue; // there the other solver makes a factorization for every tangent
      const auto condensed = solve("schur");
      CHECK(difference(condensed, reference) < 1e-12);
      if (is_alone()) CHECK(condensed.factorizations == 1);
    }
}

TEST_CASE("a condensed factorization is made anew when the pattern has grown") {
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, 3, 4, 5, 0.0);
  const DofLayout layout(mesh, {}, {});
  const auto solve = [&](const std::string& solver) {
    return press(layout, std::make_unique<GrowingSprings>(layout, "upper_bottom", 1e3), solver);
  };
  const auto reference = solve("lu"), condensed = solve("schur");
  CHECK(difference(condensed, reference) < 1e-12);
  if (is_alone()) CHECK(condensed.factorizations > 1);
  CHECK(condensed.factorizations <= reference.factorizations);
}

TEST_CASE("condensed steps may be shortened by a line search") {
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, 3, 4, 5, 0.0);
  const DofLayout layout(mesh, {}, {});
  for (const char* search : {"bt", "l2"})
    for (const double swirl : {0.0, 3.0}) {
      CAPTURE(search);
      CAPTURE(swirl);
      const auto solve = [&](const std::string& solver) {
        return press(layout, std::make_unique<Springs>(layout, "upper_bottom", 1e3, swirl), solver, "top", search);
      };
      const auto reference = solve("lu"), condensed = solve("schur");
      CHECK(difference(condensed, reference) < 1e-12);
    }
}

TEST_CASE("condensed steps leave the solid out in the course of a solve, and not where it ends") {
  if (!is_alone()) return; // there nothing is condensed
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, 3, 4, 5, 0.0);
  const DofLayout layout(mesh, {}, {});
  const auto owner = pressed_block(layout, std::make_unique<Springs>(layout, "upper_bottom", 1e3, 0.0));
  Problem& problem = *owner;
  const OptionScope scope;
  choose(problem, "schur", "basic");
  const auto u = layout.new_vector(), residual = layout.new_vector();
  const auto of_others = [&] { // largest residual outside the equations that change, relative to the forces
    REQUIRE(problem.residual(u, residual));
    const double size = problem.force_scale();
    {
      VecArray values(residual);
      for (const PetscInt equation : problem.changing_equations())
        values[equation] = 0.0;
    }
    return largest(residual) / size;
  };
  std::vector<double> course; // at every iterate
  std::size_t last = 0;
  Newton newton(problem, [&] {
    course.push_back(of_others());
    return course.size() == last;
  });
  for (const std::size_t end : {std::size_t(3), std::size_t(0)}) { // interrupted in the middle, or to convergence
    CAPTURE(end);
    course.clear();
    last = end;
    AMT_PETSC(VecSet(u, 0.0));
    problem.begin_increment(1.0, u);
    const auto outcome = newton.solve(u);
    CHECK(outcome.interrupted == (end > 0));
    CHECK(outcome.converged == (end == 0));
    REQUIRE(course.size() > 2);
    CHECK(course[1] < 1e-12); // the first step is whole
    CHECK(course[2] > 1e-3);
    CHECK(of_others() < 1e-12);
    if (end == 0) CHECK(course.back() < 1e-12); // convergence is judged where all is put right
  }
}

TEST_CASE("a name that no solver has is refused") {
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, 3, 4, 5, 0.0);
  const DofLayout layout(mesh, {}, {});
  CHECK_THROWS_WITH_AS(press(layout, std::make_unique<Springs>(layout, "upper_bottom", 1.0, 0.0), "keep"),
                       doctest::Contains("Use kept or schur"), UserError);
}

TEST_CASE("multigrid leaves supports where they are put, however unfinished its solves") {
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, 3, 4, 5, 0.0);
  const DofLayout layout(mesh, {}, {});
  const OptionScope scope;
  PetscOptionsSetValue(nullptr, "-ksp_rtol", "1e-2");
  const auto solve = [&](const std::string& solver) {
    return press(layout, std::make_unique<Springs>(layout, "upper_bottom", 10.0, 0.0), solver, "upper_bottom");
  };
  const auto found = solve(PCGAMG);
  const auto reference = solve(PCLU);
  const VecReader values(found.displacement);
  int tops = 0;
  for (const auto& [group, moved] : {std::pair("bottom", 0.0), std::pair("top", -0.01)})
    for (const auto node : mesh.node_groups.at(group)) {
      if (node >= mesh.num_owned) continue;
      CHECK(values[layout.equation(node, 2) - layout.first_equation()] == moved);
      tops += group == std::string("top");
    }
  MPI_Allreduce(MPI_IN_PLACE, &tops, 1, MPI_INT, MPI_SUM, PETSC_COMM_WORLD);
  CHECK(tops > 0);
  const auto difference = layout.new_vector();
  VecWAXPY(difference, -1.0, reference.displacement, found.displacement);
  CHECK(largest(difference) < 1e-7 * largest(reference.displacement));
}

TEST_CASE("a singular tangent is an outcome, and the next solve starts anew") {
  class Constant : public Form {
   public:
    explicit Constant(const DofLayout& layout) : layout_(layout) {}
    double slope = 0.0;
    const char* name() const override { return "constant"; }
    void couple(Coupling& coupling) const override {
      for (std::int32_t node = 0; node < layout_.mesh().num_owned; ++node)
        coupling.add(equations(node));
    }
    void add_residual(const State& state, Residual& residual) override {
      for (std::int32_t i = 0; i < layout_.mesh().num_owned * 2; ++i)
        residual.nodal()[i] += 1.0 + slope * state.displacement[i];
    }
    void add_tangent(const State&, Tangent& tangent) override {
      for (std::int32_t node = 0; node < layout_.mesh().num_owned; ++node)
        tangent.add(equations(node), std::array{slope, 0.0, 0.0, slope});
    }

   private:
    std::array<PetscInt, 2> equations(std::int32_t node) const {
      return {layout_.equation(node, 0), layout_.equation(node, 1)};
    }
    const DofLayout& layout_;
  };
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, 2, 2, 2, 0.0);
  const DofLayout layout(mesh, {}, {});
  for (const char* solver : {"kept", "schur"}) {
    CAPTURE(solver);
    std::vector<std::unique_ptr<Form>> forms;
    forms.push_back(std::make_unique<Constant>(layout));
    auto& form = static_cast<Constant&>(*forms.front());
    Problem problem(layout, std::move(forms), {});
    const OptionScope scope;
    PetscOptionsSetValue(nullptr, "-pc_type", PCSHELL);
    PetscOptionsSetValue(nullptr, "-shell_solver", solver);
    choose_newton_solver(problem);
    Newton newton(problem, nullptr);
    const auto u = layout.new_vector();
    problem.begin_increment(1.0, u);
    const auto singular = newton.solve(u);
    CAPTURE(singular.reason);
    CHECK_FALSE(singular.converged);
    CHECK(singular.reason.find("linear solver") != std::string::npos);
    form.slope = 2.0;
    problem.begin_increment(1.0, u);
    const auto regular = newton.solve(u);
    CAPTURE(regular.reason);
    CHECK(regular.converged);
    double highest = 0.0;
    VecMax(u, nullptr, &highest);
    CHECK(highest == doctest::Approx(-0.5));
  }
}
