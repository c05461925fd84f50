// Lists, maps, objects and alternatives: values, defaults, and every way of getting keys wrong.
#include "read.hpp"

#include <doctest/doctest.h>

using namespace amontons;

namespace {

struct Circle {
  double radius = 2.5;
};
struct Square {
  double side = 1.0;
  double tilt = 0.0;
};
struct Thing {
  std::string name;
  std::optional<int> count;
  Located<double> size = {7.0};
  std::variant<Circle, Square> shape;
};

ObjectRule<Circle> circle_rule() {
  return ObjectRule<Circle>().optional("radius", &Circle::radius, number("length", Range::above(0)), "Radius.");
}
ObjectRule<Square> square_rule() {
  return ObjectRule<Square>()
      .required("side", &Square::side, number("length"), "Side.")
      .optional("tilt", &Square::tilt, number("1"), "Tilt.");
}
TaggedRule<std::variant<Circle, Square>> shape_rule() {
  return TaggedRule<std::variant<Circle, Square>>()
      .tag("circle", circle_rule(), "Round.")
      .tag("square", square_rule(), "Not round.")
      .not_yet("star", "Use a circle.");
}
ObjectRule<Thing> thing_rule() {
  return ObjectRule<Thing>()
      .required("name", &Thing::name, text(""), "Its name.")
      .optional("count", &Thing::count, integer(), "How many.")
      .optional("size", &Thing::size, number("length"), "How large.")
      .optional("shape", &Thing::shape, shape_rule(), "Its shape.")
      .not_yet("colour", "Leave it out.");
}

bool has(const std::vector<std::string>& messages, const std::string& place, const std::string& part) {
  for (const auto& message : messages)
    if (message.starts_with(place) && message.find(part) != std::string::npos) return true;
  return false;
}

} // namespace

TEST_CASE("lists and their lengths") {
  const auto rule = list_of(number("1"), 2, 3);
  CHECK(read_well("[1, 2, 3]", rule) == std::vector<double>{1, 2, 3});
  check_refused("[1]", rule, "f:1:1: ", "must have at least 2 entries, but has 1");
  check_refused("[1, 2, 3, 4]", rule, "f:1:1: ", "must have at most 3 entries, but has 4");
  check_refused("1", rule, "f:1:1: ", "must be a list");
  check_refused("[1, a]", rule, "f:1:5: ", "\"a\"");
  check_refused("[]", list_of(number("1"), 1), "f:1:1: ", "at least 1 entry,");
}

TEST_CASE("maps, located values, names for the entries") {
  const auto rule = map_of("body", located(expression("1")));
  const auto value = read_well("{a: 1, b: 2*t}", rule);
  CHECK(value.at("b").value(3.0) == 6.0);
  CHECK(value.at("b").place.text() == "f:1:11");
  check_refused("[1]", rule, "f:1:1: ", "must be a map (body: value)");
  check_refused("{a: 1, a: 2}", rule, "f:1:8: ", "the key 'a' is written twice");
  Reading reading;
  reading.entry_names["a"].constants["rho"] = 5.0;
  const auto known = read_text("{a: 2*rho}", rule, reading);
  REQUIRE(known.messages.empty());
  CHECK(known.value.at("a").value(0.0) == 10.0);
  const auto elsewhere = read_text("{a: 2*rho, b: rho}", rule, reading);
  REQUIRE(elsewhere.messages.size() == 1);
  CHECK(elsewhere.messages[0].starts_with("f:1:15: b: "));
}

TEST_CASE("an object fills the members; what is absent keeps the struct's default") {
  const Rule<Thing> rule = thing_rule();
  const auto thing = read_well("{shape: {square: {side: 3}}, count: 4, name: n}", rule);
  CHECK(thing.name == "n");
  CHECK(thing.count == 4);
  CHECK(thing.size.value == 7.0);
  REQUIRE(std::holds_alternative<Square>(thing.shape));
  CHECK(std::get<Square>(thing.shape).side == 3.0);
  const auto plain = read_well("{name: n, size: 2}", rule);
  CHECK_FALSE(plain.count.has_value());
  CHECK(plain.size.place.text() == "f:1:17");
  REQUIRE(std::holds_alternative<Circle>(plain.shape));
  CHECK(std::get<Circle>(plain.shape).radius == 2.5);
}

TEST_CASE("keys that are unknown, missing, doubled or not in this release") {
  const Rule<Thing> rule = thing_rule();
  check_refused("{name: n, siez: 2}", rule, "f:1:11: ",
                "unknown key 'siez' in the deck. Did you mean 'size'? Allowed keys: name, count, size and shape.");
  check_refused("{size: 2}", rule, "f:1:1: ", "the key 'name' is missing in the deck: Its name. Add it (text).");
  check_refused("{name: n, name: m}", rule, "f:1:11: ", "the key 'name' is written twice in the deck, first in line 1");
  check_refused("{name: n, colour: red}", rule, "f:1:11: ", "'colour' is not in this release. Leave it out.");
  check_refused("3", rule, "f:1:1: ", "must be a map with the keys name, count, size and shape");
}

