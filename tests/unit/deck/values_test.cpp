// Plain values: what numbers, texts, words and expressions accept, and what they answer to the rest.
#include "read.hpp"

#include <doctest/doctest.h>

using namespace amontons;

TEST_CASE("numbers") {
  const auto rule = number("stress");
  CHECK(read_well("210e3", rule) == 210e3);
  CHECK(read_well("-.5", rule) == -0.5);
  CHECK(read_well("+2", rule) == 2.0);
  CHECK(read_well("\"2*3+1\"", rule) == 7.0);
  check_refused("soft", rule, "f:1:1: ", "Known names");
  check_refused("210 GPa", rule, "f:1:1: ", "Numbers carry no units");
  check_refused("'0,3'", rule, "f:1:1: ", "Write decimals with a point");
  check_refused("nan", rule, "f:1:1: ", "not a finite number");
  check_refused(".inf", rule, "f:1:1: ", "cannot be read");
  check_refused("1e999", rule, "f:1:1: ", "");
  check_refused("\"1/0\"", rule, "f:1:1: ", "not a finite number");
  check_refused("2*t", rule, "f:1:1: ", "does not change");
  check_refused("\"\"", rule, "f:1:1: ", "must be a number");
  check_refused("[1]", rule, "f:1:1: ", "here stands a list");
  check_refused("{a: 1}", rule, "f:1:1: ", "here stands a map");
}

TEST_CASE("ranges, open and closed") {
  CHECK(Range::above(0).text() == "> 0");
  CHECK(Range::inside(-1, 0.5).text() == "> -1 and < 0.5");
  CHECK(Range{}.text() == "any");
  const auto open = number("1", Range::inside(-1, 0.5));
  CHECK(read_well("0.4999", open) == 0.4999);
  check_refused("0.5", open, "f:1:1: ", "must be > -1 and < 0.5, but is 0.5");
  check_refused("-1", open, "f:1:1: ", "must be > -1 and < 0.5, but is -1");
  const auto closed = number("1", Range::between(0, 1));
  CHECK(read_well("0", closed) == 0.0);
  CHECK(read_well("1", closed) == 1.0);
  check_refused("1.0001", closed, "f:1:1: ", ">= 0 and <= 1");
}

TEST_CASE("whole numbers") {
  const auto rule = integer(Range::at_least(1));
  CHECK(read_well("20", rule) == 20);
  CHECK(read_well("2e1", rule) == 20);
  CHECK(read_well("\"4*5\"", rule) == 20);
  check_refused("2.5", rule, "f:1:1: ", "must be a whole number, but is 2.5");
  check_refused("0", rule, "f:1:1: ", ">= 1");
  check_refused("3000000000", rule, "f:1:1: ", "but is 3e+09");
}

TEST_CASE("true and false, texts, names") {
  CHECK(read_well("true", boolean()));
  CHECK_FALSE(read_well("false", boolean()));
  check_refused("yes", boolean(), "f:1:1: ", "must be true or false");
  CHECK(read_well("a b", text("")) == "a b");
  CHECK(read_well("17", text("")) == "17");
  check_refused("\"\"", text("name of a group"), "f:1:1: ", "must be a text (name of a group)");
  check_refused("[a]", text(""), "f:1:1: ", "here stands a list");
  CHECK(read_well("pair_1-a", identifier("")) == "pair_1-a");
  check_refused("a b", identifier(""), "f:1:1: ", "letters, digits");
  check_refused("\"a/b\"", identifier(""), "f:1:1: ", "letters, digits");
  CHECK(read_well("1e-9", raw_text("")) == "1e-9");
  CHECK(read_well("\"\"", raw_text("")) == "");
  check_refused("[a]", raw_text(""), "f:1:1: ", "a single value");
}

TEST_CASE("expressions know the constants") {
  Reading reading;
  reading.constants = {{"a", 3.0}};
  const auto result = read_text("a*t", expression("length"), reading);
  REQUIRE(result.messages.empty());
  CHECK(result.value(2.0) == 6.0);
  CHECK(result.value.text() == "a*t");
  CHECK(read_well("5", expression("length"))(1.0) == 5.0);
  check_refused("a*t", expression("length"), "f:1:1: ", "Known names: t, x, y, z and pi");
  check_refused("[t]", expression("length"), "f:1:1: ", "here stands a list");
  check_refused("\"1/0\"", expression("length"), "f:1:1: ", "not a finite number");
}

TEST_CASE("a name that is missing for a reason is explained") {
  Reading reading;
  reading.missing = {{"rho", "Give a density."}};
  const auto with = read_text("rho*t", expression("1"), reading);
  REQUIRE(with.messages.size() == 1);
  CHECK(with.messages[0].find("Give a density.") != std::string::npos);
  const auto without = read_text("rhombus*t", expression("1"), reading);
  REQUIRE(without.messages.size() == 1);
  CHECK(without.messages[0].find("Give a density.") == std::string::npos);
}

TEST_CASE("constants use those above them and are known afterwards") {
  const auto values = read_well("{a: 2, b: \"3*a\", c_1: b^2}", constants_table());
  CHECK(values.at("b") == 6.0);
  CHECK(values.at("c_1") == 36.0);
  check_refused("{b: 3*a, a: 2}", constants_table(), "f:1:5: ", "\"a\"");
  for (const char* name : {"t", "x", "pi", "rho", "sin", "2a", "a b"})
    check_refused(std::string("{") + name + ": 1}", constants_table(), "f:1:2: ", "cannot be the name of a constant");
}

TEST_CASE("words") {
  const Rule<int> rule = WordRule<int>().word("small", 1, "").word("large", 2, "").not_yet("huge", "Use `large`.");
  CHECK(read_well("large", rule) == 2);
  CHECK(rule.show(1) == "\"small\"");
  check_refused("smal", rule, "f:1:1: ", "Did you mean 'small'? Allowed: small and large.");
  check_refused("huge", rule, "f:1:1: ", "'huge' is not in this release. Use `large`.");
  check_refused("[small]", rule, "f:1:1: ", "one of the words small and large");
}
