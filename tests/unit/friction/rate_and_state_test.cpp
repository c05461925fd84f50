// Rate and state: velocity steps against the exact solution, the state against Runge-Kutta, limits of the
// regularization.
#include "friction/friction_law.hpp"

#include <cmath>
#include <doctest/doctest.h>
#include <vector>

using namespace amontons;
using doctest::Approx;

namespace {

constexpr double mu = 0.6, v0 = 1e-6, L = 2e-6, pressure = 10;

RateAndState rock(double a, double b, StateEvolution evolution) {
  return {.mu = mu, .a = a, .b = b, .L = L, .v0 = v0, .evolution = evolution};
}

struct VelocityStep {
  double begin, v;
};
const std::vector<VelocityStep> velocity_steps{{0, 1e-6}, {2, 1e-5}, {4, 4e-6}, {6, 2e-5}, {8, 5e-6}, {12, 1e-6}};

/// The friction coefficient at the given time, reached with `n` increments per velocity.
double coefficient_at(const RateAndState& law, double time, int n) {
  auto state = initial_state(law, {}, pressure);
  FrictionLimit limit;
  for (std::size_t i = 0; i < velocity_steps.size() && velocity_steps[i].begin < time; ++i) {
    const double end = i + 1 < velocity_steps.size() ? std::min(time, velocity_steps[i + 1].begin) : time;
    const double dt = (end - velocity_steps[i].begin) / n;
    for (int k = 0; k < n; ++k) {
      limit = friction_limit(law, {.dt = dt}, pressure, velocity_steps[i].v * dt, state);
      state = limit.state;
    }
  }
  return limit.tau / pressure;
}

/// θ after time dt at rate v by the classical Runge-Kutta method.
double integrate_theta(const RateAndState& law, double v, double dt, double theta) {
  const auto rate = [&](double th) {
    if (law.evolution == StateEvolution::Slip) return -v / law.L * (th + std::log(v / law.v0));
    return law.v0 / law.L * std::exp(-th) - v / law.L; // d ln Θ / dt = 1 / Θ − v / L
  };
  constexpr int n = 20000;
  const double h = dt / n;
  for (int i = 0; i < n; ++i) {
    const double k1 = rate(theta), k2 = rate(theta + 0.5 * h * k1), k3 = rate(theta + 0.5 * h * k2),
                 k4 = rate(theta + h * k3);
    theta += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return theta;
}

} // namespace

// Exact solutions at piecewise constant rate: Θ = L/v + (Θ0 − L/v) exp(−v t / L) (ageing), Θ = (L/v) (v Θ0 / L)^exp(−v
// t / L) (slip), evaluated to six digits for the velocity history of PyLith's manual test frictionslide.
TEST_CASE("velocity steps: exact whatever the number of increments") {
  struct Case {
    StateEvolution evolution;
    double a;
    std::vector<std::pair<double, double>> time_and_f;
  };
  const Case cases[] = {
      {StateEvolution::Ageing,
       0.016,
       {{2.1, .631596},
        {2.5, .615848},
        {4, .609215},
        {4.5, .602553},
        {6.2, .617117},
        {8, .611983},
        {9, .605675},
        {12, .606437},
        {14, .595817}}},
      {StateEvolution::Ageing, 0.008, {{2.1, .613175}, {2.5, .597428}, {4, .590795}, {8, .588017}, {14, .595817}}},
      {StateEvolution::Slip,
       0.016,
       {{2.1, .625969}, {2.5, .611478}, {4.5, .601501}, {6.2, .614569}, {9, .605072}, {14, .592895}}},
      {StateEvolution::Slip, 0.008, {{2.1, .607549}, {2.5, .593058}, {6.2, .590604}, {14, .592895}}}};
  for (const auto& one : cases)
    for (const auto& [time, f] : one.time_and_f)
      for (const int n : {1, 3, 40}) {
        CAPTURE(time);
        CHECK(std::abs(coefficient_at(rock(one.a, 0.012, one.evolution), time, n) - f) < 1e-6);
      }
}

TEST_CASE("direct effect a ln(v2 / v1), evolution effect -b ln(v2 / v1), steady state mu + (a - b) ln(v / v0)") {
  for (const auto evolution : {StateEvolution::Slip, StateEvolution::Ageing}) {
    const auto law = rock(0.008, 0.012, evolution);
    const double v1 = 3e-6, v2 = 8e-5;
    const auto steady = friction_limit(law, {.dt = 1e3}, pressure, v1 * 1e3, {0.7, 0});
    CHECK(steady.tau / pressure == Approx(mu + (0.008 - 0.012) * std::log(v1 / v0)).epsilon(1e-12));
    CHECK(steady.state[0] == Approx(-std::log(v1 / v0)));
    const double dt = 1e-9; // slip 4e-8 L: the state has no time to follow
    const auto jump = friction_limit(law, {.dt = dt}, pressure, v2 * dt, steady.state);
    CHECK((jump.tau - steady.tau) / pressure == Approx(0.008 * std::log(v2 / v1)).epsilon(1e-5));
    const auto evolved = friction_limit(law, {.dt = 1e3}, pressure, v2 * 1e3, jump.state);
    CHECK((evolved.tau - jump.tau) / pressure == Approx(-0.012 * std::log(v2 / v1)).epsilon(1e-5));
  }
}

TEST_CASE("the state at the end of an increment is the solution of its differential equation") {
  for (const auto evolution : {StateEvolution::Slip, StateEvolution::Ageing}) {
    const auto law = rock(0.008, 0.012, evolution);
    for (const double v : {1e-9, 1e-6, 3e-5})
      for (const double theta_old : {-2.0, 0.0, 1.5})
        for (const double dt : {0.01, 1.0}) {
          const auto limit = friction_limit(law, {.dt = dt}, pressure, v * dt, {theta_old, 0});
          CHECK(limit.state[0] == Approx(integrate_theta(law, v, dt, theta_old)).epsilon(1e-9));
        }
  }
}

TEST_CASE("a rate that changes within the increment: the state is of second order") {
  // v(t) = 1e-6 (2 + sin 3t); the increments know the slip only.
  const auto law = rock(0.008, 0.012, StateEvolution::Ageing);
  const auto slip_until = [](double t) { return 1e-6 * (2 * t - std::cos(3 * t) / 3); };
  const auto theta_with = [&](int n) {
    FrictionState state{0.5, 0};
    for (int i = 0; i < n; ++i) {
      const double begin = 2.0 * i / n, end = 2.0 * (i + 1) / n;
      state = friction_limit(law, {.dt = end - begin}, pressure, slip_until(end) - slip_until(begin), state).state;
    }
    return state[0];
  };
  const double t20 = theta_with(20), t40 = theta_with(40), t80 = theta_with(80);
  REQUIRE(std::abs(t20 - t40) > 1e-7);
  CHECK((t20 - t40) / (t40 - t80) == Approx(4).epsilon(0.05));
}

TEST_CASE("regularization: the logarithm at every rate that matters, zero at rest, no overflow on the way") {
  for (const auto evolution : {StateEvolution::Slip, StateEvolution::Ageing}) {
    const auto law = rock(0.016, 0.012, evolution);
    const double dt = 1.0;
    double below = 0;
    for (double log_s = -200; log_s < std::log(1e-3 * L); log_s += 5) { // no evolution of the slip law's state yet
      const auto limit = friction_limit(law, {.dt = dt}, pressure, std::exp(log_s), {});
      CHECK(limit.tau > below);
      below = limit.tau;
      const double f = mu + law.a * (log_s - std::log(v0)) + law.b * limit.state[0];
      if (f > 10 * law.a) CHECK(limit.tau / pressure == Approx(f).epsilon(1e-8));
    }
    CHECK(below / pressure > 0.4);
    const auto rest = friction_limit(law, {.dt = dt}, pressure, 0, {});
    CHECK(rest.tau == 0);
    CHECK(std::isfinite(rest.dtau_ds));
    // The slope at rest continues that of creep.
    const double tiny = 1e-30;
    const auto creep = friction_limit(law, {.dt = dt}, pressure, tiny, {});
    CHECK(creep.tau == Approx(rest.dtau_ds * tiny).epsilon(1e-6));
  }
}

TEST_CASE("regularization: slope at rest stays finite for the smallest direct effects") {
  const auto limit = friction_limit(rock(1e-4, 0.012, StateEvolution::Slip), {.dt = 1e-6}, pressure, 0, {});
  CHECK(std::isfinite(limit.dtau_ds));
  CHECK(limit.dtau_ds > 1e200);
}

TEST_CASE("healing at rest: the ageing law gains b ln(1 + v0 dt / L), the slip law nothing") {
  const FrictionContext wait{.dt = 1e4};
  const auto aged = friction_limit(rock(0.016, 0.012, StateEvolution::Ageing), wait, pressure, 0, {0, 0});
  CHECK(aged.state[0] == Approx(std::log(1 + v0 * 1e4 / L)));
  const auto kept = friction_limit(rock(0.016, 0.012, StateEvolution::Slip), wait, pressure, 0, {0.3, 0});
  CHECK(kept.state[0] == 0.3);
}

TEST_CASE("no time: slip at the reference rate, with a limit of mu + b theta to stick to") {
  for (const auto evolution : {StateEvolution::Slip, StateEvolution::Ageing}) {
    const auto law = rock(0.016, 0.012, evolution);
    const FrictionContext sudden{.dt = 0};
    const auto rest = friction_limit(law, sudden, pressure, 0, {0.5, 0});
    CHECK(rest.tau / pressure == Approx(mu + 0.012 * 0.5));
    CHECK(rest.state[0] == Approx(0.5));
    for (const double s : {0.1 * L, 5 * L}) { // the same as at v0 with the time that it takes
      const auto limit = friction_limit(law, sudden, pressure, s, {0.5, 0});
      const auto timed = friction_limit(law, {.dt = s / v0}, pressure, s, {0.5, 0});
      CHECK(limit.tau == Approx(timed.tau));
      CHECK(limit.state[0] == Approx(timed.state[0]));
    }
  }
}

TEST_CASE("contact begins with theta_initial, again after every opening") {
  auto law = rock(0.016, 0.012, StateEvolution::Slip);
  law.theta_initial = 2.5;
  const auto first = friction_limit(law, {.dt = 1, .new_contact = true}, pressure, 1e-3 * L, {-7, 0});
  const auto same = friction_limit(law, {.dt = 1}, pressure, 1e-3 * L, {2.5, 0});
  CHECK(first.tau == same.tau);
  CHECK(first.state == same.state);
}
