// Semismooth contact with the dual basis: its derivative against differences, and its solutions against those of `vi`,
// from which they must not differ, and of the nodal basis.
#include "contact/condensed_contact.hpp"
#include "contact/contact_form.hpp"
#include "form/bulk.hpp"
#include "form/problem.hpp"
#include "material/elastic.hpp"
#include "solve/bounded_newton.hpp"
#include "solve/condensed_newton.hpp"
#include "solver_support.hpp"
#include "two_blocks.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

namespace {

struct Case {
  int dim = 2;
  int n = 8;
  std::optional<FrictionLaw> friction = std::nullopt;
  Enforcement enforcement = CondensedSemismooth{};
};

/// The upper block is pressed down by 0.03 until t = 1 and then drawn along by 0.04 (t - 1).
struct Fixture {
  Mesh mesh;
  std::vector<NodeField> fields;
  std::unique_ptr<DofLayout> layout;
  std::unique_ptr<Problem> problem;
  PairReport* pair = nullptr;
  MortarForm* mortar = nullptr;

  explicit Fixture(const Case& c) : mesh(round_on_flat(c.dim, c.n)) {
    const bool is_nodal = std::holds_alternative<Semismooth>(c.enforcement);
    if (is_nodal) fields.push_back(multiplier_nodes(mesh, "interface", "upper_bottom"));
    for (int i = 0; is_nodal && c.friction && i < c.dim; ++i)
      fields.push_back(fields.front());
    layout = std::make_unique<DofLayout>(mesh, std::vector<TiedGroup>{}, fields);
    const Space space = c.dim == 2 ? Space::PlaneStrain : Space::Solid;
    const std::vector<SmallLaw> laws = {Elastic{300.0, 0.2}, Elastic{100.0, 0.3}};
    std::vector<std::unique_ptr<Form>> forms;
    forms.push_back(std::make_unique<BulkForm>(*layout, space, laws));
    ContactPair declared{.name = "interface",
                         .slave = "upper_bottom",
                         .master = std::string("lower_top"),
                         .enforcement = c.enforcement,
                         .projection = {},
                         .integration = FacetIntegration{6},
                         .search_distance = 0.5,
                         .space = space,
                         .stiffness = {300.0, 100.0}};
    if (c.friction) declared.friction = Friction{.law = *c.friction, .factor = std::nullopt, .field = 1};
    if (is_nodal) {
      auto form = std::make_unique<ContactForm>(*layout, declared);
      pair = form.get();
      forms.push_back(std::move(form));
    } else {
      auto form = std::make_unique<MortarForm>(*layout, declared);
      pair = mortar = form.get();
      forms.push_back(std::move(form));
    }
    std::vector<PrescribedDisplacement> prescribed;
    for (int i = 0; i < c.dim; ++i) {
      prescribed.push_back({"bottom", i, Expression(0.0)});
      const char* const moves = i == c.dim - 1 ? "-0.03*min(t,1)" : i == 0 ? "0.04*max(t-1,0)" : "0.015*max(t-1,0)";
      prescribed.push_back({"top", i, Expression(moves, {})});
    }
    problem = std::make_unique<Problem>(*layout, std::move(forms), prescribed);
  }
  ContactTotals totals(Vec u) const { return pair->totals(problem->state_at(u)); }
};

/// Solves and commits, one increment a time. Returns Newton's iterations.
int march(Fixture& fixture, CondensedNewton& newton, Vec u, const std::vector<double>& times) {
  int iterations = 0;
  for (const double t : times) {
    fixture.problem->begin_increment(t, u);
    const auto outcome = newton.solve(u);
    CAPTURE(outcome.reason);
    CHECK(outcome.converged);
    CHECK(outcome.residual < 1e-9);
    iterations += outcome.newton;
    fixture.problem->commit(u);
  }
  return iterations;
}

const Coulomb coulomb{.mu = 0.3, .cohesion = 0.0};

} // namespace

