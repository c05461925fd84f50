// Bounds on mortar unknowns against the semismooth formulation: a round block on a flat one, from any first guess.
#include "contact/contact_form.hpp"
#include "contact/mortar_transform.hpp"
#include "form/bulk.hpp"
#include "form/problem.hpp"
#include "material/elastic.hpp"
#include "solve/bounded_newton.hpp"
#include "solver_support.hpp"
#include "two_blocks.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

namespace {

/// Nothing but a note of the last iterate.
class Witness : public Form {
 public:
  const char* name() const override { return "witness"; }
  void couple(Coupling&) const override {}
  void add_residual(const State& state, Residual&) override {
    displacement.assign(state.displacement.begin(), state.displacement.end());
  }
  void add_tangent(const State&, Tangent&) override {}
  bool tangent_is_constant() const override { return true; }
  std::vector<double> displacement;
};

/// The upper block is pressed down by 0.03 t.
struct Fixture {
  Mesh mesh;
  std::vector<NodeField> fields;
  std::unique_ptr<DofLayout> layout;
  std::unique_ptr<Problem> problem;
  BulkForm* bulk = nullptr;
  Witness* witness = nullptr;
  PairReport* pair = nullptr;
  MortarForm* mortar = nullptr;

  Fixture(int dim, int n, const Enforcement& enforcement) : mesh(round_on_flat(dim, n)) {
    const bool is_bound = std::holds_alternative<BoundConstraint>(enforcement);
    if (!is_bound) fields.push_back(multiplier_nodes(mesh, "interface", "upper_bottom"));
    layout = std::make_unique<DofLayout>(mesh, std::vector<TiedGroup>{}, fields);
    const Space space = dim == 2 ? Space::PlaneStrain : Space::Solid;
    const std::vector<SmallLaw> laws = {Elastic{300.0, 0.2}, Elastic{100.0, 0.3}};
    std::vector<std::unique_ptr<Form>> forms;
    auto solid = std::make_unique<BulkForm>(*layout, space, laws);
    auto noting = std::make_unique<Witness>();
    bulk = solid.get();
    witness = noting.get();
    forms.push_back(std::move(solid));
    forms.push_back(std::move(noting));
    ContactPair declared{.name = "interface",
                         .slave = "upper_bottom",
                         .master = std::string("lower_top"),
                         .enforcement = enforcement,
                         .projection = {},
                         .integration = FacetIntegration{6},
                         .search_distance = 0.5,
                         .space = space,
                         .stiffness = {300.0, 100.0}};
    if (is_bound) {
      auto form = std::make_unique<MortarForm>(*layout, declared);
      pair = mortar = form.get();
      forms.push_back(std::move(form));
    } else {
      auto form = std::make_unique<ContactForm>(*layout, declared);
      pair = form.get();
      forms.push_back(std::move(form));
    }
    std::vector<PrescribedDisplacement> prescribed;
    for (int c = 0; c < dim; ++c) {
      prescribed.push_back({"bottom", c, Expression(0.0)});
      prescribed.push_back({"top", c, c == dim - 1 ? Expression("-0.03*t", {}) : Expression(0.0)});
    }
    problem = std::make_unique<Problem>(*layout, std::move(forms), prescribed);
  }
  /// Energy of both blocks in the last iterate, over all ranks.
  double energy() const {
    double energy = bulk->stored_energy({.time = 1.0, .displacement = witness->displacement});
    MPI_Allreduce(MPI_IN_PLACE, &energy, 1, MPI_DOUBLE, MPI_SUM, mesh.comm);
    return energy;
  }
  ContactTotals totals(Vec u) const { return pair->totals(problem->state_at(u)); }
};

enum class Guess { Zero, AllTouch, Random };

/// û at its bounds everywhere, or at some of them and below or above it at others.
void guess(Guess kind, const Mesh& mesh, const MortarTransform& transform, Vec u) {
  if (kind == Guess::Zero) return;
  VecHandle changed;
  VecDuplicate(u, changed.put());
  MatMult(transform.inverse(), u, changed);
  {
    VecArray values(changed);
    VecReader lower(transform.lower());
    for (PetscInt i = 0; i < values.size(); ++i) {
      const auto x = mesh.position(static_cast<std::int32_t>(i / mesh.dim));
      const double wiggle = std::sin(1.0 + 40.0 * x[0] + 17.0 * x[mesh.dim - 2]);
      if (lower[i] > PETSC_NINFINITY) values[i] = lower[i] + (kind == Guess::Random ? 0.02 * wiggle : 0.0);
    }
  }
  MatMult(transform.transform(), changed, u);
}

} // namespace

TEST_CASE("from no contact, from contact everywhere and from a random guess to the same answer") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    const OptionScope scope;
    Fixture fixture(dim, dim == 2 ? 16 : 4, BoundConstraint{});
    MortarTransform transform(*fixture.problem, {fixture.mortar});
    choose_bounded_solver(*fixture.problem);
    const auto reference = fixture.layout->new_vector(), u = fixture.layout->new_vector();
    for (const Guess kind : {Guess::Zero, Guess::AllTouch, Guess::Random}) {
      CAPTURE(int(kind));
      BoundedNewton newton(*fixture.problem, transform, nullptr);
      fixture.problem->roll_back();
      VecSet(u, 0.0);
      guess(kind, fixture.mesh, transform, u);
      fixture.problem->begin_increment(1.0, u);
      const auto outcome = newton.solve(u);
      CAPTURE(outcome.reason);
      CHECK(outcome.converged);
      CHECK(outcome.newton <= 12);
      CHECK(outcome.residual < 1e-10);
      if (kind == Guess::Zero) VecCopy(u, reference);
      VecAXPY(u, -1.0, reference);
      CHECK(largest(u) < 1e-10 * largest(reference));
    }
    const auto totals = fixture.totals(reference);
    CHECK(totals.max_pressure > 1.0);
    CHECK(totals.area > 0.1);
    CHECK(totals.area < 0.8);
    CHECK(totals.largest_penetration < 1e-12);
  }
}

