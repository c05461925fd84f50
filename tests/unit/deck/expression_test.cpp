// Expressions as decks use them: values against C++'s own arithmetic, and what must be refused.
#include "base/error.hpp"
#include "base/expression.hpp"

#include <array>
#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;

TEST_CASE("an expression has the value of the same formula in C++") {
  const Expression expression("a*sin(pi*x) + max(t-1, 0)*y^2 - z/2", {{"a", 3.0}});
  CHECK_FALSE(expression.is_constant());
  for (const double t : {0.0, 1.5}) {
    const std::array<double, 3> place = {0.3, -0.7, 2.0};
    const double exact = 3.0 * std::sin(M_PI * 0.3) + std::max(t - 1.0, 0.0) * 0.49 - 1.0;
    CHECK(expression(t, place) == doctest::Approx(exact).epsilon(1e-14));
  }
}

TEST_CASE("coordinates that are not given are zero, also after a call that gave them") {
  const Expression expression("1 + x + 10*y + 100*z", {});
  const std::array<double, 3> all = {1, 1, 1};
  const std::array<double, 2> two = {1, 1};
  CHECK(expression(0.0, all) == 112.0);
  CHECK(expression(0.0, two) == 12.0);
  CHECK(expression(0.0) == 1.0);
}

TEST_CASE("an expression without t, x, y, z is a constant, and copies share nothing that changes") {
  CHECK(Expression("2*a", {{"a", 4.0}}).is_constant());
  CHECK(Expression("2*a", {{"a", 4.0}})(7.0) == 8.0);
  CHECK(Expression("2*pi", {}).is_constant());
  CHECK(Expression(3.5)(1.0) == 3.5);
  CHECK(Expression()(1.0) == 0.0);
  const Expression original("t", {});
  const Expression copy = original;
  CHECK(original(2.0) == 2.0);
  CHECK(copy(3.0) == 3.0);
  CHECK(original(2.0) == 2.0);
}

TEST_CASE("what is not an expression is refused") {
  for (const char* text : {"time", "2*time", "2*", "(t", "t)", "1 2", "1,5", "x=2", "sin()", "", "a b", "\"text\""}) {
    CAPTURE(text);
    CHECK_THROWS_AS(Expression(text, {}), UserError);
  }
  for (const char* text : {"x==2", "x<=2", "x!=2", "x>=2 ? 1 : 0"}) {
    CAPTURE(text);
    CHECK_NOTHROW(Expression(text, {}));
  }
}

TEST_CASE("the message names the unknown word and the nearest known one") {
  try {
    Expression("2*stifness", {{"stiffness", 1.0}});
    FAIL("not refused");
  } catch (const UserError& error) {
    const std::string message = error.what();
    CHECK(message.find("\"stifness\"") != std::string::npos);
    CHECK(message.find("Did you mean 'stiffness'?") != std::string::npos);
    CHECK(message.find("Known names: t, x, y, z, pi and stiffness.") != std::string::npos);
  }
}
