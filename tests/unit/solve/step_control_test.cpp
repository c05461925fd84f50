#include "solve/step_control.hpp"

#include <algorithm>
#include <doctest/doctest.h>
#include <vector>

using namespace amontons;

TEST_CASE("equal increments land on the declared times") {
  StepControl control({.begin = 1.0, .end = 2.0, .equal_increments = 4}, 1.0);
  for (const double expected : {1.25, 1.5, 1.75, 2.0}) {
    REQUIRE_FALSE(control.finished());
    CHECK(control.target() == doctest::Approx(expected).epsilon(1e-14));
    control.accepted(20);
  }
  CHECK(control.finished());
}

TEST_CASE("a cutback halves, lands on the declared times all the same, and growth comes back") {
  StepControl control({.begin = 0.0, .end = 1.0, .equal_increments = 2, .smallest = 0.01}, 0.0);
  CHECK(control.target() == 0.5);
  CHECK(control.rejected());
  CHECK(control.target() == 0.25);
  CHECK(control.rejected());
  CHECK(control.target() == 0.125);
  std::vector<double> times;
  while (!control.finished()) {
    control.accepted(3);
    times.push_back(control.now());
  }
  CHECK(times.front() == 0.125);
  CHECK(std::count(times.begin(), times.end(), 0.5) == 1);
  CHECK(times.back() == 1.0);
  CHECK(times.size() <= 5);
}

TEST_CASE("persistent failure ends") {
  StepControl control({.begin = 0.0, .end = 1.0, .equal_increments = 1, .smallest = 1e-3}, 0.0);
  int tries = 1;
  while (control.rejected())
    ++tries;
  CHECK(tries == 10); // 2^-9 is the last one above 1e-3
}

TEST_CASE("automatic increments grow when Newton is quick and shrink when it is slow") {
  const StepPlan plan{.begin = 0.0,
                      .end = 10.0,
                      .equal_increments = 0,
                      .first = 0.01,
                      .smallest = 1e-5,
                      .largest = 0.2,
                      .target_iterations = 8};
  StepControl quick(plan, 0.0), slow(plan, 0.0);
  quick.accepted(2);
  CHECK(quick.increment() == doctest::Approx(0.2));
  slow.accepted(32);
  CHECK(slow.increment() == doctest::Approx(0.05));
  while (!quick.finished()) {
    CHECK(quick.target() - quick.now() <= 2.0 + 1e-12);
    quick.accepted(1);
  }
}

TEST_CASE("an increment that is wanted shorter ends at the smallest, and growth can be limited") {
  StepControl control({.begin = 0.0, .end = 1.0, .equal_increments = 0, .first = 0.4, .smallest = 0.1}, 0.0);
  CHECK(control.shortened(0.5));
  CHECK(control.target() == doctest::Approx(0.2));
  control.accepted(1, 0.75);
  CHECK(control.increment() == doctest::Approx(0.15));
  CHECK(control.shortened(0.25));
  CHECK(control.target() - control.now() == doctest::Approx(0.1));
  CHECK_FALSE(control.shortened(0.5));
  CHECK(control.target() - control.now() == doctest::Approx(0.1));
}

TEST_CASE("a restart goes on inside a step with the increment it had") {
  StepControl control({.begin = 0.0, .end = 1.0, .equal_increments = 0, .first = 0.5}, 0.3, 0.1);
  CHECK(control.target() == doctest::Approx(0.4));
  StepControl equal({.begin = 0.0, .end = 1.0, .equal_increments = 4}, 0.5);
  CHECK(equal.target() == doctest::Approx(0.75));
}
