// Two blocks of different stiffness and mesh, one pressed on the other: what must not change the answer does not, and
// the formulations agree as far as they should.
#include "contact/uzawa_multipliers.hpp"
#include "form/bulk.hpp"
#include "form/problem.hpp"
#include "form/support.hpp"
#include "material/elastic.hpp"
#include "solve/newton.hpp"
#include "solve/uzawa.hpp"
#include "two_blocks.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <doctest/doctest.h>
#include <map>

using namespace amontons;
using namespace amontons::test;

namespace {

struct Variant {
  int dim = 2;
  Enforcement enforcement = Semismooth{0};
  double alpha = 1.0;
  double angle = 0.0;  // rotation of the whole scene, about a skew axis in 3D
  double length = 1.0; // unit of length
  double force = 1.0;  // unit of force
  bool upper_is_slave = true;
  bool floating = false; // the upper block is pushed by a traction and held by contact (and laterally at its top)
};

struct Answer {
  std::map<std::uint64_t, double> pressure; // by node key, all ranks' nodes on every rank
  double largest = 0.0;
  double force = 0.0;
  double penetration = 0.0;
  SolveOutcome outcome;
};

Eigen::Matrix3d rotation(const Variant& variant) {
  const Eigen::Vector3d axis = variant.dim == 2 ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(1, 2, 0.5).normalized();
  return Eigen::AngleAxisd(variant.angle, axis).toRotationMatrix();
}

std::map<std::uint64_t, double> gather_pressure(const Mesh& mesh, const ContactSamples& samples) {
  std::vector<std::uint64_t> keys;
  std::vector<double> values;
  for (std::size_t i = 0; i < samples.nodes.size(); ++i)
    if (samples.nodes[i] < mesh.num_owned) {
      keys.push_back(mesh.keys[samples.nodes[i]]);
      values.push_back(samples.nodal_pressure[i]);
    }
  int ranks = 1, mine = static_cast<int>(keys.size());
  MPI_Comm_size(mesh.comm, &ranks);
  std::vector<int> counts(ranks), offsets(ranks + 1, 0);
  MPI_Allgather(&mine, 1, MPI_INT, counts.data(), 1, MPI_INT, mesh.comm);
  for (int r = 0; r < ranks; ++r)
    offsets[r + 1] = offsets[r] + counts[r];
  std::vector<std::uint64_t> all_keys(offsets[ranks]);
  std::vector<double> all_values(offsets[ranks]);
  MPI_Allgatherv(keys.data(), mine, MPI_UINT64_T, all_keys.data(), counts.data(), offsets.data(), MPI_UINT64_T,
                 mesh.comm);
  MPI_Allgatherv(values.data(), mine, MPI_DOUBLE, all_values.data(), counts.data(), offsets.data(), MPI_DOUBLE,
                 mesh.comm);
  std::map<std::uint64_t, double> pressure;
  for (std::size_t i = 0; i < all_keys.size(); ++i)
    pressure[all_keys[i]] = all_values[i];
  return pressure;
}

Answer solve(const Variant& variant) {
  auto raw = two_blocks(PETSC_COMM_WORLD, variant.dim, 4, 6, 0.0);
  const auto turn = rotation(variant);
  for (std::size_t i = 0; i + 2 < raw.coordinates.size(); i += 3) {
    Eigen::Map<Eigen::Vector3d> x(&raw.coordinates[i]);
    x = (variant.length * (turn * x + Eigen::Vector3d(0.3, -0.7, variant.dim == 2 ? 0.0 : 0.2))).eval();
  }
  const auto mesh = distribute_mesh(PETSC_COMM_WORLD, raw, {{"upper_bottom", "lower_top"}}, 0);
  const Space space = variant.dim == 2 ? Space::PlaneStrain : Space::Solid;
  const double stress = variant.force / (variant.length * variant.length);

  std::vector<PrescribedDisplacement> prescribed;
  Eigen::Vector3d down = Eigen::Vector3d::Zero();
  down[variant.dim - 1] = -0.02 * variant.length;
  const Eigen::Vector3d push = turn * down;
  for (int c = 0; c < variant.dim; ++c) {
    prescribed.push_back({"bottom", c, Expression(0.0)});
    if (!variant.floating)
      prescribed.push_back({"top", c, Expression(push[c])});
    else if (c < variant.dim - 1)
      prescribed.push_back({"top", c, Expression(0.0)});
  }
  std::vector<NodeField> fields;
  const std::string slave = variant.upper_is_slave ? "upper_bottom" : "lower_top";
  if (std::holds_alternative<Semismooth>(variant.enforcement))
    fields.push_back(multiplier_nodes(mesh, "interface", slave));
  const DofLayout layout(mesh, {}, fields);
  const std::vector<SmallLaw> laws = {Elastic{300.0 * stress, 0.2},
                                        Elastic{100.0 * stress, 0.4}};

  std::vector<std::unique_ptr<Form>> forms;
  forms.push_back(std::make_unique<BulkForm>(layout, space, laws));
  if (variant.floating) {
    class Push : public Form { // a dead force on the top nodes of the upper block
     public:
      explicit Push(const DofLayout& l) : layout_(l) {}
      const char* name() const override { return "loads"; }
      void couple(Coupling&) const override {}
      void add_residual(const State&, Residual& residual) override {
        const int d = layout_.dim();
        for (const auto node : layout_.mesh().node_groups.at("top"))
          if (node < layout_.mesh().num_owned) residual.nodal()[std::size_t(node) * d + d - 1] += 0.1;
      }
      void add_tangent(const State&, Tangent&) override {}
      bool tangent_is_constant() const override { return true; }

     private:
      const DofLayout& layout_;
    };
    forms.push_back(std::make_unique<Push>(layout));
    forms.push_back(std::make_unique<SupportForm>(layout, find_floating_bodies(mesh, prescribed, false),
                                                  std::vector<double>{300.0, 100.0}));
  }
  ContactPair pair{.name = "interface",
                   .slave = slave,
                   .master = std::string(variant.upper_is_slave ? "lower_top" : "upper_bottom"),
                   .enforcement = variant.enforcement,
                   .projection = {},
                   .space = space,
                   .stiffness = {}};
  pair.alpha = variant.alpha;
  pair.search_distance = 0.3 * variant.length;
  pair.stiffness = {300.0 * stress, 100.0 * stress};
  pair.holds_floating_body = variant.floating;
  auto contact = std::make_unique<ContactForm>(layout, pair);
  auto* form = contact.get();
  forms.push_back(std::move(contact));
  Problem problem(layout, std::move(forms), prescribed);
  choose_linear_solver(problem);
  Newton newton(problem, nullptr);
  const auto u = layout.new_vector();
  problem.begin_increment(1.0, u);
  Answer answer;
  if (std::holds_alternative<Uzawa>(variant.enforcement)) {
    UzawaMultipliers multipliers(mesh, {form});
    UzawaLoop loop(problem, newton, multipliers, 1e-10, 200);
    answer.outcome = loop.solve(u);
  } else {
    answer.outcome = newton.solve(u);
  }
  const auto state = problem.state_at(u);
  const auto totals = form->totals(state);
  answer.pressure = gather_pressure(mesh, form->samples(state));
  answer.largest = totals.max_pressure;
  answer.penetration = totals.largest_penetration;
  answer.force = std::hypot(totals.force[0], totals.force[1], totals.force[2]);
  return answer;
}

double difference(const Answer& a, const Answer& b, double scale = 1.0) {
  REQUIRE(a.pressure.size() == b.pressure.size());
  double largest = 0.0;
  for (const auto& [key, pressure] : a.pressure)
    largest = std::max(largest, std::abs(pressure - scale * b.pressure.at(key)));
  return largest / a.largest;
}

} // namespace

