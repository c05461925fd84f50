// Unknown multipliers held and updated by Uzawa's loop, on the layout of the equations that have them unknown.
#include "contact/uzawa_multipliers.hpp"
#include "form/bulk.hpp"
#include "form/problem.hpp"
#include "material/elastic.hpp"
#include "solve/newton.hpp"
#include "solve/uzawa.hpp"
#include "solver_support.hpp"
#include "two_blocks.hpp"

#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

namespace {

/// A round block pressed on a flat one and pushed sideways, so that with friction a part of what touches slides.
struct Blocks {
  Mesh mesh;
  std::vector<NodeField> fields;
  std::unique_ptr<DofLayout> layout;
  std::unique_ptr<Problem> problem;
  ContactForm* form = nullptr;
  VecHandle u;

  Blocks(int dim, const Integration& integration, const std::optional<FrictionLaw>& law)
      : mesh(round_on_flat(dim, dim == 2 ? 12 : 4)) {
    fields.assign(law ? 1 + dim : 1, multiplier_nodes(mesh, "interface", "upper_bottom"));
    layout = std::make_unique<DofLayout>(mesh, std::vector<TiedGroup>{}, fields);
    const Space space = dim == 2 ? Space::PlaneStrain : Space::Solid;
    ContactPair pair{.name = "interface",
                     .slave = "upper_bottom",
                     .master = std::string("lower_top"),
                     .enforcement = Semismooth{0},
                     .projection = {},
                     .integration = integration,
                     .search_distance = 0.5,
                     .space = space,
                     .stiffness = {300.0, 100.0}};
    if (law) pair.friction = Friction{.law = *law, .factor = std::nullopt, .field = 1};
    auto contact = std::make_unique<ContactForm>(*layout, std::move(pair));
    form = contact.get();
    std::vector<std::unique_ptr<Form>> forms;
    forms.push_back(
        std::make_unique<BulkForm>(*layout, space, std::vector<SmallLaw>{Elastic{300.0, 0.2}, Elastic{100.0, 0.3}}));
    forms.push_back(std::move(contact));
    std::vector<PrescribedDisplacement> prescribed;
    for (int c = 0; c < dim; ++c) {
      prescribed.push_back({"bottom", c, Expression(0.0)});
      prescribed.push_back({"top", c, Expression(c == dim - 1 ? -0.03 : c == 0 ? 0.008 : 0.0)});
    }
    problem = std::make_unique<Problem>(*layout, std::move(forms), prescribed);
    u = layout->new_vector();
  }
  void start() {
    VecSet(u, 0.0);
    problem->roll_back();
    problem->begin_increment(1.0, u);
  }
};

} // namespace

TEST_CASE("Uzawa's loop on unknown multipliers that are held ends at the solution of their own equations") {
  for (const int dim : {2, 3})
    for (const Integration& integration : {Integration(FacetIntegration{}), Integration(SegmentIntegration{})})
      for (const bool slides : {false, true}) {
        CAPTURE(dim);
        CAPTURE(integration.index());
        CAPTURE(slides);
        const OptionScope scope;
        Blocks blocks(dim, integration, slides ? std::optional<FrictionLaw>(Coulomb{.mu = 0.2}) : std::nullopt);
        choose_linear_solver(*blocks.problem);
        Newton newton(*blocks.problem, nullptr);
        blocks.start();
        REQUIRE(newton.solve(blocks.u).converged);
        VecHandle solution;
        VecDuplicate(blocks.u, solution.put());
        VecCopy(blocks.u, solution);
        const auto totals = blocks.form->totals(blocks.problem->state_at(blocks.u));
        CHECK(totals.max_pressure > 1.0);
        if (slides) CHECK((totals.stick_area > 0.0 && totals.slip_area > 0.0));

        UzawaMultipliers multipliers(blocks.mesh, {blocks.form});
        const auto there = multipliers.new_vector(), next = multipliers.new_vector();
        multipliers.get(there);
        multipliers.updated(blocks.problem->state_at(blocks.u), next);
        VecAXPY(next, -1.0, there);
        CHECK(largest(next) < 1e-7 * largest(there));

        blocks.start();
        CHECK(newton.imbalance(blocks.u) > 1e-3);
        UzawaLoop loop(*blocks.problem, newton, multipliers, 1e-11, 300);
        const auto outcome = loop.solve(blocks.u);
        CAPTURE(outcome.reason);
        CHECK(outcome.converged);
        CHECK(outcome.outer > 3);
        blocks.form->release_multipliers();
        CHECK(newton.imbalance(blocks.u) < 1e-8);
        VecAXPY(blocks.u, -1.0, solution);
        CHECK(largest(blocks.u) < 1e-7 * largest(solution));
      }
}
