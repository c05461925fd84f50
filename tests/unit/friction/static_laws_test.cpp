// Laws without rate and state against their closed forms, at the values that textbooks tabulate.
#include "friction/friction_law.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using doctest::Approx;

namespace {

FrictionLimit at(const FrictionLaw& law, double p, double s = 0.0, double factor = 1.0) {
  return friction_limit(law, {.dt = 1.0, .factor = factor}, p, s, {});
}

} // namespace

TEST_CASE("tresca: the limit knows neither pressure nor slip") {
  const Tresca law{.tau_max = 60};
  for (const double p : {0.0, 1.0, 1e6})
    for (const double s : {0.0, 1e9})
      CHECK(at(law, p, s).tau == 60);
  CHECK(at(law, 10, 0, 0.5).tau == 60); // no coefficient to multiply
}

TEST_CASE("coulomb: cohesion plus mu times pressure") {
  const Coulomb law{.mu = 0.3, .cohesion = 5};
  CHECK(at(law, 200).tau == Approx(65));
  CHECK(at(law, 200).dtau_dp == Approx(0.3));
  CHECK(at(law, 0).tau == 5);
  CHECK(at(law, 200, 0, 2).tau == Approx(125)); // the factor multiplies mu only
  CHECK(at(Coulomb{.mu = 0.0}, 1e9, 3).tau == 0);
}

TEST_CASE("orowan: Coulomb below the kink at tau_max / mu, constant above") {
  const Orowan law{.mu = 0.3, .tau_max = 60};
  CHECK(at(law, 100).tau == Approx(30));
  CHECK(at(law, 200).tau == Approx(60));
  CHECK(at(law, 200 * (1 - 1e-9)).dtau_dp == Approx(0.3));
  CHECK(at(law, 200 * (1 + 1e-9)).dtau_dp == 0);
  CHECK(at(law, 1e12).tau == 60);
  CHECK(at(Orowan{.mu = 0.3, .tau_max = 60, .cohesion = 9}, 170).tau == Approx(60));
}

TEST_CASE("shaw: 60 (1 - exp(-p / 200)), slope mu at zero, limit tau_max") {
  const Shaw law{.mu = 0.3, .tau_max = 60};
  CHECK(at(law, 100).tau == Approx(60 * (1 - std::exp(-0.5))));
  CHECK(at(law, 400).tau == Approx(60 * (1 - std::exp(-2.0))));
  CHECK(at(law, 0).dtau_dp == Approx(0.3));
  CHECK(at(law, 1e-9).tau == Approx(0.3e-9)); // no cancellation
  CHECK(at(law, 1e9).tau == 60);
  const Shaw cohesive{.mu = 0.3, .tau_max = 60, .cohesion = 10};
  CHECK(at(cohesive, 0).tau == 10);
  CHECK(at(cohesive, 0).dtau_dp == Approx(0.3));
  CHECK(at(cohesive, 1e9).tau == Approx(60));
  double below = -1;
  for (double p = 0; p < 2000; p += 50) { // monotone, and never above Orowan's bound
    const double tau = at(law, p).tau;
    CHECK(tau > below);
    CHECK(tau <= at(Orowan{.mu = 0.3, .tau_max = 60}, p).tau);
    below = tau;
  }
}

TEST_CASE("static_kinetic: drops when it breaks loose, stays down while it slides, recovers at rest") {
  const FrictionLaw law = StaticKinetic{.mu_s = 0.5, .mu_k = 0.3};
  const FrictionContext context{.dt = 1.0};
  const FrictionState rest = initial_state(law, context, 10);
  CHECK(friction_limit(law, context, 10, 0, rest).tau == Approx(5));
  const auto loose = friction_limit(law, context, 10, 1e-12, rest);
  CHECK(loose.tau == Approx(3));
  const auto sliding = friction_limit(law, context, 10, 0, loose.state);
  CHECK(sliding.tau == Approx(3));
  CHECK(friction_limit(law, context, 10, 0, sliding.state).tau == Approx(5)); // one increment without slip
  FrictionContext again = context;
  again.new_contact = true;
  CHECK(friction_limit(law, again, 10, 0, loose.state).tau == Approx(5)); // opened and closed
}
