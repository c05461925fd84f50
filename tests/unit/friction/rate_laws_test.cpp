// Laws that depend on slip rate or slip, without logarithms: closed forms, limits, memory of contact.
#include "friction/friction_law.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using doctest::Approx;

TEST_CASE("velocity_weakening: static at rest, kinetic at high rates, the exponential between") {
  const FrictionLaw law = VelocityWeakening{.mu_s = 0.5, .mu_k = 0.3, .v_c = 2};
  const auto f = [&](double dt, double s) { return friction_limit(law, {.dt = dt}, 10, s, {}).tau / 10; };
  CHECK(f(0.1, 0) == Approx(0.5));
  CHECK(f(0.1, 0.2) == Approx(0.3 + 0.2 * std::exp(-1.0))); // v = 2 = v_c
  CHECK(f(0.1, 1e3) == Approx(0.3));
  CHECK(f(1e-300, 1e-10) == Approx(0.3));
  CHECK(f(0, 0) == Approx(0.5)); // no time: no rate
  CHECK(f(0, 7) == Approx(0.5));
}

TEST_CASE("weakening_strengthening: smallest at v_c ln((mu_s - mu_k) / (kappa v_c))") {
  const WeakeningStrengthening law{.mu_s = 0.5, .mu_k = 0.3, .v_c = 0.4, .kappa = 0.05};
  const double dt = 0.5, v_min = 0.4 * std::log(0.2 / (0.05 * 0.4));
  REQUIRE(v_min > 0);
  const auto at = [&](double v) { return friction_limit(law, {.dt = dt}, 10, v * dt, {}); };
  CHECK(std::abs(at(v_min).dtau_ds) < 1e-12);
  CHECK(at(0.9 * v_min).dtau_ds < -1e-3);
  CHECK(at(1.1 * v_min).dtau_ds > 1e-3);
  CHECK(at(0).tau == Approx(5));
  CHECK(at(100).tau == Approx(10 * (0.3 + 5)));
  CHECK(friction_limit(law, {.dt = 0}, 10, 3, {}).tau == Approx(5));
  // κ = 0 is velocity weakening.
  const VelocityWeakening weakening{.mu_s = 0.5, .mu_k = 0.3, .v_c = 0.4};
  WeakeningStrengthening plain = law;
  plain.kappa = 0;
  for (const double s : {0.0, 0.1, 1.0})
    CHECK(friction_limit(plain, {.dt = dt}, 3, s, {}).tau ==
          Approx(friction_limit(weakening, {.dt = dt}, 3, s, {}).tau));
}

TEST_CASE("slip_weakening: peak, residual, and the work p mu_k S + p (mu_s - mu_k) D_c / 2") {
  const FrictionLaw law = SlipWeakening{.mu_s = 0.677, .mu_k = 0.525, .D_c = 0.4};
  const FrictionContext context{.dt = 1};
  const double p = 120, S = 1.0;
  auto state = initial_state(law, context, p);
  CHECK(friction_limit(law, context, p, 0, state).tau == Approx(0.677 * p));
  double work = 0, tau_old = 0.677 * p;
  constexpr int num_increments = 50; // the kink at D_c is hit, so the trapezoidal rule is exact
  for (int i = 0; i < num_increments; ++i) {
    const auto limit = friction_limit(law, context, p, S / num_increments, state);
    work += 0.5 * (tau_old + limit.tau) * S / num_increments;
    tau_old = limit.tau;
    state = limit.state;
  }
  CHECK(tau_old == Approx(0.525 * p));
  CHECK(state[0] == Approx(S));
  CHECK(work == Approx(p * 0.525 * S + 0.5 * p * (0.677 - 0.525) * 0.4).epsilon(1e-12));
  CHECK(friction_limit(law, {.dt = 1, .new_contact = true}, p, 0, state).tau == Approx(0.677 * p)); // healed when open
}

TEST_CASE(
    "prakash_clifton: after a pressure step the shear follows the exponential of slip, in any number of increments") {
  // tau(t) = 7.2 - 1.2 exp(-t / 0.1) for f = 0.6, L = 1e-4, v = 1e-3, pressure from 10 to 12.
  const FrictionLaw law = PrakashClifton{.mu = 0.6, .L = 1e-4};
  for (const int num_increments : {1, 7, 100}) {
    auto state = friction_limit(law, {.dt = 1, .new_contact = true}, 10, 0, {}).state;
    CHECK(state[0] == Approx(6));
    const double dt = 0.2 / num_increments;
    CHECK(friction_limit(law, {.dt = dt}, 12, 0, state).tau == Approx(6)); // no jump
    for (int i = 0; i < num_increments; ++i)
      state = friction_limit(law, {.dt = dt}, 12, 1e-3 * dt, state).state;
    CHECK(state[0] == Approx(7.2 - 1.2 * std::exp(-2.0)).epsilon(1e-12));
  }
}

TEST_CASE("prakash_clifton: a pressure ramp, to first order in the increment") {
  // tau = f (s(t) - r T) + (tau_0 - f s_0 + f r T) exp(-t / T), T = L / (v + v*).
  const double f = 0.6, L = 1e-4, v = 7e-4, creep = 3e-4, rate = 20, T = L / (v + creep), end = 0.15;
  const double exact = f * (10 + rate * end - rate * T) + f * rate * T * std::exp(-end / T);
  const FrictionLaw law = PrakashClifton{.mu = f, .L = L, .creep_rate = creep};
  double error_before = 0;
  for (const int n : {50, 100, 200}) {
    FrictionState state{6, 0};
    for (int i = 1; i <= n; ++i)
      state = friction_limit(law, {.dt = end / n}, 10 + rate * end * i / n, v * end / n, state).state;
    const double error = std::abs(state[0] - exact);
    CHECK(error < 0.01 * exact);
    if (error_before > 0) CHECK(error_before / error == Approx(2).epsilon(0.05));
    error_before = error;
  }
}

TEST_CASE("prakash_clifton: creep at rest, forgetting at zero pressure and with the contact") {
  const FrictionLaw law = PrakashClifton{.mu = 0.5, .L = 2, .creep_rate = 0.4};
  const FrictionState remembers{3, 0};
  CHECK(friction_limit(law, {.dt = 5}, 10, 0, remembers).tau == Approx(5 - 2 * std::exp(-1.0)));
  CHECK(friction_limit(law, {.dt = 0}, 10, 0, remembers).tau == Approx(3));
  CHECK(friction_limit(law, {.dt = 0}, 10, 1e9, remembers).tau == Approx(5));
  CHECK(friction_limit(law, {.dt = 5}, 0, 0, remembers).tau == 0);
  const auto fresh = friction_limit(law, {.dt = 5, .new_contact = true}, 10, 0.3, remembers);
  CHECK(fresh.tau == Approx(5));
  CHECK(fresh.dtau_dp == Approx(0.5)); // the initial state moves with the pressure
  CHECK(fresh.dtau_ds == 0);
}
