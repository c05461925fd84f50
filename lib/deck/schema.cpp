// JSON Schema (draft 2020-12) from a Shape. Editors use it for completion and hints; the reader stays the judge,
// because a schema cannot check expressions or the links between parts of a deck.
#include "deck/shape.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace amontons {

namespace {

using Json = nlohmann::ordered_json;

Json schema_of(const Shape& shape);

void add_range(Json& json, const Range& range) {
  if (std::isfinite(range.low)) json[range.low_open ? "exclusiveMinimum" : "minimum"] = range.low;
  if (std::isfinite(range.high)) json[range.high_open ? "exclusiveMaximum" : "maximum"] = range.high;
}

/// A number, or an expression in quotes.
Json number_or_text(Json number, const std::string& what) {
  return {{"anyOf", Json::array({std::move(number), {{"type", "string"}, {"description", what}}})}};
}

Json entry_schema(const Entry& entry) {
  Json json = schema_of(*entry.shape);
  std::string description = entry.sentence;
  if (!entry.shape->unit.empty() && entry.shape->unit != "1") description += " Unit: " + entry.shape->unit + ".";
  if (!entry.citation.empty()) description += " " + entry.citation;
  if (!description.empty()) json["description"] = description;
  if (!entry.default_value.empty()) json["default"] = Json::parse(entry.default_value);
  return json;
}

/// The words or tags with their sentences, where JSON Schema's `description` of each alternative shows them.
Json words_schema(const Shape& shape) {
  Json words = Json::array();
  for (const auto& entry : shape.entries)
    if (entry.available()) words.push_back({{"const", entry.name}, {"description", entry.sentence}});
  return {{"oneOf", words}};
}

bool all_optional(const Shape& shape) {
  for (const auto& entry : shape.entries)
    if (entry.required) return false;
  return shape.kind == Shape::Kind::Object && !shape.choice;
}

Json alternatives_schema(const Shape& shape) {
  Json any = Json::array();
  if (shape.bare) any.push_back(schema_of(*shape.bare));
  for (const auto& entry : shape.entries) {
    if (!entry.available()) continue;
    Json inner = entry_schema(entry);
    if (all_optional(*entry.shape)) {
      any.push_back({{"const", entry.name}, {"description", entry.sentence}});
      inner = {{"anyOf", Json::array({inner, {{"type", "null"}}})}};
    }
    any.push_back({{"type", "object"},
                   {"properties", {{entry.name, inner}}},
                   {"required", Json::array({entry.name})},
                   {"additionalProperties", false}});
  }
  return {{"anyOf", any}};
}

Json object_schema(const Shape& shape) {
  Json json = {{"type", "object"}, {"properties", Json::object()}, {"additionalProperties", false}};
  Json required = Json::array();
  for (const auto& entry : shape.entries) {
    if (!entry.available()) continue;
    json["properties"][entry.name] = entry_schema(entry);
    if (entry.required) required.push_back(entry.name);
  }
  if (!required.empty()) json["required"] = required;
  if (shape.choice) {
    Json one = Json::array();
    for (const auto& entry : shape.choice->entries) {
      if (!entry.available()) continue;
      json["properties"][entry.name] = entry_schema(entry);
      one.push_back({{"required", Json::array({entry.name})}});
    }
    json["oneOf"] = one;
  }
  return json;
}

Json schema_of(const Shape& shape) {
  Json json;
  switch (shape.kind) {
  case Shape::Kind::Number:
    json = {{"type", "number"}};
    add_range(json, shape.range);
    return number_or_text(json, "expression of the deck's constants");
  case Shape::Kind::Integer:
    json = {{"type", "integer"}};
    add_range(json, shape.range);
    return number_or_text(json, "expression of the deck's constants");
  case Shape::Kind::Boolean:
    return {{"type", "boolean"}};
  case Shape::Kind::Text:
    return {{"type", Json::array({"string", "number", "boolean"})}};
  case Shape::Kind::Expression:
    return number_or_text({{"type", "number"}}, "expression of t, x, y, z and constants");
  case Shape::Kind::Enumeration:
    return words_schema(shape);
  case Shape::Kind::List:
    json = {{"type", "array"}, {"items", schema_of(*shape.element)}};
    if (shape.min_items > 0) json["minItems"] = shape.min_items;
    if (shape.max_items != std::numeric_limits<std::size_t>::max()) json["maxItems"] = shape.max_items;
    return json;
  case Shape::Kind::Map:
    json = {{"type", "object"}, {"additionalProperties", schema_of(*shape.element)}};
    if (shape.min_items > 0) json["minProperties"] = shape.min_items;
    return json;
  case Shape::Kind::Object:
    return object_schema(shape);
  case Shape::Kind::Alternatives:
    return alternatives_schema(shape);
  }
  return json;
}

} // namespace

std::string json_schema(const Shape& root, const std::string& title) {
  Json json = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}};
  json.update(schema_of(root));
  return json.dump(2) + "\n";
}

} // namespace amontons