TEST_CASE("all faults come in one go, in the order of the file") {
  const auto result =
      read_text<Thing>("size: [1]\nshape:\n  circle: {radius: -1}\nsiez: 2\ncount: 1.5\n", thing_rule());
  REQUIRE(result.messages.size() == 5);
  CHECK(has(result.messages, "f:1:1: ", "'name' is missing"));
  CHECK(result.messages[1].starts_with("f:1:7: size must be a number"));
  CHECK(result.messages[2].starts_with("f:3:20: shape.circle.radius must be > 0"));
  CHECK(result.messages[3].starts_with("f:4:1: unknown key 'siez'"));
  CHECK(result.messages[4].starts_with("f:5:8: count must be a whole number"));
}

TEST_CASE("alternatives: tag with a map, tag alone, tag without value") {
  const Rule<std::variant<Circle, Square>> rule = shape_rule();
  CHECK(std::get<Circle>(read_well("{circle: {radius: 4}}", rule)).radius == 4.0);
  CHECK(std::get<Circle>(read_well("circle", rule)).radius == 2.5);
  CHECK(std::get<Circle>(read_well("{circle: }", rule)).radius == 2.5);
  check_refused("square", rule, "f:1:1: ", "the key 'side' is missing");
  check_refused("{circel: {}}", rule, "f:1:2: ", "unknown alternative 'circel'. Did you mean 'circle'?");
  check_refused("circel", rule, "f:1:1: ", "Choose one of circle and square, written {circle: {...}}.");
  check_refused("{circle: {}, square: {side: 1}}", rule, "f:1:1: ", "exactly one tag, but has 2");
  check_refused("{}", rule, "f:1:1: ", "exactly one tag, but has 0");
  check_refused("[circle]", rule, "f:1:1: ", "here stands a list");
  check_refused("star", rule, "f:1:1: ", "'star' is not in this release. Use a circle.");
  check_refused("{circle: {tilt: 1}}", rule,
                "f:1:11: ", "the key 'tilt' belongs to 'square' and means nothing in circle");
}

TEST_CASE("alternatives with a bare form") {
  using Value = std::variant<std::string, Circle>;
  const Rule<Value> by_name =
      TaggedRule<Value>().bare(text("name")).tag("circle", circle_rule(), "").not_yet("self", "Split it.");
  CHECK(std::get<std::string>(read_well("other", by_name)) == "other");
  CHECK(std::get<std::string>(read_well("circle", by_name)) == "circle");
  CHECK(std::get<Circle>(read_well("{circle: {}}", by_name)).radius == 2.5);
  check_refused("self", by_name, "f:1:1: ", "'self' is not in this release. Split it.");
  using Count = std::variant<int, Circle>;
  const Rule<Count> by_number = TaggedRule<Count>().bare(integer()).tag("circle", circle_rule(), "");
  CHECK(std::get<int>(read_well("12", by_number)) == 12);
  CHECK(std::get<Circle>(read_well("circle", by_number)).radius == 2.5);
}

TEST_CASE("a choice stands among the keys of its object") {
  struct Holder {
    std::variant<Circle, Square> shape;
    double weight = 1.0;
  };
  const Rule<Holder> rule =
      ObjectRule<Holder>().choice(&Holder::shape, shape_rule()).optional("weight", &Holder::weight, number("1"), "W.");
  const auto value = read_well("{square: {side: 2}, weight: 3}", rule);
  CHECK(std::get<Square>(value.shape).side == 2.0);
  CHECK(value.weight == 3.0);
  check_refused("{weight: 3}", rule, "f:1:1: ", "does not say what it is: add one of circle and square");
  check_refused("{circle: {}, square: {side: 1}}", rule, "f:1:14: ", "has both 'circle' and 'square'");
  check_refused("{star: {}}", rule, "f:1:2: ", "'star' is not in this release");
  const auto misspelt = read_text("{cirle: {}}", rule);
  CHECK(has(misspelt.messages, "f:1:2: ", "Did you mean 'circle'? Allowed keys: weight, circle and square."));
}

TEST_CASE("steps run between keys, checks only on sound objects") {
  int steps = 0, checks = 0;
  const Rule<Square> rule = square_rule()
                                .then([&steps](const DeckNode&, Square&, Reading&) { ++steps; })
                                .check([&checks](const DeckNode& node, const Square& square, Reading& reading) {
                                  ++checks;
                                  if (square.tilt > square.side) reading.fail(node.place, "too much tilt");
                                });
  check_refused("{side: 1, tilt: 2}", rule, "f:1:1: ", "too much tilt");
  CHECK(steps == 1);
  CHECK(checks == 1);
  check_refused("{side: a}", rule, "f:1:8: ", "");
  CHECK(steps == 2);
  CHECK(checks == 1);
}
