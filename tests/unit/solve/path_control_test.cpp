#include "solve/path_control.hpp"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <functional>

using namespace amontons;

namespace {

struct March {
  int accepted = 0, rejected = 0;
  double sum = 0.0;
};

/// Goes from 0 to 1 with a given difference per increment [t, t + dt].
March march(double tolerance, double first, const std::function<double(double t, double dt)>& difference) {
  PathControl control(tolerance, 1.0);
  March march;
  double t = 0.0, dt = first;
  while (t < 1.0 - 1e-12 && march.accepted + march.rejected < 100000) {
    dt = std::min(dt, 1.0 - t);
    const double value = difference(t, dt);
    const auto verdict = control.judge(value, 0.0, dt);
    CHECK(verdict.factor >= 0.25);
    CHECK(verdict.factor <= (verdict.accepted ? 2.0 : 0.5));
    if (verdict.accepted) {
      control.spend(value, dt);
      march.sum += value;
      t += dt;
      ++march.accepted;
    } else
      ++march.rejected;
    dt *= verdict.factor;
  }
  CHECK(t == doctest::Approx(1.0));
  return march;
}

} // namespace

TEST_CASE("with a local error of second order the sum stays within the tolerance, which is used") {
  // Sum of c Δt² over n equal increments: c / n. Half of the tolerance, with the safety factor: n = c / (0.4
  // tolerance).
  for (const double tolerance : {0.1, 0.01, 0.001}) {
    const auto result = march(tolerance, 0.5, [](double, double dt) { return dt * dt; });
    CHECK(result.sum <= tolerance);
    CHECK(result.sum >= 0.3 * tolerance);
    CHECK(result.accepted <= 1.2 / (0.4 * tolerance) + 5);
    CHECK(result.rejected <= 12);
  }
}

TEST_CASE("ten times the tolerance costs a tenth of the increments") {
  const auto error = [](double t, double dt) { return (1.0 + t) * dt * dt; };
  const auto coarse = march(0.01, 0.1, error), fine = march(0.001, 0.1, error);
  CHECK(fine.accepted == doctest::Approx(10.0 * coarse.accepted).epsilon(0.2));
}

TEST_CASE("a start whose relative difference does not fall with the increment does not cut for ever") {
  // Contact that grows from a point is similar to itself: whole and halves differ by a fixed part of the load there.
  // The first increment may take a quarter of the reserve, 0.00125, and its share; then 0.1 Δt² / t = 0.4 · 0.01 Δt.
  const auto error = [](double t, double dt) { return t == 0.0 ? 0.3 * std::pow(dt, 0.75) : 0.1 * dt * dt / (t + dt); };
  const double first = std::pow(0.00125 / 0.3, 4.0 / 3.0), growth = 0.04;
  const auto result = march(0.01, 0.5, error);
  CHECK(result.sum <= 0.01);
  CHECK(result.rejected <= 15);
  CHECK(result.accepted <= 1.2 * std::log(1.0 / first) / growth);
}

TEST_CASE("events here and there are paid from the reserve, which is never overdrawn") {
  const auto error = [](double t, double dt) {
    const bool event = std::floor(10.0 * (t + dt)) > std::floor(10.0 * t);
    return event ? 0.02 * std::sqrt(dt) : 0.01 * dt * dt;
  };
  const auto result = march(0.01, 0.5, error);
  CHECK(result.sum <= 0.01);
}

TEST_CASE("a path that does not matter grows to the largest increments") {
  PathControl control(0.01, 1.0);
  CHECK(control.judge(0.0, 0.0, 0.1).accepted);
  CHECK(control.judge(0.0, 0.0, 0.1).factor == 2.0);
}

TEST_CASE("a difference of status rejects by itself, and what was taken comes back after a restart") {
  PathControl control(0.01, 1.0);
  CHECK_FALSE(control.judge(0.0, 0.05, 0.1).accepted);
  CHECK(control.judge(0.0, 0.05, 0.1).factor == doctest::Approx(0.25));
  CHECK(control.judge(0.0, 0.009, 0.1).accepted);
  control.spend(0.003, 0.1); // 0.0005 is in proportion
  CHECK(control.taken() == doctest::Approx(0.0025));
  PathControl other(0.01, 1.0);
  other.set_taken(control.taken());
  for (const double difference : {0.0005, 0.0011, 0.00113, 0.002})
    CHECK(other.judge(difference, 0.0, 0.1).accepted == control.judge(difference, 0.0, 0.1).accepted);
  CHECK(control.judge(0.0011, 0.0, 0.1).accepted); // 0.0005 + 0.0025 / 4
  CHECK_FALSE(control.judge(0.00113, 0.0, 0.1).accepted);
}