TEST_CASE("the conditions' derivative is that of their differences, open, sticking and sliding") {
  const std::vector<std::pair<int, FrictionLaw>> cases = {
      {2, coulomb},
      {3, coulomb},
      {2, SlipWeakening{.mu_s = 0.4, .mu_k = 0.2, .D_c = 0.05, .cohesion = 0.01}},
      {3, VelocityWeakening{.mu_s = 0.4, .mu_k = 0.25, .v_c = 0.02, .cohesion = 0.0}}};
  for (const auto& [dim, law] : cases) {
    CAPTURE(dim);
    CAPTURE(law.index());
    const OptionScope scope;
    Fixture fixture({.dim = dim, .n = dim == 2 ? 12 : 4, .friction = law});
    CondensedContact contact(*fixture.problem, {fixture.mortar});
    choose_linear_solver(*fixture.problem);
    CondensedNewton newton(*fixture.problem, contact, nullptr);
    const auto u = fixture.layout->new_vector();
    march(fixture, newton, u, {1.0, 1.4});

    // A state near equilibrium of a later time, where some nodes stick and others slide: drawn along, and shaken.
    fixture.problem->begin_increment(1.5, u);
    contact.release();
    contact.update(1.5);
    ChangedProblem whole(*fixture.problem);
    whole.take_transform(contact.transform(), contact.inverse());
    whole.tangent_at(u);
    const auto vector = [&] { return fixture.layout->new_vector(); };
    const auto at = vector(), direction = vector(), moved = vector(), forces = vector();
    whole.to_changed(u, at);
    {
      VecArray values(at), way(direction);
      const PetscInt first = fixture.layout->first_equation();
      for (PetscInt i = 0; i < values.size(); ++i) {
        const auto x = fixture.mesh.position(static_cast<std::int32_t>(i / dim));
        const double shake = std::sin(1.0 + 9.0 * x[0] + 4.0 * x[dim - 1] + 2.0 * double(i % dim));
        if (fixture.problem->is_prescribed(first + i)) continue;
        values[i] += 2e-4 * shake;
        way[i] = std::cos(3.0 + 5.0 * x[0] - 3.0 * x[dim - 1] + double(i % dim));
      }
    }
    const auto residual_at = [&](double step, Vec result) {
      VecWAXPY(moved, step, direction, at);
      whole.residual(moved, forces);
      VecCopy(forces, result);
      contact.evaluate(moved, forces, Evaluation::True, result);
    };
    const auto base = vector(), change = vector(), plus = vector(), minus = vector();
    residual_at(0.0, base);
    const std::vector<ConditionRows> rows(contact.rows().begin(), contact.rows().end());
    contact.hold();
    const auto totals = fixture.totals(u);
    CHECK(totals.stick_area > 0.01);
    CHECK(totals.slip_area > 0.01);
    CHECK(totals.open_area > 0.01);
    contact.release();

    // What the rows say.
    MatMult(whole.matrix(), direction, forces);
    VecCopy(forces, change);
    double size = 0.0; // of the changes in rows of conditions
    {
      VecArray result(change);
      VecReader force(forces), way(direction);
      const PetscInt first = fixture.layout->first_equation();
      for (const auto& node : rows)
        for (int r = 0; r < node.size; ++r) {
          double sum = 0.0;
          for (int c = 0; c < node.size; ++c)
            sum += node.forces[r][c] * force[node.equations[c] - first] +
                   node.motion[r][c] * way[node.equations[c] - first];
          result[node.equations[r] - first] = sum;
          size = std::max(size, std::abs(sum));
        }
    }
    MPI_Allreduce(MPI_IN_PLACE, &size, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
    CHECK(size > 0.1);
    const double h = 1e-7;
    residual_at(h, plus);
    residual_at(-h, minus);
    VecAXPY(plus, -1.0, minus);
    VecScale(plus, 0.5 / h);
    VecAXPY(plus, -1.0, change);
    CHECK(largest(plus) < 1e-5 * size);
    // Taylor: the remainder falls with the square of the step.
    const auto remainder = [&](double step) {
      residual_at(step, plus);
      VecAXPY(plus, -1.0, base);
      VecAXPY(plus, -step, change);
      return largest(plus);
    };
    const double far = remainder(1e-4), near = remainder(1e-5);
    if (dim == 3) CHECK(far > 1e-10); // the direction of sliding turns
    CHECK(near <= std::max(0.02 * far, 1e-13));
  }
}

TEST_CASE("without friction the answer is that of vi to rounding, from multigrid too") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    Fixture bound({.dim = dim, .n = dim == 2 ? 16 : 4, .enforcement = BoundConstraint{}});
    Fixture condensed({.dim = dim, .n = dim == 2 ? 16 : 4});
    const auto reference = bound.layout->new_vector();
    {
      const OptionScope scope;
      MortarTransform transform(*bound.problem, {bound.mortar});
      choose_bounded_solver(*bound.problem);
      BoundedNewton newton(*bound.problem, transform, nullptr);
      bound.problem->begin_increment(1.0, reference);
      CHECK(newton.solve(reference).converged);
    }
    CHECK(bound.totals(reference).force[dim - 1] > 0.3);
    CondensedContact contact(*condensed.problem, {condensed.mortar});
    const auto solve_with = [&](const std::vector<std::pair<const char*, const char*>>& options, double tolerance) {
      const OptionScope scope;
      for (const auto& [name, value] : options)
        PetscOptionsSetValue(nullptr, name, value);
      choose_linear_solver(*condensed.problem);
      CondensedNewton newton(*condensed.problem, contact, nullptr);
      const auto u = condensed.layout->new_vector();
      condensed.problem->roll_back();
      condensed.problem->begin_increment(1.0, u);
      const auto outcome = newton.solve(u);
      CAPTURE(outcome.reason);
      CHECK(outcome.converged);
      CHECK(outcome.newton <= 10);
      for (int c = 0; c < dim; ++c)
        CHECK(condensed.totals(u).force[c] == doctest::Approx(bound.totals(reference).force[c]).epsilon(tolerance));
      VecAXPY(u, -1.0, reference);
      CHECK(largest(u) < tolerance * largest(reference));
    };
    solve_with({}, 1e-11);
    solve_with({{"-ksp_type", "cg"}, {"-ksp_rtol", "1e-10"}, {"-pc_type", "gamg"}}, 1e-7);
  }
}

