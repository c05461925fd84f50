// One degree of freedom driven through the return mapping: a block on a spring. For such a block the return mapping is
// the whole implicit step: with a driving force r at zero slip and a stiffness K, the slip solves r − K s = τ(p, s).
#include "friction/return_mapping.hpp"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <numbers>
#include <vector>

using namespace amontons;
using doctest::Approx;

namespace {

constexpr double a = 0.010, b = 0.015, pressure = 50e6, L = 8e-3, plate_rate = 1e-9, v0 = 1e-6; // m, Pa, s
constexpr double critical_stiffness = pressure * (b - a) / L; // A. Ruina, J. Geophys. Res. 88 (1983) 10359
constexpr double year = 365.25 * 86400;

RateAndState fault(StateEvolution evolution) {
  return {
      .mu = 0.6, .a = a, .b = b, .L = L, .v0 = v0, .theta_initial = -std::log(plate_rate / v0), .evolution = evolution};
}

/// A block without mass, pulled at the plate's rate through a spring k; `damping` η stands for radiated waves, force
/// per area and rate. One step: k (pull − slip_old − s) − η s / dt = τ(p, s).
class Slider {
 public:
  Slider(const RateAndState& law, double k, double damping, double perturbation)
      : law_(law), k_(k), damping_(damping), state_(initial_state(law_, {}, pressure)) {
    const double steady = pressure * (0.6 + (a - b) * std::log(plate_rate / v0)) + damping * plate_rate;
    stretch_ = steady / k + perturbation;
  }
  /// Returns the slip rate of the step.
  double step(double dt) {
    time_ += dt;
    const double r = k_ * (stretch_ + plate_rate * dt);
    const auto response = return_map(law_, {.dt = dt}, {r, 0, 0}, pressure, k_ + damping_ / dt, state_);
    stretch_ += plate_rate * dt - response.slip;
    state_ = response.state;
    traction_ = response.traction[0];
    return response.slip / dt;
  }
  double time() const { return time_; }
  double traction() const { return traction_; }

 private:
  FrictionLaw law_;
  double k_, damping_, stretch_, time_ = 0, traction_ = 0;
  FrictionState state_;
};

/// Growth rate of small oscillations about steady sliding, from successive maxima of ln(v / plate rate).
double growth_rate(StateEvolution evolution, double k, double dt, int num_periods) {
  const double period = 2 * std::numbers::pi * L / plate_rate * std::sqrt(a / (b - a));
  Slider slider(fault(evolution), k, 0, 1e-7);
  std::vector<std::pair<double, double>> maxima;
  double x_before = 0, x = 0;
  while (slider.time() < num_periods * period) {
    const double next = std::log(slider.step(dt) / plate_rate);
    if (x > x_before && x >= next && slider.time() > period) maxima.emplace_back(slider.time(), x);
    x_before = x;
    x = next;
  }
  REQUIRE(maxima.size() >= 3);
  REQUIRE(maxima.front().second > 1e-6);
  REQUIRE(maxima.back().second < 0.05); // still linear
  return std::log(maxima.back().second / maxima.front().second) / (maxima.back().first - maxima.front().first);
}

} // namespace

TEST_CASE(
    "rate and state: small oscillations decay above the critical stiffness and grow below, at the rate of theory") {
  // Linearized about steady sliding: growth = v (k_c − k) / (2 a p) for both laws. The implicit step damps a little:
  // the error is of first order in dt and extrapolated away.
  for (const auto evolution : {StateEvolution::Slip, StateEvolution::Ageing})
    for (const double ratio : {0.95, 1.05}) {
      CAPTURE(ratio);
      const double k = ratio * critical_stiffness;
      const double exact = plate_rate * (critical_stiffness - k) / (2 * a * pressure);
      const double coarse = growth_rate(evolution, k, 80e3, 12), fine = growth_rate(evolution, k, 40e3, 12);
      CHECK((fine > 0) == (ratio < 1));
      CHECK(2 * fine - coarse == Approx(exact).epsilon(0.03));
    }
}

TEST_CASE("rate and state: above the critical stiffness a pushed block returns to steady sliding") {
  for (const auto evolution : {StateEvolution::Slip, StateEvolution::Ageing}) {
    Slider slider(fault(evolution), 2 * critical_stiffness, 0, 5e-3);
    double v = 0;
    for (int i = 0; i < 20000; ++i)
      v = slider.step(1e5);
    CHECK(v == Approx(plate_rate).epsilon(1e-8));
    CHECK(slider.traction() == Approx(pressure * (0.6 + (a - b) * std::log(plate_rate / v0))).epsilon(1e-10));
  }
}

