// The tree with positions: kinds, places of keys and values, paths, syntax errors.
#include "base/error.hpp"
#include "deck/node.hpp"

#include <doctest/doctest.h>

using namespace amontons;

namespace {

std::string syntax_message(const std::string& text) {
  try {
    parse_yaml(text, "f");
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

} // namespace

TEST_CASE("every node knows its kind, place and path") {
  const auto root = parse_yaml("a: 1\nb:\n  - x\n  - {c: [2, 3], d: }\n", "f");
  REQUIRE(root.kind == DeckNode::Kind::Map);
  REQUIRE(root.find("a"));
  CHECK(root.find("a")->text == "1");
  CHECK(root.find("a")->place.text() == "f:1:4");
  CHECK(root.find("e") == nullptr);
  const auto& list = *root.find("b");
  REQUIRE(list.kind == DeckNode::Kind::List);
  REQUIRE(list.items.size() == 2);
  const auto& map = list.items[1];
  CHECK(map.path == "b[1]");
  CHECK(map.find("c")->items[1].path == "b[1].c[1]");
  CHECK(map.find("c")->items[1].place.text() == "f:4:13");
  CHECK(map.find("d")->kind == DeckNode::Kind::Null);
  CHECK(map.find("d")->place.text() == "f:4:17");
}

TEST_CASE("place_of finds keys and items, and stops where the deck does") {
  const auto root = parse_yaml("a: 1\nb:\n  - x\n  - {c: [2, 3]}\n", "f");
  CHECK(place_of(root, {"b"}).text() == "f:2:1");
  CHECK(place_of(root, {"b", std::size_t(1), "c"}).text() == "f:4:6");
  CHECK(place_of(root, {"b", std::size_t(1), "c", std::size_t(1)}).text() == "f:4:13");
  CHECK(place_of(root, {"b", std::size_t(1), "no", "way"}).text() == "f:4:5");
  CHECK(place_of(root, {"b", std::size_t(7)}).text() == "f:2:1");
}

TEST_CASE("a key that is written twice is there twice") {
  const auto root = parse_yaml("a: 1\na: 2\n", "f");
  REQUIRE(root.keys.size() == 2);
  CHECK(root.find("a")->text == "1");
  CHECK(root.keys[1].place.text() == "f:2:1");
}

TEST_CASE("syntax errors have a place and a remedy") {
  for (const std::string text : {"a: [1, 2\n", "a: 1\n  b: 2\n", "\ta: 1\n", "a: *none\n", "a: \"x\n"}) {
    const auto message = syntax_message(text);
    CAPTURE(text);
    CAPTURE(message);
    CHECK(message.starts_with("f:"));
    CHECK(message.find("this is not YAML") != std::string::npos);
    CHECK(message.find("indentation") != std::string::npos);
  }
  CHECK(syntax_message("a: 1\nb: 1\n   c: 2\n").starts_with("f:3:5: "));
}

TEST_CASE("an empty file, two documents and endless aliases are refused") {
  CHECK(syntax_message("").find("the deck is empty") != std::string::npos);
  CHECK(syntax_message("# nothing\n").find("the deck is empty") != std::string::npos);
  CHECK(syntax_message("a: 1\n---\nb: 1\n").find("2 YAML documents") != std::string::npos);
  CHECK(syntax_message("a: &x [*x]\n").find("contains itself") != std::string::npos);
  CHECK(syntax_message("[1, 2]: 3\n").find("a key must be a plain word") != std::string::npos);
  std::string bomb = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 10; ++i) {
    const auto name = std::string("a").append(std::to_string(i)),
               inner = std::string("*a").append(std::to_string(i - 1));
    bomb += name + ": &" + name + " [" + inner;
    for (int j = 1; j < 10; ++j)
      bomb += ", " + inner;
    bomb += "]\n";
  }
  CHECK(syntax_message(bomb).find("instead of using aliases") != std::string::npos);
}
