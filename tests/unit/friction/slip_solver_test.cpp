// The scalar equation of sliding where the law weakens faster than ε: which solution, and what is said about it.
#include "friction/slip_solver.hpp"
#include "samples.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using doctest::Approx;

namespace {

SlipSolution solve(const FrictionLaw& law, const FrictionContext& context, double p, double r, double epsilon,
                   const FrictionState& state = {}) {
  return solve_slip({law, context, p, r, epsilon, state});
}

} // namespace

TEST_CASE("slip weakening with W = 0.8 against ε = 0.4: stick, snap, and the range where both are possible") {
  // τ = 1 − 0.8 s for s < 1, 0.2 beyond; F(s) = r − 1 + 0.4 s, then r − 0.2 − 0.4 s.
  const FrictionLaw law = SlipWeakening{.mu_s = 1, .mu_k = 0.2, .D_c = 1};
  const auto below = solve(law, {}, 1, 0.55, 0.4);
  CHECK(below.s == 0);
  CHECK_FALSE(below.is_several);                 // F(1) = −0.05: no slip solution
  const auto both = solve(law, {}, 1, 0.9, 0.4); // also s = 0.25 and s = 1.75
  CHECK(both.s == 0);
  CHECK(both.is_several);
  const auto snap = solve(law, {}, 1, 1.1, 0.4);
  CHECK(snap.s == Approx(2.25).epsilon(1e-14));
  CHECK_FALSE(snap.is_several);
  // ε = 1.6 > W: stable, on the falling branch, F(s) = r − 1 − 0.8 s.
  const auto stable = solve(law, {}, 1, 1.1, 1.6);
  CHECK(stable.s == Approx(0.125).epsilon(1e-14));
  CHECK_FALSE(stable.is_several);
}

TEST_CASE("steep velocity weakening: stick, with slip possible beyond the tangent point") {
  // τ = 0.2 + 0.8 exp(−s), ε = 0.1. F has its maximum at s = ln 8 and there is r − 0.2 − 0.1 − 0.1 ln 8.
  const FrictionLaw law = VelocityWeakening{.mu_s = 1, .mu_k = 0.2, .v_c = 1};
  const double border = 0.3 + 0.1 * std::log(8.0);
  CHECK_FALSE(solve(law, {.dt = 1}, 1, border - 1e-6, 0.1).is_several);
  CHECK(solve(law, {.dt = 1}, 1, border + 1e-6, 0.1).is_several);
  CHECK(solve(law, {.dt = 1}, 1, 0.99, 0.1).s == 0);
  const auto loose = solve(law, {.dt = 1}, 1, 1.01, 0.1);
  CHECK(loose.s > std::log(8.0));
  CHECK_FALSE(loose.is_several);
}

TEST_CASE("static_kinetic: the slip after the drop is exact, stick wins between the limits") {
  const FrictionLaw law = StaticKinetic{.mu_s = 0.5, .mu_k = 0.3};
  CHECK(solve(law, {}, 10, 4.0, 2).s == 0);
  CHECK(solve(law, {}, 10, 4.0, 2, {1, 0}).s == Approx(0.5).epsilon(1e-14)); // was sliding
  CHECK(solve(law, {}, 10, 5.0, 2).s == 0);
  CHECK(solve(law, {}, 10, 5.0 * (1 + 1e-15), 2).s == Approx(1).epsilon(1e-12));
}

TEST_CASE("of many solutions the smallest is taken: against a brute-force search, every law that weakens") {
  int steep = 0, several = 0;
  for (const auto& [name, law] : sample_laws()) {
    CAPTURE(name);
    RandomPoint random(31);
    for (int i = 0; i < 150; ++i) {
      const auto context = random.context();
      const auto state = random.state(law);
      const double p = random.between(0.5, 5), epsilon = std::exp(random.between(-7, 0)), r = random.between(0.3, 4);
      if (steepest_weakening(law, context, p, r / epsilon, state) < epsilon) continue;
      ++steep;
      const auto solution = solve(law, context, p, r, epsilon, state);
      const SlipEquation equation{law, context, p, r, epsilon, state};
      const auto is_above = [&](double s) { return r - epsilon * s - equation.limit(s).tau > 0; };
      // s = 0 (static_kinetic apart), then a fine logarithmic grid.
      bool above = is_above(0);
      const bool starts_above = above;
      int crossings = 0;
      double first_low = 0, first_high = 0, low = 0;
      for (int k = 8000; k >= 0; --k) {
        const double s = equation.largest_slip() * std::exp(-0.01 * k);
        if (is_above(s) != above) {
          above = !above;
          if (crossings++ == 0) first_low = low, first_high = s;
        }
        low = s;
      }
      CHECK((solution.s > 0) == starts_above);
      CHECK(solution.is_several == (crossings > (starts_above ? 1 : 0)));
      if (starts_above && crossings > 0) {
        CHECK(solution.s >= first_low);
        CHECK(solution.s <= first_high * (1 + 1e-14));
      }
      several += solution.is_several;
    }
  }
  CHECK(steep > 100);
  CHECK(several > 20);
}

TEST_CASE("the residual is zero to rounding over 300 orders of magnitude of slip") {
  const FrictionLaw law = RateAndState{.mu = 0.6, .a = 0.004, .b = 0.003, .L = 1e-6, .v0 = 1e-6};
  for (double r = 1e-6; r < 2e3; r *= 3) { // p f ≈ 60
    const FrictionState state{0.2, 0};
    const auto solution = solve(law, {.dt = 1e-3}, 100, r, 1e3, state);
    CAPTURE(r);
    CHECK(std::abs(r - 1e3 * solution.s - solution.limit.tau) <= 1e-13 * r);
    CHECK(solution.s > 0);
  }
}
