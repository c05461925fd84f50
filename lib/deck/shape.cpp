#include "deck/shape.hpp"

#include "base/error.hpp"

#include <charconv>
#include <nlohmann/json.hpp>

namespace amontons {

namespace {

std::string enclosed(char open, const std::vector<std::string>& parts, char close) {
  std::string text(1, open);
  for (const auto& part : parts)
    text.append(text.size() > 1 ? ", " : "").append(part);
  return text.append(1, close);
}

} // namespace

bool Range::contains(double value) const {
  return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
}

bool Range::is_everything() const {
  return low == -std::numeric_limits<double>::infinity() && high == std::numeric_limits<double>::infinity();
}

std::string Range::text() const {
  std::string text;
  if (low > -std::numeric_limits<double>::infinity()) text = (low_open ? "> " : ">= ") + number_text(low);
  if (high < std::numeric_limits<double>::infinity())
    text += (text.empty() ? "" : " and ") + std::string(high_open ? "< " : "<= ") + number_text(high);
  return text.empty() ? "any" : text;
}

std::vector<std::string> Shape::names() const {
  std::vector<std::string> names;
  for (const auto& entry : entries)
    if (entry.available()) names.push_back(entry.name);
  return names;
}

const Entry* Shape::find(const std::string& name) const {
  for (const auto& entry : entries)
    if (entry.name == name) return &entry;
  return nullptr;
}

std::vector<std::string> Shape::key_names() const {
  auto all = names();
  if (choice)
    for (const auto& tag : choice->names())
      all.push_back(tag);
  return all;
}

std::string type_name(const Shape& shape) {
  switch (shape.kind) {
  case Shape::Kind::Number:
    return "number";
  case Shape::Kind::Integer:
    return "integer";
  case Shape::Kind::Boolean:
    return "true or false";
  case Shape::Kind::Text:
    return shape.meaning.empty() ? "text" : "text (" + shape.meaning + ")";
  case Shape::Kind::Expression:
    return "expression of t, x, y, z";
  case Shape::Kind::Enumeration:
    return "one of the words " + join_names(shape.names());
  case Shape::Kind::List:
    return "list of: " + type_name(*shape.element);
  case Shape::Kind::Map:
    return "map from " + shape.meaning + " to: " + type_name(*shape.element);
  case Shape::Kind::Object:
    return shape.key_names().empty() ? "map without keys" : "map with the keys " + join_names(shape.key_names());
  case Shape::Kind::Alternatives: {
    std::string text = "one of";
    for (const auto& name : shape.names())
      text += " {" + name + ": ...}";
    return shape.bare ? type_name(*shape.bare) + ", or " + text : text;
  }
  }
  return "";
}

std::string number_text(double value) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof(buffer), value);
  return {buffer, result.ptr};
}

std::string json_quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string json_pair(const std::string& name, const std::string& value) {
  return json_quoted(name).append(": ").append(value);
}

std::string json_object(const std::vector<std::string>& pairs) { return enclosed('{', pairs, '}'); }

std::string json_list(const std::vector<std::string>& values) { return enclosed('[', values, ']'); }

} // namespace amontons
