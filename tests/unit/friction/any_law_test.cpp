// What holds for every law: derivatives, bounds, limits, registry.
#include "samples.hpp"

#include <cmath>
#include <doctest/doctest.h>
#include <map>
#include <set>

using namespace amontons;

TEST_CASE("derivatives agree with central differences at random points of every law") {
  for (const auto& [name, law] : sample_laws()) {
    CAPTURE(name);
    RandomPoint random(11);
    int with_p = 0, with_s = 0;
    for (int i = 0; i < 2000; ++i) {
      auto context = random.context();
      context.new_contact = random.with_chance(0.1);
      const auto state = random.state(law);
      const double p = random.between(0.1, 5), s = random.between(0.05, 2), h = 1e-6;
      const auto tau = [&](double p_at, double s_at) { return friction_limit(law, context, p_at, s_at, state).tau; };
      const auto limit = friction_limit(law, context, p, s, state);
      const double dp = (tau(p + h, s) - tau(p - h, s)) / (2 * h), ds = (tau(p, s + h) - tau(p, s - h)) / (2 * h);
      // A kink between the two points shows in a second difference of first order.
      const auto kinks = [&](double a, double b) { return std::abs(a - 2 * limit.tau + b) > 1e-2 * h; };
      if (kinks(tau(p - h, s), tau(p + h, s)) || kinks(tau(p, s - h), tau(p, s + h))) continue;
      CHECK(std::abs(limit.dtau_dp - dp) < 1e-8 * (1 + std::abs(dp)));
      CHECK(std::abs(limit.dtau_ds - ds) < 1e-8 * (1 + std::abs(ds)));
      with_p += std::abs(dp) > 1e-4;
      with_s += std::abs(ds) > 1e-4;
    }
    CHECK((with_p > 500) == (name != "tresca"));
    static const std::set<std::string> without_slip{"tresca", "coulomb", "orowan", "shaw", "static_kinetic"};
    CHECK((with_s > 500) == !without_slip.contains(name));
  }
}

TEST_CASE("Taylor: the remainder of the linearization in (p, s) is of second order") {
  const std::set<std::string> curved{"shaw",
                                     "velocity_weakening",
                                     "weakening_strengthening",
                                     "rate_and_state, slip law",
                                     "rate_and_state, ageing law",
                                     "prakash_clifton"};
  int seen = 0;
  for (const auto& [name, law] : sample_laws()) {
    if (!curved.contains(name)) continue;
    CAPTURE(name);
    ++seen;
    RandomPoint random(12);
    for (int i = 0; i < 20; ++i) {
      const FrictionContext context{.dt = random.between(0.2, 1)};
      const auto state = random.state(law);
      const double p = random.between(0.5, 2), s = random.between(0.2, 0.6), dp = 0.4, ds = 0.1;
      const auto limit = friction_limit(law, context, p, s, state);
      const auto remainder = [&](double h) {
        return friction_limit(law, context, p + h * dp, s + h * ds, state).tau - limit.tau -
               h * (limit.dtau_dp * dp + limit.dtau_ds * ds);
      };
      const double coarse = remainder(1e-2), fine = remainder(5e-3);
      if (std::abs(coarse) < 1e-7) continue; // the second derivative happens to vanish
      CHECK(coarse / fine == doctest::Approx(4).epsilon(0.1));
    }
  }
  CHECK(seen == static_cast<int>(curved.size()));
}

TEST_CASE("the slope at s = 0 is the one-sided limit") {
  for (const auto& [name, law] : sample_laws()) {
    CAPTURE(name);
    if (std::holds_alternative<StaticKinetic>(law)) continue; // drops at s = 0 by design
    RandomPoint random(13);
    for (int i = 0; i < 100; ++i) {
      const FrictionContext context{.dt = random.between(0.1, 1)};
      const auto state = random.state(law);
      const double p = random.between(0.1, 5), h = std::holds_alternative<RateAndState>(law) ? 1e-26 : 1e-7;
      const auto rest = friction_limit(law, context, p, 0, state), after = friction_limit(law, context, p, h, state);
      CHECK((after.tau - rest.tau) / h == doctest::Approx(rest.dtau_ds).epsilon(1e-5));
    }
  }
}