TEST_CASE("rate and state: stick-slip cycles at half the critical stiffness, period and slip rate of the differential "
          "equation") {
  // Integrated with LSODA at a relative tolerance of 1e-9, logarithm not regularized: periods 14.1687 and 13.0238
  // years, largest rates 0.8321 and 1.0216 m/s.
  struct Case {
    StateEvolution evolution;
    double years, fastest;
  };
  for (const auto& [evolution, years, fastest] :
       {Case{StateEvolution::Ageing, 14.1687, 0.8321}, Case{StateEvolution::Slip, 13.0238, 1.0216}}) {
    Slider slider(fault(evolution), 0.5 * critical_stiffness, 4.62443e6, 1e-5);
    std::vector<double> events;
    double v = plate_rate, largest = 0;
    bool is_fast = false;
    while (events.size() < 8 && slider.time() < 500 * year) {
      v = slider.step(std::min(2e-3 * L / v, 0.002 * year));
      if (events.size() >= 6) largest = std::max(largest, v);
      if (v > 1e-3 && !is_fast) events.push_back(slider.time());
      is_fast = is_fast ? v > 1e-6 : v > 1e-3;
    }
    REQUIRE(events.size() == 8);
    CHECK((events[7] - events[6]) / year == Approx(years).epsilon(5e-3));
    CHECK(largest == Approx(fastest).epsilon(0.02));
  }
}

TEST_CASE("coulomb: a block on a spring stops after the textbook's half swings") {
  // m = 1, k = 100, μ N = 2: each half swing loses 2 μ N / k = 0.04; it rests where |k x| < μ N.
  const double m = 1, k = 100, dt = 1e-6;
  const FrictionLaw law = Coulomb{.mu = 0.2};
  double x = 0.173, v = 0;
  std::vector<double> turning_points;
  for (double t = 0; t < 2; t += dt) { // m (Δx / dt − v) / dt + k (x + Δx) = −traction
    const auto response = return_map(law, {.dt = dt}, {m * v / dt - k * x, 0, 0}, 10, m / (dt * dt) + k, {});
    const double dx = std::copysign(response.slip, response.traction[0]);
    if (v != 0 && v * dx <= 0) turning_points.push_back(x);
    x += dx;
    v = dx / dt;
  }
  REQUIRE(turning_points.size() == 4);
  const double expected[] = {-0.133, 0.093, -0.053, 0.013};
  for (int i = 0; i < 4; ++i)
    CHECK(std::abs(turning_points[i] - expected[i]) < 1e-5);
  CHECK(v == 0);
}

TEST_CASE("static_kinetic: stick-slip of a block on a belt") {
  // m = k = N = 1, μ_s = 0.5, μ_k = 0.3, belt V = 0.2: slips for 3π/2, sticks for 2, x between 0.3 ± 0.2 √2.
  const double dt = 2e-5, belt = 0.2;
  const FrictionLaw law = StaticKinetic{.mu_s = 0.5, .mu_k = 0.3};
  double x = 0, v = 0, low = 1, high = -1, stuck = 0;
  FrictionState state{};
  std::vector<double> breaks;
  bool was_sticking = false;
  for (double t = 0; breaks.size() < 4 && t < 60; t += dt) { // Δx = V dt + slip on the belt
    const double stiffness = 1 / (dt * dt) + 1, drive = v / dt - x - stiffness * belt * dt;
    const auto response = return_map(law, {.dt = dt}, {drive, 0, 0}, 1, stiffness, state);
    state = response.state;
    const double dx = belt * dt + std::copysign(response.slip, drive);
    x += dx;
    v = dx / dt;
    const bool sticks = response.status == FrictionStatus::Stick;
    if (was_sticking && !sticks) breaks.push_back(t);
    if (breaks.size() == 3) {
      stuck += sticks ? dt : 0;
      low = std::min(low, x);
      high = std::max(high, x);
    }
    was_sticking = sticks;
  }
  REQUIRE(breaks.size() == 4);
  CHECK(breaks[3] - breaks[2] == Approx(1.5 * std::numbers::pi + 2).epsilon(1e-3));
  CHECK(stuck == Approx(2).epsilon(1e-3));
  CHECK(low == Approx(0.3 - 0.2 * std::sqrt(2)).epsilon(0.01));
  CHECK(high == Approx(0.3 + 0.2 * std::sqrt(2)).epsilon(1e-3));
}
