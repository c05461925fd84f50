// Schema and manual pages: they say what the rule does, with the defaults of the struct.
#include "base/error.hpp"
#include "deck/rule.hpp"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

using namespace amontons;
using Json = nlohmann::json;

namespace {

struct Law {
  double stiffness = 12.5;
};
struct Other {
  int cycles = 3;
};
struct Root {
  double length = 0.25;
  std::optional<double> width;
  std::variant<Law, Other> law;
  std::vector<double> point;
  std::map<std::string, Law> laws;
  std::vector<Law> list;
  std::string word = "b";
};

Rule<Root> root_rule() {
  const auto law = ObjectRule<Law>().optional("stiffness", &Law::stiffness, number("stress", Range::above(0)),
                                              "How stiff.", "Somebody (1900).");
  const auto other =
      ObjectRule<Other>().required("cycles", &Other::cycles, integer(Range::between(1, 9)), "How often.");
  const auto word = WordRule<std::string>().word("a", "a", "First.").word("b", "b", "Second.").not_yet("c", "Use a.");
  return ObjectRule<Root>()
      .required("length", &Root::length, number("length", Range::inside(0, 2)), "How long.")
      .optional("width", &Root::width, number("length"), "How wide.")
      .optional("law", &Root::law,
                TaggedRule<std::variant<Law, Other>>().tag("law", law, "A law.").tag("other", other, "Another."),
                "Which law.")
      .optional("point", &Root::point, list_of(number("length"), 2, 3), "Where.")
      .optional("laws", &Root::laws, map_of("name", Rule<Law>(law), 1), "Many laws.")
      .optional("list", &Root::list, list_of(Rule<Law>(law)), "A list of laws.")
      .optional("word", &Root::word, word, "A word.")
      .not_yet("later", "Wait.");
}

std::string page(const std::string& key) { return manual_page(*root_rule().shape, key); }
bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

} // namespace

TEST_CASE("the schema is JSON Schema 2020-12 with closed objects") {
  const auto schema = Json::parse(json_schema(*root_rule().shape, "Title"));
  CHECK(schema["$schema"] == "https://json-schema.org/draft/2020-12/schema");
  CHECK(schema["title"] == "Title");
  CHECK(schema["type"] == "object");
  CHECK(schema["additionalProperties"] == false);
  CHECK(schema["required"] == Json::array({"length"}));
  const auto& keys = schema["properties"];
  CHECK_FALSE(keys.contains("later"));
  CHECK(keys.size() == 7);
  CHECK(keys["length"]["anyOf"][0]["exclusiveMinimum"] == 0.0);
  CHECK(keys["length"]["anyOf"][0]["exclusiveMaximum"] == 2.0);
  CHECK(keys["length"]["anyOf"][1]["type"] == "string");
  CHECK(keys["length"]["description"] == "How long. Unit: length.");
  CHECK(keys["point"]["minItems"] == 2);
  CHECK(keys["point"]["maxItems"] == 3);
  CHECK(keys["laws"]["minProperties"] == 1);
  CHECK(keys["laws"]["additionalProperties"]["properties"].contains("stiffness"));
  CHECK(keys["word"]["oneOf"].size() == 2);
  CHECK(keys["word"]["oneOf"][0]["const"] == "a");
}

TEST_CASE("the schema's alternatives: one key, closed; a bare tag only where nothing is required") {
  const auto schema = Json::parse(json_schema(*root_rule().shape, ""));
  const auto& any = schema["properties"]["law"]["anyOf"];
  REQUIRE(any.size() == 3);
  CHECK(any[0]["const"] == "law");
  CHECK(any[1]["required"] == Json::array({"law"}));
  CHECK(any[1]["additionalProperties"] == false);
  CHECK(any[2]["required"] == Json::array({"other"}));
  CHECK(any[2]["properties"]["other"]["required"] == Json::array({"cycles"}));
}

TEST_CASE("defaults in schema and manual are those of the struct") {
  const auto schema = Json::parse(json_schema(*root_rule().shape, ""));
  const auto& keys = schema["properties"];
  CHECK(keys["law"]["default"] == Json({{"law", {{"stiffness", Law{}.stiffness}}}}));
  CHECK(keys["word"]["default"] == Root{}.word);
  CHECK_FALSE(keys["width"].contains("default"));
  CHECK_FALSE(keys["length"].contains("default"));
  CHECK_FALSE(keys["point"].contains("default"));
  CHECK(has(page("law.law.stiffness"), "default   12.5\n"));
  CHECK(has(page("word"), "default   \"b\"\n"));
  CHECK_FALSE(has(page("width"), "default"));
}

TEST_CASE("a manual page has type, unit, range, meaning and source") {
  const auto text = page("law.law.stiffness");
  CHECK(text.starts_with("law.law.stiffness\n"));
  CHECK(has(text, "meaning   How stiff.\n"));
  CHECK(has(text, "type      number\n"));
  CHECK(has(text, "unit      stress\n"));
  CHECK(has(text, "range     > 0\n"));
  CHECK(has(text, "required  no\n"));
  CHECK(has(text, "source    Somebody (1900).\n"));
  CHECK(has(page("law"), "other     Another.\n"));
  CHECK(has(page("length"), "required  yes\n"));
  CHECK(has(page("later"), "Not in this release. Wait.\n"));
}

TEST_CASE("paths: names of the user and indices may be given or left out") {
  CHECK(page("laws.steel.stiffness").starts_with("laws.<name>.stiffness\n"));
  CHECK(page("laws.stiffness").starts_with("laws.<name>.stiffness\n"));
  CHECK(page("list[2].stiffness").starts_with("list.stiffness\n"));
  CHECK(page("list.stiffness").starts_with("list.stiffness\n"));
}

TEST_CASE("a key that does not exist is refused with the nearest one") {
  try {
    page("law.other.cylces");
    FAIL("not refused");
  } catch (const UserError& error) {
    CHECK(has(error.what(), "there is no key 'cylces' in law.other. Did you mean 'cycles'? Keys there: cycles."));
  }
  CHECK_THROWS_AS(page("length.below"), UserError);
  CHECK_THROWS_AS(page("later.below"), UserError);
}

TEST_CASE("the overview has every key, also those of later releases") {
  const auto text = manual_overview(*root_rule().shape);
  for (const char* part :
       {"length ", "  law ", "    stiffness ", "later ", "not in this release: Wait.", "Default: 12.5."})
    CHECK_MESSAGE(has(text, part), part);
}
