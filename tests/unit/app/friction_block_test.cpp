// An elastic block pressed on another and pushed sideways: sticks below mu N, slides above with mu N exactly.
#include "contact/uzawa_multipliers.hpp"
#include "form/bulk.hpp"
#include "form/problem.hpp"
#include "material/elastic.hpp"
#include "solve/newton.hpp"
#include "solve/uzawa.hpp"
#include "two_blocks.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

namespace {

constexpr double mu = 0.4;

/// Pressed until t = 1, then pushed along x (and half of it along y in 3D) with the given number of increments.
struct Push {
  ContactTotals pressed, little, slid;
  double shear = 0.0; // ∫ |σ_t| at the end
  int most_iterations = 0;

  Push(int dim, const Enforcement& enforcement) {
    const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, dim, 3, 4, 0.0);
    const Space space = dim == 2 ? Space::PlaneStrain : Space::Solid;
    std::vector<PrescribedDisplacement> prescribed;
    for (int c = 0; c < dim; ++c)
      prescribed.push_back({"bottom", c, Expression(0.0)});
    prescribed.push_back({"top", dim - 1, Expression("-0.01*min(t,1)", {})});
    prescribed.push_back({"top", 0, Expression("0.002*max(t-1,0)", {})});
    if (dim == 3) prescribed.push_back({"top", 1, Expression("0.001*max(t-1,0)", {})});
    const bool unknown = std::holds_alternative<Semismooth>(enforcement);
    std::vector<NodeField> fields;
    if (unknown) fields.assign(1 + dim, multiplier_nodes(mesh, "interface", "upper_bottom"));
    const DofLayout layout(mesh, {}, fields);
    std::vector<std::unique_ptr<Form>> forms;
    forms.push_back(std::make_unique<BulkForm>(
        layout, space,
        std::vector<SmallLaw>{Elastic{100.0, 0.2}, Elastic{100.0, 0.2}}));
    ContactPair pair{.name = "interface",
                     .slave = "upper_bottom",
                     .master = std::string("lower_top"),
                     .enforcement = enforcement,
                     .projection = {},
                     .search_distance = 0.3,
                     .space = space,
                     .stiffness = {100.0, 100.0},
                     .friction = Friction{.law = Coulomb{.mu = mu}, .factor = std::nullopt, .field = unknown ? 1 : -1}};
    if (std::holds_alternative<Penalty>(enforcement)) pair.alpha = 30.0;
    auto contact = std::make_unique<ContactForm>(layout, pair);
    auto* form = contact.get();
    forms.push_back(std::move(contact));
    Problem problem(layout, std::move(forms), prescribed);
    for (const char* option :
         {"-pc_type", "-ksp_type", "-snes_linesearch_type"}) // other tests of this program may want symmetric ones
      PetscOptionsClearValue(nullptr, option);
    choose_linear_solver(problem);
    Newton newton(problem, nullptr);
    UzawaMultipliers multipliers(mesh, std::holds_alternative<Uzawa>(enforcement) ? std::vector<ContactForm*>{form}
                                                                                  : std::vector<ContactForm*>{});
    UzawaLoop loop(problem, newton, multipliers, 1e-11, 300);
    const auto u = layout.new_vector();
    for (const double time : {1.0, 1.2, 6.0, 11.0, 16.0}) {
      problem.begin_increment(time, u);
      const auto outcome = std::holds_alternative<Uzawa>(enforcement) ? loop.solve(u) : newton.solve(u);
      CAPTURE(time);
      CAPTURE(outcome.reason);
      REQUIRE(outcome.converged);
      most_iterations = std::max(most_iterations, outcome.newton);
      const auto totals = form->totals(problem.state_at(u));
      (time == 1.0 ? pressed : time == 1.2 ? little : slid) = totals;
      const auto samples = form->samples(problem.state_at(u));
      shear = 0.0;
      for (std::size_t i = 0; i < samples.size(); ++i)
        shear += std::hypot(samples.shear[i][0], samples.shear[i][1], samples.shear[i][2]) * samples.weight[i];
      MPI_Allreduce(MPI_IN_PLACE, &shear, 1, MPI_DOUBLE, MPI_SUM, mesh.comm);
      problem.commit(u);
    }
    for (const char* option : {"-pc_type", "-ksp_type", "-snes_linesearch_type"})
      PetscOptionsClearValue(nullptr, option);
  }
};

double tangential(const ContactTotals& totals) {
  return std::hypot(totals.tangential_force[0], totals.tangential_force[1], totals.tangential_force[2]);
}

} // namespace

TEST_CASE("a block pressed and pushed sticks below mu N and slides above with mu N") {
  for (const int dim : {2, 3})
    for (const Enforcement& enforcement : {Enforcement(Penalty{}), Enforcement(Uzawa{}), Enforcement(Semismooth{0})}) {
      CAPTURE(dim);
      CAPTURE(enforcement.index());
      const Push push(dim, enforcement);
      MESSAGE("dim " << dim << " enforcement " << enforcement.index() << " most iterations " << push.most_iterations);
      CHECK(push.little.force[dim - 1] > 0.1);
      CHECK(tangential(push.little) > 0.0);
      CHECK(tangential(push.little) < 0.5 * mu * push.little.force[dim - 1]);
      CHECK(push.little.stick_area > 0.3);
      CHECK(push.slid.stick_area == 0.0);
      CHECK(push.slid.slip_area > 0.8); // the trailing edge lifts
      CHECK(push.shear == doctest::Approx(mu * push.slid.force[dim - 1]).epsilon(1e-10));
      // In 3D the directions differ a little from point to point.
      CHECK(tangential(push.slid) == doctest::Approx(push.shear).epsilon(dim == 2 ? 1e-10 : 1e-3));
      CHECK(push.slid.tangential_force[0] < 0.0);
      CHECK(push.slid.dissipation > 0.0);
    }
}
