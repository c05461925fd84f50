#include "deck/node.hpp"

#include "base/error.hpp"

#include <yaml-cpp/yaml.h>

namespace amontons {

namespace {

/// An alias may point at the list or map that holds it: such a deck never ends.
constexpr int max_depth = 50;
/// Aliases of aliases can make a small file huge.
constexpr std::size_t max_nodes = 1'000'000;
/// A comment put behind the deck: a quote that is never closed swallows it, which yaml-cpp does not mind.
const std::string end_mark = "# end of the deck, behind its last line";

class Converter {
 public:
  explicit Converter(const std::string& file) : file_(file) {}

  DeckNode convert(const YAML::Node& yaml, const std::string& path, int depth) {
    DeckNode node;
    node.place = place(yaml.Mark());
    node.path = path;
    if (depth > max_depth || ++count_ > max_nodes)
      throw UserError(node.place.text() + ": the deck is nested too deeply or an alias (*name) contains itself. " +
                      "Write the values out instead of using aliases.");
    if (yaml.IsScalar()) {
      node.kind = DeckNode::Kind::Scalar;
      node.text = yaml.Scalar();
      if (node.text.find(end_mark) != std::string::npos)
        throw UserError(node.place.text() + ": this is not YAML: the quote that opens here is never closed. Close it, "
                                            "and look at the indentation of the lines that follow.");
    } else if (yaml.IsSequence()) {
      node.kind = DeckNode::Kind::List;
      for (const auto& item : yaml)
        node.items.push_back(convert(item, path + "[" + std::to_string(node.items.size()) + "]", depth + 1));
    } else if (yaml.IsMap()) {
      convert_map(yaml, node, depth);
    }
    return node;
  }

 private:
  void convert_map(const YAML::Node& yaml, DeckNode& node, int depth) {
    node.kind = DeckNode::Kind::Map;
    for (const auto& pair : yaml) {
      if (!pair.first.IsScalar())
        throw UserError(place(pair.first.Mark()).text() + ": a key must be a plain word, not a list or a map. " +
                        "Put a text that contains braces or brackets in quotes.");
      const auto& key = pair.first.Scalar();
      node.keys.push_back({key, place(pair.first.Mark())});
      node.items.push_back(convert(pair.second, node.path.empty() ? key : node.path + "." + key, depth + 1));
      // An empty value has no position of its own.
      if (node.items.back().kind == DeckNode::Kind::Null) node.items.back().place = node.keys.back().place;
    }
  }

  Place place(const YAML::Mark& mark) const {
    if (mark.is_null()) return {file_, 1, 1};
    return {file_, mark.line + 1, mark.column + 1};
  }

  std::string file_;
  std::size_t count_ = 0;
};

} // namespace

const DeckNode* DeckNode::find(std::string_view key) const {
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (keys[i].name == key) return &items[i];
  return nullptr;
}

Place place_of(const DeckNode& root, std::initializer_list<DeckStep> steps) {
  const DeckNode* node = &root;
  Place place = root.place;
  for (const auto& step : steps) {
    if (const auto* key = std::get_if<std::string>(&step)) {
      const auto* next = node->find(*key);
      if (!next) break;
      place = node->keys[next - node->items.data()].place;
      node = next;
    } else {
      const auto index = std::get<std::size_t>(step);
      if (node->kind != DeckNode::Kind::List || index >= node->items.size()) break;
      node = &node->items[index];
      place = node->place;
    }
  }
  return place;
}

DeckNode parse_yaml(const std::string& text, const std::string& file) {
  try {
    const auto documents = YAML::LoadAll(text + "\n" + end_mark + "\n");
    if (documents.size() > 1)
      throw UserError(file + ": the file holds " + std::to_string(documents.size()) +
                      " YAML documents; a deck is one. Remove the lines '---' between them.");
    if (documents.empty() || documents[0].IsNull())
      throw UserError(file + ": the deck is empty. `amontons describe` lists the keys that it must have.");
    return Converter(file).convert(documents[0], "", 0);
  } catch (const YAML::Exception& error) {
    const Place place =
        error.mark.is_null() ? Place{file, 1, 1} : Place{file, error.mark.line + 1, error.mark.column + 1};
    throw UserError(place.text() + ": this is not YAML: " + error.msg +
                    ". Look here and on the line before for indentation (spaces, never tabs), a missing ': ' after a "
                    "key, an open bracket or quote, or an expression that needs quotes.");
  }
}

std::string what_stands(const DeckNode& node) {
  switch (node.kind) {
  case DeckNode::Kind::Null:
    return "nothing";
  case DeckNode::Kind::Scalar:
    return "'" + node.text + "'";
  case DeckNode::Kind::List:
    return "a list";
  case DeckNode::Kind::Map:
    return "a map";
  }
  return "";
}

} // namespace amontons
