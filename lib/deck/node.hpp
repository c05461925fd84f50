// A deck's YAML as a plain tree in which every value and every key knows where it was written. The rest of lib/deck
// reads this tree, so that yaml-cpp stays inside node.cpp.
#pragma once

#include "deck/located.hpp"

#include <initializer_list>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace amontons {

struct DeckNode {
  enum class Kind { Null, Scalar, List, Map };
  struct Key {
    std::string name;
    Place place;
  };

  Kind kind = Kind::Null;
  std::string text;            // of a scalar
  Place place;                 // where the value begins
  std::string path;            // "contact[0].enforce": names the value in messages
  std::vector<Key> keys;       // of a map, in the order of the file; a key written twice is there twice
  std::vector<DeckNode> items; // of a list; of a map: one for each key

  /// The value of a map's key (the first, if it is written twice), or nullptr.
  const DeckNode* find(std::string_view key) const;
};

/// One step down the tree: a key of a map or an index of a list.
using DeckStep = std::variant<std::string, std::size_t>;

/// The place of the key (or list item) at the end of `steps`, or of the last one that exists on the way there.
Place place_of(const DeckNode& root, std::initializer_list<DeckStep> steps);

/// Parses YAML text. `file` is what messages call it. Throws UserError with the position of a syntax error.
DeckNode parse_yaml(const std::string& text, const std::string& file);

/// "a map", "a list", "the text 'abc'", "nothing": what stands there, for messages.
std::string what_stands(const DeckNode& node);

} // namespace amontons
