// What a deck may say, as plain data: the documentation half of a declaration (deck/rule.hpp makes the reading half
// beside it). From a Shape come the checks of keys, the manual pages and the JSON Schema.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace amontons {

/// Interval of allowed numbers.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;
  bool high_open = false;

  bool contains(double value) const;
  bool is_everything() const;
  /// "> 0", ">= 1 and <= 12", "any" ...
  std::string text() const;

  static Range above(double low) { return {low, std::numeric_limits<double>::infinity(), true, false}; }
  static Range at_least(double low) { return {low, std::numeric_limits<double>::infinity(), false, false}; }
  static Range between(double low, double high) { return {low, high, false, false}; }
  static Range inside(double low, double high) { return {low, high, true, true}; }
  static Range above_up_to(double low, double high) { return {low, high, true, false}; }
};

struct Shape;
using ShapePtr = std::shared_ptr<const Shape>;

/// A key of an object, a tag of alternatives, a word of an enumeration.
struct Entry {
  std::string name = {};
  std::string sentence = {};
  std::string citation = {};
  ShapePtr shape = {}; // null for words, and for what this release does not have
  bool required = false;
  std::string default_value = {}; // as JSON; empty: none
  std::string instead = {};       // not empty: not in this release, and what to do instead
  bool available() const { return instead.empty(); }
};

struct Shape {
  enum class Kind { Number, Integer, Boolean, Text, Expression, Enumeration, List, Map, Object, Alternatives };

  Kind kind = Kind::Text;
  std::string meaning; // of a text ("name of a physical group"), or of a map's keys
  std::string unit;    // physical dimension of a number or expression; "1": none
  Range range;
  std::size_t min_items = 0; // of a list or map
  std::size_t max_items = std::numeric_limits<std::size_t>::max();
  ShapePtr element;           // of a list or map
  std::vector<Entry> entries; // keys of an object, tags of alternatives, words of an enumeration
  ShapePtr choice;            // of an object: alternatives of which exactly one tag stands among the keys
  ShapePtr bare;              // of alternatives: what may stand there without a tag

  /// Names of the entries that this release has.
  std::vector<std::string> names() const;
  const Entry* find(const std::string& name) const;
  /// All keys of an object that this release has, the tags of its choice included.
  std::vector<std::string> key_names() const;
};

/// "number", "list of text" ...: the type in words.
std::string type_name(const Shape& shape);

/// Shortest text that reads back as the same number.
std::string number_text(double value);

/// `text` in double quotes with JSON's escapes.
std::string json_quoted(const std::string& text);
/// `"name": value`, `{a, b}` and `[a, b]` of parts that are JSON already.
std::string json_pair(const std::string& name, const std::string& value);
std::string json_object(const std::vector<std::string>& pairs);
std::string json_list(const std::vector<std::string>& values);

/// JSON Schema (draft 2020-12) of a deck with the given root object, as text.
std::string json_schema(const Shape& root, const std::string& title);

/// Manual page of the key at a dotted path such as "contact.enforce.uzawa.alpha" (names that the user chooses, such as
/// a material's, and list indices may be left out). Throws UserError with the nearest match when there is no such key.
std::string manual_page(const Shape& root, const std::string& key);

/// All keys, one line each, indented by depth.
std::string manual_overview(const Shape& root);

} // namespace amontons