TEST_CASE("the bound on weakening holds, and is met within a factor of order one") {
  for (const auto& [name, law] : sample_laws()) {
    CAPTURE(name);
    RandomPoint random(14);
    double sharpest = 0;
    for (int i = 0; i < 500; ++i) {
      auto context = random.context();
      context.new_contact = random.with_chance(0.1);
      const auto state = random.state(law);
      const double p = random.between(0.1, 5), s_max = random.between(0.1, 3);
      const double bound = steepest_weakening(law, context, p, s_max, state);
      CHECK(bound >= 0);
      for (int k = 0; k < 60; ++k) {
        const double s = s_max * std::exp(-0.4 * k);
        const double weakening = -friction_limit(law, context, p, s, state).dtau_ds;
        CHECK(weakening <= bound * (1 + 1e-12) + 1e-12);
        if (bound > 0) sharpest = std::max(sharpest, weakening / bound);
      }
    }
    if (sharpest > 0) CHECK(sharpest > 0.2);
  }
}

TEST_CASE("the limit is never negative and finite: no slip, huge slip, no pressure, no time, no coefficient") {
  for (const auto& [name, law] : sample_laws()) {
    CAPTURE(name);
    RandomPoint random(15);
    for (const double dt : {0.0, 1e-12, 1.0, 1e12})
      for (const double p : {0.0, 1e-300, 1e-12, 1.0, 1e9})
        for (const double s : {0.0, 1e-300, 1e-15, 1.0, 1e6, 1e12})
          for (const double factor : {0.0, 1.0}) {
            const auto limit = friction_limit(law, {.dt = dt, .factor = factor}, p, s, random.state(law));
            CAPTURE(dt);
            CAPTURE(p);
            CAPTURE(s);
            CHECK(limit.tau >= 0);
            CHECK(std::isfinite(limit.tau));
            CHECK(std::isfinite(limit.dtau_dp));
            CHECK(std::isfinite(limit.dtau_ds));
            CHECK(std::isfinite(limit.state[0]));
          }
  }
}

TEST_CASE("no pressure: the cohesion is left, whatever the law remembers") {
  RandomPoint random(16);
  const std::map<std::string, double> cohesions{{"tresca", 0.7}, // does not know the pressure
                                                {"coulomb", 0.2},
                                                {"rate_and_state, slip law", 0.0},
                                                {"rate_and_state, ageing law", 0.0},
                                                {"rate_and_state, ageing law with cohesion", 0.3}};
  for (const auto& [name, law] : sample_laws())
    for (const double s : {0.0, 0.3}) {
      CAPTURE(name);
      const double cohesion = cohesions.contains(name) ? cohesions.at(name) : 0.1;
      CHECK(friction_limit(law, random.context(), 0, s, random.state(law)).tau == doctest::Approx(cohesion));
    }
}

TEST_CASE("a contact that begins is one whose old state is the initial state") {
  for (const auto& [name, law] : sample_laws()) {
    CAPTURE(name);
    RandomPoint random(17);
    for (int i = 0; i < 50; ++i) {
      auto context = random.context();
      const double p = random.between(0.1, 5), s = random.between(0, 1);
      const auto begun = friction_limit(law, context, p, s, initial_state(law, context, p));
      context.new_contact = true;
      const auto fresh = friction_limit(law, context, p, s, random.state(law));
      CHECK(fresh.tau == doctest::Approx(begun.tau).epsilon(1e-14));
      CHECK(fresh.state[0] == doctest::Approx(begun.state[0]).epsilon(1e-14));
    }
  }
}

TEST_CASE("state variables have names, and only those change") {
  const std::map<std::string, std::string> names{{"static_kinetic", "sliding"},
                                                 {"slip_weakening", "slip_since_contact"},
                                                 {"rate_and_state, slip law", "theta"},
                                                 {"rate_and_state, ageing law", "theta"},
                                                 {"rate_and_state, ageing law with cohesion", "theta"},
                                                 {"prakash_clifton", "resistance"}};
  for (const auto& [name, law] : sample_laws()) {
    CAPTURE(name);
    RandomPoint random(18);
    const auto found = state_names(law);
    REQUIRE(found.size() == (names.contains(name) ? 1 : 0));
    if (!found.empty()) CHECK(found[0] == names.at(name));
    const auto state = friction_limit(law, {.dt = 1}, 2, 0.5, random.state(law)).state;
    CHECK((state[0] != 0) == !found.empty());
    CHECK(state[1] == 0);
  }
}
