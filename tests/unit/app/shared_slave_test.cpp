// Two pairs whose slave surfaces meet at nodes, in every formulation: a uniform pressure stays one across them.
#include "contact/condensed_contact.hpp"
#include "contact/contact_form.hpp"
#include "contact/uzawa_multipliers.hpp"
#include "form/bulk.hpp"
#include "form/problem.hpp"
#include "material/elastic.hpp"
#include "solve/bounded_newton.hpp"
#include "solve/condensed_newton.hpp"
#include "solve/uzawa.hpp"
#include "solver_support.hpp"
#include "two_blocks.hpp"

#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

namespace {

/// The bottom of the upper block is two surfaces, "upper_bottom" and "right_bottom", that meet in the middle.
Mesh divided_blocks(int dim, int n) {
  auto raw = two_blocks(PETSC_COMM_WORLD, dim, n, n + n / 2, 0.0);
  if (!raw.groups.empty()) {
    const auto right = static_cast<std::int32_t>(raw.groups.size());
    raw.groups.push_back({"right_bottom", dim - 1, 0});
    for (auto& sub : raw.subs) {
      double middle = 0.0;
      for (const auto node : sub.nodes)
        middle += raw.coordinates[3 * std::size_t(node)] / double(sub.nodes.size());
      if (raw.groups[sub.group].name != "upper_bottom" || middle < 0.5) continue;
      --raw.groups[sub.group].num_elements;
      sub.group = right;
      ++raw.groups[right].num_elements;
    }
  }
  return distribute_mesh(PETSC_COMM_WORLD, raw, {{"upper_bottom", "lower_top"}, {"right_bottom", "lower_top"}}, 0);
}

struct Fixture {
  Mesh mesh;
  std::vector<NodeField> fields;
  std::unique_ptr<DofLayout> layout;
  std::unique_ptr<Problem> problem;
  std::vector<PairReport*> pairs;
  std::vector<MortarForm*> mortars;
  std::vector<ContactForm*> forms;

  Fixture(int dim, const Enforcement& enforcement, double alpha, bool has_friction) : mesh(divided_blocks(dim, 4)) {
    const Space space = dim == 2 ? Space::PlaneStress : Space::Solid;
    const std::vector<SmallLaw> laws = {Elastic{300.0, 0.0}, Elastic{100.0, 0.0}};
    std::vector<ContactPair> declared;
    for (const auto* slave : {"upper_bottom", "right_bottom"}) {
      ContactPair pair{.name = slave,
                       .slave = slave,
                       .master = std::string("lower_top"),
                       .enforcement = enforcement,
                       .projection = {},
                       .integration = SegmentIntegration{4},
                       .alpha = alpha,
                       .search_distance = 0.5,
                       .space = space,
                       .stiffness = {300.0, 100.0}};
      const auto first = static_cast<int>(fields.size());
      if (std::holds_alternative<Semismooth>(enforcement)) {
        pair.enforcement = Semismooth{first};
        fields.push_back(multiplier_nodes(mesh, slave, slave));
        for (int i = 0; has_friction && i < dim; ++i)
          fields.push_back(fields[first]);
      }
      if (has_friction)
        pair.friction =
            Friction{.law = Coulomb{.mu = 0.3, .cohesion = 0.0}, .factor = std::nullopt, .field = first + 1};
      declared.push_back(std::move(pair));
    }
    layout = std::make_unique<DofLayout>(mesh, std::vector<TiedGroup>{}, fields);
    std::vector<std::unique_ptr<Form>> all;
    all.push_back(std::make_unique<BulkForm>(*layout, space, laws));
    for (auto& pair : declared)
      if (enforcement.index() >= Enforcement(BoundConstraint{}).index())
        add(std::make_unique<MortarForm>(*layout, std::move(pair)), mortars, all);
      else
        add(std::make_unique<ContactForm>(*layout, std::move(pair)), forms, all);
    std::vector<PrescribedDisplacement> prescribed;
    for (int i = 0; i < dim; ++i) {
      prescribed.push_back({"bottom", i, Expression(0.0)});
      prescribed.push_back({"top", i, Expression(i == dim - 1 ? -0.03 : 0.0)});
    }
    problem = std::make_unique<Problem>(*layout, std::move(all), prescribed);
  }
  template <class Pair>
  void add(std::unique_ptr<Pair> form, std::vector<Pair*>& known, std::vector<std::unique_ptr<Form>>& all) {
    pairs.push_back(form.get());
    known.push_back(form.get());
    all.push_back(std::move(form));
  }

  SolveOutcome solve(Vec u) {
    const OptionScope scope;
    problem->begin_increment(1.0, u);
    const auto& enforcement = pairs[0]->pair().enforcement;
    if (std::holds_alternative<BoundConstraint>(enforcement)) {
      MortarTransform bounds(*problem, mortars);
      choose_bounded_solver(*problem);
      return BoundedNewton(*problem, bounds, nullptr).solve(u);
    }
    choose_linear_solver(*problem);
    if (std::holds_alternative<CondensedSemismooth>(enforcement)) {
      CondensedContact conditions(*problem, mortars);
      return CondensedNewton(*problem, conditions, nullptr).solve(u);
    }
    Newton newton(*problem, nullptr);
    if (!std::holds_alternative<Uzawa>(enforcement)) return newton.solve(u);
    UzawaMultipliers multipliers(mesh, forms);
    return UzawaLoop(*problem, newton, multipliers, 1e-10, 100).solve(u);
  }
};

} // namespace

TEST_CASE("pairs whose slave surfaces meet at nodes pass a uniform pressure on") {
  struct Formulation {
    Enforcement enforcement;
    double alpha;
    bool has_friction;
    double tolerance;
  };
  const std::vector<Formulation> formulations = {
      {Penalty{}, 1e5, false, 1e-4},           {Uzawa{}, 10.0, false, 1e-7},
      {Semismooth{0}, 1.0, false, 1e-9},       {Semismooth{0}, 1.0, true, 1e-9},
      {BoundConstraint{}, 1.0, false, 1e-9},   {CondensedSemismooth{}, 1.0, false, 1e-9},
      {CondensedSemismooth{}, 1.0, true, 1e-9}};
  const double pressure = 0.03 / (1.0 / 300.0 + 1.0 / 100.0); // springs in series
  for (const int dim : {2, 3})
    for (const auto& formulation : formulations) {
      CAPTURE(dim);
      CAPTURE(formulation.enforcement.index());
      CAPTURE(formulation.has_friction);
      Fixture fixture(dim, formulation.enforcement, formulation.alpha, formulation.has_friction);
      const auto u = fixture.layout->new_vector();
      const auto outcome = fixture.solve(u);
      CAPTURE(outcome.reason);
      CHECK(outcome.converged);
      const auto state = fixture.problem->state_at(u);
      for (auto* pair : fixture.pairs) {
        const auto totals = pair->totals(state);
        CHECK(totals.area == doctest::Approx(0.5).epsilon(1e-10));
        CHECK(totals.force[dim - 1] == doctest::Approx(0.5 * pressure).epsilon(formulation.tolerance));
        CHECK(totals.max_pressure == doctest::Approx(pressure).epsilon(formulation.tolerance));
      }
    }
}