TEST_CASE("after the free iterations each step lowers the energy, from any guess") {
  for (const int free : {0, 2})
    for (const Guess kind : {Guess::Zero, Guess::AllTouch, Guess::Random}) {
      CAPTURE(free);
      CAPTURE(int(kind));
      const OptionScope scope;
      PetscOptionsSetValue(nullptr, "-vi_free_iterations", std::to_string(free).c_str());
      Fixture fixture(2, 24, BoundConstraint{});
      MortarTransform transform(*fixture.problem, {fixture.mortar});
      choose_bounded_solver(*fixture.problem);
      std::vector<double> energies; // of the iterates
      BoundedNewton newton(*fixture.problem, transform, [&] {
        energies.push_back(fixture.energy());
        return false;
      });
      const auto u = fixture.layout->new_vector();
      guess(kind, fixture.mesh, transform, u);
      fixture.problem->begin_increment(1.0, u);
      CHECK(newton.solve(u).converged);
      REQUIRE(energies.size() > std::size_t(free) + 2);
      const double rounding = 1e-13 * energies.front();
      int fell = 0;
      for (std::size_t i = static_cast<std::size_t>(free) + 1; i < energies.size(); ++i) {
        CHECK(energies[i] <= energies[i - 1] + rounding);
        fell += energies[i] < energies[i - 1] - rounding;
      }
      CHECK(fell > 0);
    }
}

TEST_CASE("the answer is that of semismooth within the discretization error, and nears it with the mesh") {
  std::vector<double> difference;
  for (const int n : {8, 16, 32}) {
    Fixture bound(2, n, BoundConstraint{}), other(2, n, Semismooth{0});
    const auto u = bound.layout->new_vector(), v = other.layout->new_vector();
    MortarTransform transform(*bound.problem, {bound.mortar});
    {
      const OptionScope scope;
      choose_bounded_solver(*bound.problem);
      BoundedNewton newton(*bound.problem, transform, nullptr);
      bound.problem->begin_increment(1.0, u);
      CHECK(newton.solve(u).converged);
    }
    const OptionScope scope;
    choose_linear_solver(*other.problem);
    Newton plain(*other.problem, nullptr);
    other.problem->begin_increment(1.0, v);
    CHECK(plain.solve(v).converged);
    const double up = bound.totals(u).force[1], other_up = other.totals(v).force[1];
    CHECK(up > 0.3);
    difference.push_back(std::abs(up / other_up - 1.0));
  }
  CHECK(difference[2] < 2e-3);
  CHECK(difference[2] < 0.5 * difference[0]);
}

TEST_CASE("area and force grow and shrink monotonically through loading and unloading, and come back") {
  const OptionScope scope;
  Fixture fixture(2, 24, BoundConstraint{});
  MortarTransform transform(*fixture.problem, {fixture.mortar});
  choose_bounded_solver(*fixture.problem);
  BoundedNewton newton(*fixture.problem, transform, nullptr);
  const auto u = fixture.layout->new_vector();
  std::vector<ContactTotals> history;
  for (const double t : {0.2, 0.4, 0.6, 0.8, 1.0, 0.8, 0.6, 0.4, 0.2, -0.1}) {
    fixture.problem->begin_increment(t, u);
    CHECK(newton.solve(u).converged);
    fixture.problem->commit(u);
    history.push_back(fixture.totals(u));
  }
  for (std::size_t i = 1; i < history.size(); ++i) {
    const double sign = i < 5 ? 1.0 : -1.0;
    CHECK(sign * (history[i].area - history[i - 1].area) >= 0.0);
    CHECK(sign * (history[i].force[1] - history[i - 1].force[1]) > 0.0);
  }
  for (std::size_t i = 0; i < 4; ++i)
    CHECK(history[8 - i].force[1] == doctest::Approx(history[i].force[1]).epsilon(1e-9));
  CHECK(history.back().area == 0.0);
  CHECK(history[4].area > 2.0 * history[0].area);
}

TEST_CASE("the semismooth solver for inequalities, steps that lower the energy, and multigrid find the same answer") {
  Fixture fixture(3, 6, BoundConstraint{});
  const auto solve_with = [&](const std::vector<std::pair<const char*, const char*>>& options) {
    const OptionScope scope;
    for (const auto& [name, value] : options)
      PetscOptionsSetValue(nullptr, name, value);
    choose_bounded_solver(*fixture.problem);
    MortarTransform transform(*fixture.problem, {fixture.mortar});
    BoundedNewton newton(*fixture.problem, transform, nullptr);
    auto u = fixture.layout->new_vector();
    fixture.problem->roll_back();
    fixture.problem->begin_increment(1.0, u);
    const auto outcome = newton.solve(u);
    CAPTURE(outcome.reason);
    CHECK(outcome.converged);
    return u;
  };
  const auto reference = solve_with({});
  const auto multigrid = solve_with({{"-ksp_type", "cg"}, {"-ksp_rtol", "1e-10"}, {"-pc_type", "gamg"}});
  const auto semismooth = solve_with({{"-snes_type", "vinewtonssls"}, {"-snes_rtol", "1e-13"}});
  const auto descent = solve_with({{"-vi_free_iterations", "0"}});
  for (const Vec other : {multigrid.get(), semismooth.get(), descent.get()}) {
    VecAXPY(other, -1.0, reference);
    CHECK(largest(other) < 1e-7 * largest(reference));
  }
}
