// Manual pages of deck keys, written from a Shape.
#include "base/error.hpp"
#include "deck/shape.hpp"

#include <algorithm>
#include <cctype>

namespace amontons {

namespace {

/// Where a dotted path leads.
struct Found {
  const Entry* entry = nullptr; // null for the root and for names that the user chooses
  const Shape* shape = nullptr; // null for what this release does not have
  std::string path;             // with <name> where the user chooses
};

std::vector<std::string> split_path(const std::string& key) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : key + ".") {
    if (c != '.' && c != '[') {
      word += c;
      continue;
    }
    const bool is_index = !word.empty() && (word.back() == ']' || std::all_of(word.begin(), word.end(), [](char digit) {
                                              return std::isdigit(static_cast<unsigned char>(digit));
                                            }));
    if (!word.empty() && !is_index) words.push_back(word);
    word.clear();
  }
  return words;
}

std::string joined_path(const std::string& path, const std::string& name) {
  return path.empty() ? name : path + "." + name;
}

/// All that may be named directly below a shape. Lists and maps are looked through.
std::vector<const Entry*> entries_below(const Shape& shape) {
  std::vector<const Entry*> entries;
  for (const auto& entry : shape.entries)
    entries.push_back(&entry);
  for (const auto& part : {shape.choice, shape.bare, shape.element})
    if (part)
      for (const auto* entry : entries_below(*part))
        entries.push_back(entry);
  return entries;
}

const Entry* entry_below(const Shape& shape, const std::string& name) {
  for (const auto* entry : entries_below(shape))
    if (entry->name == name) return entry;
  return nullptr;
}

bool holds_map(const Shape& shape) {
  return shape.kind == Shape::Kind::Map || (shape.kind == Shape::Kind::List && holds_map(*shape.element));
}

const Shape* map_element(const Shape& shape) {
  return shape.kind == Shape::Kind::Map ? shape.element.get() : map_element(*shape.element);
}

Found find_key(const Shape& root, const std::string& key) {
  Found found{nullptr, &root, ""};
  for (const auto& word : split_path(key)) {
    const auto* entry = found.shape ? entry_below(*found.shape, word) : nullptr;
    if (entry) {
      if (holds_map(*found.shape)) found.path += ".<name>";
      found = {entry, entry->shape.get(), joined_path(found.path, word)};
      continue;
    }
    if (found.shape && holds_map(*found.shape)) {
      found = {nullptr, map_element(*found.shape), found.path + ".<name>"};
      continue;
    }
    std::vector<std::string> names;
    if (found.shape)
      for (const auto* below : entries_below(*found.shape))
        names.push_back(below->name);
    const auto match = nearest_match(word, names);
    throw UserError("there is no key '" + word + "' in " + (found.path.empty() ? "the deck" : found.path) + "." +
                    (match.empty() ? "" : " Did you mean '" + match + "'?") +
                    (names.empty() ? " It has no keys below it." : " Keys there: " + join_names(names) + "."));
  }
  return found;
}

void add_line(std::string& page, const std::string& title, const std::string& text) {
  if (text.empty()) return;
  page += "  " + title + std::string(title.size() < 10 ? 10 - title.size() : 1, ' ') + text + "\n";
}

std::string entry_remark(const Entry& entry) {
  if (!entry.available()) return "not in this release: " + entry.instead;
  std::string text = entry.sentence;
  if (entry.required) text += " Required.";
  if (!entry.default_value.empty()) text += " Default: " + entry.default_value + ".";
  return text;
}

/// The innermost shape that has a unit and a range: of the elements of a list or map, of the bare form.
const Shape& innermost(const Shape& shape) {
  if (shape.element) return innermost(*shape.element);
  return shape.bare && shape.entries.empty() ? innermost(*shape.bare) : shape;
}

void add_overview(std::string& text, const Shape& shape, int depth) {
  const std::string indent(2 * std::size_t(depth), ' ');
  for (const auto& part : {shape.choice, shape.element})
    if (part) add_overview(text, *part, depth);
  for (const auto& entry : shape.entries) {
    const auto name = indent + entry.name;
    text += name + std::string(name.size() < 26 ? 26 - name.size() : 1, ' ') + entry_remark(entry) + "\n";
    if (entry.shape) add_overview(text, *entry.shape, depth + 1);
  }
}

} // namespace

std::string manual_page(const Shape& root, const std::string& key) {
  const auto found = find_key(root, key);
  std::string page = (found.path.empty() ? "deck" : found.path) + "\n";
  if (found.entry) {
    add_line(page, "meaning", found.entry->sentence);
    if (!found.entry->available()) add_line(page, "not yet", "Not in this release. " + found.entry->instead);
  }
  if (!found.shape) return page;
  const auto& inner = innermost(*found.shape);
  add_line(page, "type", type_name(*found.shape));
  if (!inner.unit.empty()) add_line(page, "unit", inner.unit == "1" ? "none" : inner.unit);
  if (inner.kind == Shape::Kind::Number || inner.kind == Shape::Kind::Integer)
    add_line(page, "range", inner.range.text());
  if (found.entry) {
    add_line(page, "default", found.entry->default_value);
    add_line(page, "required", found.entry->required ? "yes" : "no");
    add_line(page, "source", found.entry->citation);
  }
  const auto below = entries_below(*found.shape);
  if (!below.empty()) page += "\n";
  for (const auto* entry : below)
    add_line(page, entry->name, entry_remark(*entry));
  return page;
}

std::string manual_overview(const Shape& root) {
  std::string text;
  add_overview(text, root, 0);
  return text;
}

} // namespace amontons