TEST_CASE("with friction the answer nears that of the nodal basis with the mesh") {
  std::vector<double> shear, stick;
  for (const int n : {8, 16, 32}) {
    Fixture condensed({.n = n, .friction = coulomb}),
        nodal({.n = n, .friction = coulomb, .enforcement = Semismooth{0}});
    const auto u = condensed.layout->new_vector(), v = nodal.layout->new_vector();
    {
      const OptionScope scope;
      CondensedContact contact(*condensed.problem, {condensed.mortar});
      choose_linear_solver(*condensed.problem);
      CondensedNewton newton(*condensed.problem, contact, nullptr);
      condensed.problem->begin_increment(1.0, u);
      CHECK(newton.solve(u).converged);
      condensed.problem->commit(u);
      condensed.problem->begin_increment(1.5, u);
      CHECK(newton.solve(u).converged);
    }
    const OptionScope scope;
    choose_linear_solver(*nodal.problem);
    Newton newton(*nodal.problem, nullptr);
    for (const double t : {1.0, 1.5}) {
      nodal.problem->begin_increment(t, v);
      CHECK(newton.solve(v).converged);
      if (t == 1.0) nodal.problem->commit(v);
    }
    const auto found = condensed.totals(u), other = nodal.totals(v);
    CHECK(found.stick_area > 0.05);
    CHECK(found.slip_area > 0.05);
    CHECK(std::abs(found.tangential_force[0]) > 0.05);
    shear.push_back(std::abs(found.tangential_force[0] / other.tangential_force[0] - 1.0));
    stick.push_back(std::abs(found.stick_area - other.stick_area) * n);
  }
  CHECK(shear[2] < 5e-3);
  CHECK(shear[2] < 0.5 * shear[0]);
  CHECK(stick[2] <= 2.0); // cells
}

TEST_CASE("history: a snapshot goes back, a state that is revisited has its tractions") {
  const OptionScope scope;
  Fixture fixture({.n = 12, .friction = coulomb});
  CondensedContact contact(*fixture.problem, {fixture.mortar});
  choose_linear_solver(*fixture.problem);
  CondensedNewton newton(*fixture.problem, contact, nullptr);
  const auto u = fixture.layout->new_vector(), kept = fixture.layout->new_vector();
  march(fixture, newton, u, {1.0, 1.2});
  const auto snapshot = fixture.problem->snapshot();
  VecCopy(u, kept);
  fixture.problem->begin_increment(1.5, u);
  CHECK(newton.solve(u).converged);
  const auto first = fixture.totals(u);
  CHECK(first.dissipation > 1e-6);
  const auto solved = fixture.layout->new_vector();
  VecCopy(u, solved);
  fixture.problem->commit(u);
  march(fixture, newton, u, {1.8});
  const double later = fixture.totals(u).tangential_force[0];
  CHECK(std::abs(later - first.tangential_force[0]) > 1e-3);

  fixture.problem->restore(snapshot);
  VecCopy(kept, u);
  fixture.problem->begin_increment(1.5, u);
  CHECK(newton.solve(u).converged);
  CHECK(fixture.totals(u).tangential_force[0] == doctest::Approx(first.tangential_force[0]).epsilon(1e-10));
  CHECK(fixture.totals(u).dissipation == doctest::Approx(first.dissipation).epsilon(1e-8));
  fixture.problem->roll_back();
  fixture.problem->revisit(1.5, solved);
  newton.recover(solved);
  CHECK(fixture.totals(solved).tangential_force[0] == doctest::Approx(first.tangential_force[0]).epsilon(1e-10));
  CHECK(fixture.totals(solved).dissipation == doctest::Approx(first.dissipation).epsilon(1e-8));
}