TEST_CASE("rotation and translation of the whole scene change nothing") {
  for (const int dim : {2, 3}) {
    const auto straight = solve({.dim = dim});
    const auto turned = solve({.dim = dim, .angle = 0.65});
    CHECK(straight.outcome.converged);
    CHECK(turned.outcome.converged);
    CHECK(straight.largest > 1.0);
    CHECK(difference(straight, turned) < 1e-9);
  }
}

TEST_CASE("units change nothing: from micrometre-newton to metre-meganewton") {
  for (const Enforcement& enforcement : {Enforcement(Semismooth{0}), Enforcement(Penalty{}), Enforcement(Uzawa{})}) {
    const auto base = solve({.enforcement = enforcement});
    for (const auto& [length, force] : {std::pair{1e6, 1.0}, std::pair{1e-3, 1e-6}}) {
      const auto other = solve({.enforcement = enforcement, .length = length, .force = force});
      CHECK(other.outcome.converged);
      CHECK(other.outcome.newton == base.outcome.newton);
      CHECK(difference(base, other, length * length / force) < 1e-8);
    }
  }
}

TEST_CASE("uzawa and semismooth have the same discrete solution; penalty's penetration goes like 1/alpha") {
  for (const int dim : {2, 3}) {
    const auto exact = solve({.dim = dim, .alpha = 5.0});
    const auto uzawa = solve({.dim = dim, .enforcement = Uzawa{}, .alpha = 5.0});
    CHECK(uzawa.outcome.converged);
    CHECK(uzawa.outcome.outer > 1);
    CHECK(difference(exact, uzawa) < 1e-8);
    const auto soft = solve({.dim = dim, .enforcement = Penalty{}, .alpha = 50.0});
    const auto hard = solve({.dim = dim, .enforcement = Penalty{}, .alpha = 500.0});
    CHECK(difference(exact, soft) < 0.02);
    CHECK(difference(exact, hard) < 0.02);
    CHECK(hard.penetration > 0.0);
    CHECK(soft.penetration / hard.penetration == doctest::Approx(10.0).epsilon(0.1));
  }
}

TEST_CASE("exchange of slave and master keeps the force") {
  for (const int dim : {2, 3}) {
    const auto one = solve({.dim = dim}), other = solve({.dim = dim, .upper_is_slave = false});
    CHECK(other.outcome.converged);
    CHECK(one.force == doctest::Approx(other.force).epsilon(5e-3));
  }
}

TEST_CASE("a body held by contact alone carries exactly its load") {
  for (const Enforcement& enforcement : {Enforcement(Semismooth{0}), Enforcement(Penalty{}), Enforcement(Uzawa{})})
    for (const int dim : {2, 3}) {
      const auto answer = solve({.dim = dim, .enforcement = enforcement, .floating = true});
      CAPTURE(enforcement.index());
      CAPTURE(dim);
      CAPTURE(answer.outcome.reason);
      CHECK(answer.outcome.converged);
      CHECK(answer.force == doctest::Approx(0.1 * (dim == 2 ? 7 : 49)).epsilon(1e-8));
    }
}
