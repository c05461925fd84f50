#include "deck/rule.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace amontons {

namespace {

bool is_number_character(char c) { return (c >= '0' && c <= '9') || c == '.'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_name_character(char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; }

std::string shown_path(const DeckNode& node) { return node.path.empty() ? "the deck" : node.path; }

/// A remedy for what people write instead of a number.
std::string number_advice(const std::string& text) {
  if (text.empty() || !is_number_character(text[0])) return "";
  const auto comma = text.find(',');
  if (comma != std::string::npos) return " Write decimals with a point.";
  const auto word = std::find_if(text.begin(), text.end(), is_letter);
  const bool unit =
      word != text.end() && std::all_of(word, text.end(), [](char c) { return is_letter(c) || c == '^' || c == '/'; });
  return unit ? " Numbers carry no units: use one consistent system, such as mm, N and MPa." : "";
}

/// Does `text` use `name` as a whole word?
bool uses_name(const std::string& text, const std::string& name) {
  for (auto at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
    const bool begins = at == 0 || !is_name_character(text[at - 1]);
    const bool ends = at + name.size() == text.size() || !is_name_character(text[at + name.size()]);
    if (begins && ends) return true;
  }
  return false;
}

bool is_expression(const std::string& text, const std::map<std::string, double>& constants) {
  try {
    const Expression compiled(text, constants);
    return true;
  } catch (const UserError&) {
    return false;
  }
}

/// May a constant have this name? Not one that means something else already.
bool is_usable_name(const std::string& name) {
  for (const char* reserved : {"t", "x", "y", "z", "pi", "rho"})
    if (name == reserved) return false;
  const bool is_function = is_expression(name + "(1)", {}) || is_expression(name + "(1, 1)", {});
  return !is_function && is_expression(name, {{name, 1.0}});
}

std::optional<Expression> read_expression(const DeckNode& node, Reading& reading) {
  const auto& text = node.text;
  try {
    Expression value(text.starts_with('+') ? text.substr(1) : text, reading.constants);
    if (value.is_constant() && !std::isfinite(value(0.0))) {
      reading.fail(node.place, node.path + " is not a finite number: '" + text + "'. Write a finite one.");
      return std::nullopt;
    }
    return value;
  } catch (const UserError& error) {
    std::string message = node.path + ": " + error.what() + number_advice(text);
    for (const auto& [name, sentence] : reading.missing)
      if (uses_name(text, name)) message += " " + sentence;
    reading.fail(node.place, message);
    return std::nullopt;
  }
}

std::optional<double> read_number(const DeckNode& node, const Shape& shape, Reading& reading) {
  if (node.kind != DeckNode::Kind::Scalar || node.text.empty()) {
    fail_type(node, shape.kind == Shape::Kind::Integer ? "a whole number" : "a number", reading);
    return std::nullopt;
  }
  double value = 0.0;
  const auto* end = node.text.data() + node.text.size();
  const auto parsed = std::from_chars(node.text.data(), end, value);
  if (parsed.ec != std::errc() || parsed.ptr != end) {
    const auto expression = read_expression(node, reading);
    if (!expression) return std::nullopt;
    if (!expression->is_constant()) {
      reading.fail(node.place, node.path + " must be a number that does not change: '" + node.text +
                                   "' depends on t, x, y or z. Use numbers and `constants` only.");
      return std::nullopt;
    }
    value = (*expression)(0.0);
  }
  if (!std::isfinite(value)) {
    reading.fail(node.place, node.path + " is not a finite number: '" + node.text + "'. Write a finite one.");
    return std::nullopt;
  }
  if (shape.kind == Shape::Kind::Integer && value != std::floor(value)) {
    reading.fail(node.place, node.path + " must be a whole number, but is " + number_text(value) + ".");
    return std::nullopt;
  }
  if (!shape.range.contains(value)) {
    reading.fail(node.place, node.path + " must be " + shape.range.text() + ", but is " + number_text(value) + ".");
    return std::nullopt;
  }
  return value;
}

std::shared_ptr<const Shape> plain_shape(Shape::Kind kind, std::string meaning = "", std::string unit = "",
                                         Range range = {}) {
  Shape shape;
  shape.kind = kind;
  shape.meaning = std::move(meaning);
  shape.unit = std::move(unit);
  shape.range = range;
  return std::make_shared<const Shape>(std::move(shape));
}

std::string not_in_this_release(const std::string& path, const Entry& entry) {
  return path + ": '" + entry.name + "' is not in this release. " + entry.instead;
}

std::string meant(const std::string& word, const std::vector<std::string>& candidates) {
  const auto match = nearest_match(word, candidates);
  return match.empty() ? "" : " Did you mean '" + match + "'?";
}

/// The sibling alternatives that do have a key which the chosen one lacks.
std::string owners_of_key(const std::string& key, const Shape& shape, const Shape* alternatives) {
  std::vector<std::string> owners;
  if (alternatives)
    for (const auto& entry : alternatives->entries)
      if (entry.shape && entry.shape.get() != &shape && entry.shape->kind == Shape::Kind::Object &&
          entry.shape->find(key))
        owners.push_back("'" + entry.name + "'");
  return join_names(owners);
}

void fail_unknown_key(const DeckNode& node, std::size_t i, const Shape& shape, Reading& reading) {
  const auto& key = node.keys[i];
  const auto allowed = shape.key_names();
  const auto owners = owners_of_key(key.name, shape, reading.alternatives);
  std::string message = "unknown key '" + key.name + "' in " + shown_path(node) + ".";
  if (!owners.empty())
    message = "the key '" + key.name + "' belongs to " + owners + " and means nothing in " + shown_path(node) +
              ". Remove it, or choose " + owners + ".";
  else
    message += meant(key.name, allowed);
  reading.fail(key.place, message + (allowed.empty() ? " No keys are allowed here."
                                                     : " Allowed keys: " + join_names(allowed) + "."));
}

} // namespace

void Reading::fail(const Place& place, const std::string& message) { faults_.push_back({place, message}); }

void Reading::finish() const {
  if (faults_.empty()) return;
  auto ordered = faults_;
  std::stable_sort(ordered.begin(), ordered.end(), [](const Fault& a, const Fault& b) {
    return std::pair(a.place.line, a.place.column) < std::pair(b.place.line, b.place.column);
  });
  std::vector<std::string> messages;
  for (const auto& fault : ordered)
    messages.push_back(fault.place.text() + ": " + fault.message);
  throw UserError(std::move(messages));
}

bool Reading::has_fault(const DeckNode& node) const {
  const auto at = [this](const Place& place) {
    return std::any_of(faults_.begin(), faults_.end(), [&place](const Fault& fault) {
      return fault.place.line == place.line && fault.place.column == place.column;
    });
  };
  return at(node.place) ||
         std::any_of(node.keys.begin(), node.keys.end(), [&at](const auto& key) { return at(key.place); }) ||
         std::any_of(node.items.begin(), node.items.end(), [this](const auto& item) { return has_fault(item); });
}

EntryScope::EntryScope(Reading& reading, const std::string& key)
    : reading_(reading), constants_(reading.constants), missing_(reading.missing) {
  const auto names = reading.entry_names.find(key);
  if (names == reading.entry_names.end()) return;
  for (const auto& [name, value] : names->second.constants)
    reading.constants[name] = value;
  for (const auto& [name, sentence] : names->second.missing)
    reading.missing[name] = sentence;
}

EntryScope::~EntryScope() {
  reading_.constants = std::move(constants_);
  reading_.missing = std::move(missing_);
}

void fail_type(const DeckNode& node, const std::string& wanted, Reading& reading) {
  reading.fail(node.place, shown_path(node) + " must be " + wanted + ", but here stands " + what_stands(node) + ".");
}

void check_duplicates(const DeckNode& node, Reading& reading) {
  for (std::size_t i = 0; i < node.keys.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (node.keys[i].name == node.keys[j].name) {
        reading.fail(node.keys[i].place, "the key '" + node.keys[i].name + "' is written twice in " + shown_path(node) +
                                             ", first in line " + std::to_string(node.keys[j].place.line) +
                                             ". Keep one of the two.");
        break;
      }
}

bool check_object(const DeckNode& node, const Shape& shape, Reading& reading) {
  if (node.kind != DeckNode::Kind::Map) {
    fail_type(node, "a map with the keys " + join_names(shape.key_names()), reading);
    return false;
  }
  check_duplicates(node, reading);
  for (std::size_t i = 0; i < node.keys.size(); ++i) {
    const auto* entry = shape.find(node.keys[i].name);
    if (!entry && shape.choice) entry = shape.choice->find(node.keys[i].name);
    if (!entry)
      fail_unknown_key(node, i, shape, reading);
    else if (!entry->available())
      reading.fail(node.keys[i].place, not_in_this_release(shown_path(node), *entry));
  }
  for (const auto& entry : shape.entries)
    if (entry.required && !node.find(entry.name))
      reading.fail(node.place, "the key '" + entry.name + "' is missing in " + shown_path(node) + ": " +
                                   entry.sentence + " Add it (" + type_name(*entry.shape) + ").");
  return true;
}

bool check_collection(const DeckNode& node, const Shape& shape, Reading& reading) {
  const bool is_list = shape.kind == Shape::Kind::List;
  if (node.kind != (is_list ? DeckNode::Kind::List : DeckNode::Kind::Map)) {
    if (is_list)
      fail_type(node, "a list (each entry after '- ', or [a, b])", reading);
    else
      fail_type(node, "a map (" + shape.meaning + ": value)", reading);
    return false;
  }
  if (!is_list) check_duplicates(node, reading);
  const auto size = node.items.size();
  if (size >= shape.min_items && size <= shape.max_items) return true;
  std::string wanted = "at least " + std::to_string(shape.min_items);
  if (size > shape.max_items) wanted = "at most " + std::to_string(shape.max_items);
  if (shape.min_items == shape.max_items) wanted = std::to_string(shape.min_items);
  reading.fail(node.place, node.path + " must have " + wanted + (shape.min_items == 1 ? " entry" : " entries") +
                               ", but has " + std::to_string(size) + ".");
  return false;
}

std::optional<std::size_t> read_word(const DeckNode& node, const Shape& shape, Reading& reading) {
  if (node.kind != DeckNode::Kind::Scalar) {
    fail_type(node, "one of the words " + join_names(shape.names()), reading);
    return std::nullopt;
  }
  const auto* entry = shape.find(node.text);
  if (!entry) {
    reading.fail(node.place, node.path + ": unknown word '" + node.text + "'." + meant(node.text, shape.names()) +
                                 " Allowed: " + join_names(shape.names()) + ".");
    return std::nullopt;
  }
  if (!entry->available()) {
    reading.fail(node.place, not_in_this_release(node.path, *entry));
    return std::nullopt;
  }
  return entry - shape.entries.data();
}

std::optional<std::pair<std::size_t, DeckNode>> read_alternative(const DeckNode& node, const Shape& shape,
                                                                 Reading& reading) {
  const auto names = join_names(shape.names());
  const auto form = "one of " + names + ", written {" + (names.empty() ? "" : shape.names()[0]) + ": {...}}";
  // Where any text may stand, a tag without its value is a name that happens to be the same word.
  const auto* word = shape.find(node.text);
  const bool bare_tag = node.kind == DeckNode::Kind::Scalar &&
                        (!shape.bare || (word && (!word->available() || shape.bare->kind != Shape::Kind::Text)));
  if (node.kind == DeckNode::Kind::Scalar && !bare_tag) return std::pair(shape.entries.size(), node);
  if (!bare_tag && node.kind != DeckNode::Kind::Map) {
    fail_type(node, (shape.bare ? type_name(*shape.bare) + " or " : "") + form, reading);
    return std::nullopt;
  }
  if (!bare_tag && node.keys.size() != 1) {
    reading.fail(node.place, node.path + " must have exactly one tag, but has " + std::to_string(node.keys.size()) +
                                 ". Choose " + form + ".");
    return std::nullopt;
  }
  const auto& tag = bare_tag ? node.text : node.keys[0].name;
  const auto& place = bare_tag ? node.place : node.keys[0].place;
  const auto* entry = shape.find(tag);
  if (!entry) {
    reading.fail(place, node.path + ": unknown alternative '" + tag + "'." + meant(tag, shape.names()) + " Choose " +
                            form + ".");
    return std::nullopt;
  }
  if (!entry->available()) {
    reading.fail(place, not_in_this_release(node.path, *entry));
    return std::nullopt;
  }
  DeckNode inner = bare_tag ? node : node.items[0];
  if (bare_tag) inner.path += "." + tag;
  if (bare_tag || inner.kind == DeckNode::Kind::Null) {
    inner.kind = DeckNode::Kind::Map;
    inner.text.clear();
  }
  return std::pair<std::size_t, DeckNode>(entry - shape.entries.data(), std::move(inner));
}

std::optional<DeckNode> read_choice(const DeckNode& node, const Shape& choice, Reading& reading) {
  DeckNode part;
  part.kind = DeckNode::Kind::Map;
  part.place = node.place;
  part.path = node.path;
  for (std::size_t i = 0; i < node.keys.size(); ++i) {
    const auto* entry = choice.find(node.keys[i].name);
    if (!entry) continue;
    if (!entry->available()) return std::nullopt; // noted by check_object
    if (part.find(entry->name)) continue;         // likewise, as written twice
    part.keys.push_back(node.keys[i]);
    part.items.push_back(node.items[i]);
  }
  if (part.keys.size() == 1) return part;
  const auto names = join_names(choice.names());
  if (part.keys.empty())
    reading.fail(node.place, node.path + " does not say what it is: add one of " + names + ".");
  else
    reading.fail(part.keys[1].place,
                 node.path + " has both '" + part.keys[0].name + "' and '" + part.keys[1].name + "'. Keep one.");
  return std::nullopt;
}

bool shows_nothing(const std::string& json) {
  return json.empty() || json == "\"\"" || json == "[]" || json == "{}" || json == "null";
}

Rule<double> number(std::string unit, Range range) {
  const auto shape = plain_shape(Shape::Kind::Number, "", std::move(unit), range);
  return {shape,
          [shape](const DeckNode& node, double& value, Reading& reading) {
            value = read_number(node, *shape, reading).value_or(value);
          },
          [](const double& value) { return number_text(value); }};
}

Rule<int> integer(Range range) {
  // A wider number would not fit the int that it is read into.
  range.low = std::max(range.low, -2147483647.0);
  range.high = std::min(range.high, 2147483647.0);
  const auto shape = plain_shape(Shape::Kind::Integer, "", "1", range);
  return {shape,
          [shape](const DeckNode& node, int& value, Reading& reading) {
            value = static_cast<int>(read_number(node, *shape, reading).value_or(value));
          },
          [](const int& value) { return std::to_string(value); }};
}

Rule<bool> boolean() {
  return {plain_shape(Shape::Kind::Boolean),
          [](const DeckNode& node, bool& value, Reading& reading) {
            if (node.kind != DeckNode::Kind::Scalar || (node.text != "true" && node.text != "false"))
              return fail_type(node, "true or false", reading);
            value = node.text == "true";
          },
          [](const bool& value) { return std::string(value ? "true" : "false"); }};
}

Rule<std::string> text(std::string meaning) {
  const auto wanted = meaning.empty() ? "a text" : "a text (" + meaning + ")";
  return {plain_shape(Shape::Kind::Text, std::move(meaning)),
          [wanted](const DeckNode& node, std::string& value, Reading& reading) {
            if (node.kind != DeckNode::Kind::Scalar || node.text.empty()) return fail_type(node, wanted, reading);
            value = node.text;
          },
          json_quoted};
}

Rule<std::string> identifier(std::string meaning) {
  auto rule = text(std::move(meaning));
  rule.read = [read = rule.read](const DeckNode& node, std::string& value, Reading& reading) {
    read(node, value, reading);
    if (!std::all_of(value.begin(), value.end(), [](char c) { return is_name_character(c) || c == '-'; }))
      reading.fail(node.place, node.path + ": '" + value + "' names columns and files of the results: use letters, " +
                                   "digits, '_' and '-' only.");
  };
  return rule;
}

Rule<std::string> raw_text(std::string meaning) {
  return {plain_shape(Shape::Kind::Text, std::move(meaning)),
          [](const DeckNode& node, std::string& value, Reading& reading) {
            if (node.kind != DeckNode::Kind::Scalar && node.kind != DeckNode::Kind::Null)
              return fail_type(node, "a single value", reading);
            value = node.text;
          },
          json_quoted};
}

Rule<Expression> expression(std::string unit) {
  return {plain_shape(Shape::Kind::Expression, "", std::move(unit)),
          [](const DeckNode& node, Expression& value, Reading& reading) {
            if (node.kind != DeckNode::Kind::Scalar || node.text.empty())
              return fail_type(node, "a number or an expression of t, x, y, z in quotes", reading);
            if (const auto expression = read_expression(node, reading)) value = *expression;
          },
          [](const Expression& value) {
            return value.text().empty() ? number_text(value(0.0)) : json_quoted(value.text());
          }};
}

Rule<std::map<std::string, double>> constants_table() {
  Shape map;
  map.kind = Shape::Kind::Map;
  map.meaning = "name";
  map.element = plain_shape(Shape::Kind::Number, "", "any");
  const auto shape = std::make_shared<const Shape>(std::move(map));
  return {shape,
          [shape](const DeckNode& node, std::map<std::string, double>& values, Reading& reading) {
            if (!check_collection(node, *shape, reading)) return;
            for (std::size_t i = 0; i < node.items.size(); ++i) {
              const auto& key = node.keys[i];
              if (!is_usable_name(key.name)) {
                reading.fail(key.place,
                             node.path + ": '" + key.name + "' cannot be the name of a constant. Use a word " +
                                 "of letters, digits and '_' that is not t, x, y, z, pi, rho or a function.");
                continue;
              }
              const auto value = read_number(node.items[i], *shape->element, reading);
              if (value)
                values[key.name] = reading.constants[key.name] = *value;
              else
                reading.missing[key.name] = "The constant '" + key.name + "' itself is faulty, see its own message.";
            }
          },
          [](const std::map<std::string, double>&) { return std::string("{}"); }};
}

} // namespace amontons
