// The vocabulary in which a deck is declared: number, integer, text, expression, word, list, map, object, alternatives.
// A Rule<T> reads a T from the deck and carries the Shape that documents it; both come from the same call, so they
// cannot disagree. Defaults are those of the C++ struct. It knows YAML only as DeckNode, and nothing of mechanics.
#pragma once

#include "base/expression.hpp"
#include "deck/node.hpp"
#include "deck/reading.hpp"
#include "deck/shape.hpp"

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace amontons {

template <class T>
struct Rule {
  ShapePtr shape;
  /// Reads the node into the value; what is wrong is noted in the Reading, and the value is then of no use.
  std::function<void(const DeckNode&, T&, Reading&)> read;
  /// The value as JSON, for documenting defaults.
  std::function<std::string(const T&)> show;
};

// --- plain values
// -----------------------------------------------------------------------------------------------------

/// A finite number, or an expression of the deck's constants. `unit` is a dimension such as "stress"; "1" for none.
Rule<double> number(std::string unit, Range range = {});
Rule<int> integer(Range range = {});
Rule<bool> boolean();
/// Any text that is not empty. `meaning` says what it names.
Rule<std::string> text(std::string meaning);
/// A text of letters, digits, '_' and '-': fit for a column or file name.
Rule<std::string> identifier(std::string meaning);
/// Any scalar as it is written, also an empty one.
Rule<std::string> raw_text(std::string meaning);
Rule<Expression> expression(std::string unit);
/// Named numbers, each of which may use those before it; they become known to all later numbers and expressions.
Rule<std::map<std::string, double>> constants_table();

// --- what the templates below share, in rule.cpp
// ----------------------------------------------------------------------

/// Notes that something else stands where `wanted` should.
void fail_type(const DeckNode& node, const std::string& wanted, Reading& reading);
/// Notes keys that are written twice. `node` is a map.
void check_duplicates(const DeckNode& node, Reading& reading);
/// Checks that the node is a map whose keys are those of the object, each once, the required ones present.
bool check_object(const DeckNode& node, const Shape& shape, Reading& reading);
/// Checks kind and number of items of a list or map.
bool check_collection(const DeckNode& node, const Shape& shape, Reading& reading);
/// The word's index among the entries.
std::optional<std::size_t> read_word(const DeckNode& node, const Shape& shape, Reading& reading);
/// Which alternative is chosen, and the node that holds its value (empty map when only the tag is written). Index
/// entries.size() stands for the bare form.
std::optional<std::pair<std::size_t, DeckNode>> read_alternative(const DeckNode& node, const Shape& shape,
                                                                 Reading& reading);
/// The part of an object's map that belongs to its choice; nothing if not exactly one tag of it is there.
std::optional<DeckNode> read_choice(const DeckNode& node, const Shape& choice, Reading& reading);
/// Does this JSON hold nothing ("", [], {}, null)?
bool shows_nothing(const std::string& json);
/// Makes the names for one entry of a map known for the life of the scope.
class EntryScope {
 public:
  EntryScope(Reading& reading, const std::string& key);
  ~EntryScope();
  EntryScope(const EntryScope&) = delete;
  EntryScope& operator=(const EntryScope&) = delete;

 private:
  Reading& reading_;
  std::map<std::string, double> constants_;
  std::map<std::string, std::string> missing_;
};

// --- wrappers
// ---------------------------------------------------------------------------------------------------------

/// A rule for the wrapped type of a member: Located<T> remembers the place, std::optional<T> is filled when present.
template <class M, class T>
Rule<M> lifted(Rule<T> rule) {
  if constexpr (std::is_same_v<M, T>) {
    return rule;
  } else if constexpr (std::is_same_v<M, std::optional<T>>) {
    return {rule.shape,
            [rule](const DeckNode& node, M& value, Reading& reading) { rule.read(node, value.emplace(), reading); },
            [rule](const M& value) { return value ? rule.show(*value) : std::string("null"); }};
  } else {
    static_assert(std::is_same_v<M, Located<T>>, "the rule's type is not that of the member");
    return {rule.shape,
            [rule](const DeckNode& node, M& value, Reading& reading) {
              value.place = node.place;
              rule.read(node, value.value, reading);
            },
            [rule](const M& value) { return rule.show(value.value); }};
  }
}

template <class T>
Rule<Located<T>> located(Rule<T> rule) {
  return lifted<Located<T>>(std::move(rule));
}

// --- collections
// ------------------------------------------------------------------------------------------------------

template <class T>
Rule<std::vector<T>> list_of(Rule<T> rule, std::size_t min_items = 0,
                             std::size_t max_items = std::numeric_limits<std::size_t>::max()) {
  Shape shape;
  shape.kind = Shape::Kind::List;
  shape.element = rule.shape;
  shape.min_items = min_items;
  shape.max_items = max_items;
  const auto shared = std::make_shared<const Shape>(std::move(shape));
  return {shared,
          [rule, shared](const DeckNode& node, std::vector<T>& values, Reading& reading) {
            values.clear();
            if (!check_collection(node, *shared, reading)) return;
            for (const auto& item : node.items)
              rule.read(item, values.emplace_back(), reading);
          },
          [rule](const std::vector<T>& values) {
            std::vector<std::string> parts;
            for (const auto& value : values)
              parts.push_back(rule.show(value));
            return json_list(parts);
          }};
}

/// A map with keys that the user chooses; `meaning` says what they name. Expressions below a key know the names that
/// Reading::entry_names has for that key.
template <class T>
Rule<std::map<std::string, T>> map_of(std::string meaning, Rule<T> rule, std::size_t min_items = 0) {
  Shape shape;
  shape.kind = Shape::Kind::Map;
  shape.meaning = std::move(meaning);
  shape.element = rule.shape;
  shape.min_items = min_items;
  const auto shared = std::make_shared<const Shape>(std::move(shape));
  return {shared,
          [rule, shared](const DeckNode& node, std::map<std::string, T>& values, Reading& reading) {
            values.clear();
            if (!check_collection(node, *shared, reading)) return;
            for (std::size_t i = 0; i < node.items.size(); ++i) {
              const EntryScope scope(reading, node.keys[i].name);
              rule.read(node.items[i], values[node.keys[i].name], reading);
            }
          },
          [rule](const std::map<std::string, T>& values) {
            std::vector<std::string> parts;
            for (const auto& [key, value] : values)
              parts.push_back(json_pair(key, rule.show(value)));
            return json_object(parts);
          }};
}

// --- words
// ------------------------------------------------------------------------------------------------------------

/// A word out of a fixed set, each with a value and a sentence.
template <class T>
class WordRule {
 public:
  WordRule() { shape_.kind = Shape::Kind::Enumeration; }
  WordRule& word(std::string name, T value, std::string sentence) {
    shape_.entries.push_back({.name = std::move(name), .sentence = std::move(sentence)});
    values_.push_back(std::move(value));
    return *this;
  }
  /// A word that this release does not have; `instead` says what to do.
  WordRule& not_yet(std::string name, std::string instead) {
    shape_.entries.push_back({.name = std::move(name), .instead = std::move(instead)});
    values_.emplace_back();
    return *this;
  }
  operator Rule<T>() const {
    const auto shape = std::make_shared<const Shape>(shape_);
    return {shape,
            [shape, values = values_](const DeckNode& node, T& value, Reading& reading) {
              if (const auto index = read_word(node, *shape, reading)) value = values[*index];
            },
            [shape, values = values_](const T& value) {
              for (std::size_t i = 0; i < values.size(); ++i)
                if (values[i] == value && shape->entries[i].available()) return json_quoted(shape->entries[i].name);
              return std::string("null");
            }};
  }

 private:
  Shape shape_;
  std::vector<T> values_;
};

// --- objects
// ----------------------------------------------------------------------------------------------------------

/// A map with fixed keys, each bound to a member of T by a member pointer (or a function T& -> M&). Keys are read in
/// the order of declaration, whatever their order in the file.
template <class T>
class ObjectRule {
 public:
  ObjectRule() { shape_.kind = Shape::Kind::Object; }

  template <class Member, class R>
  ObjectRule& required(std::string name, Member member, const R& rule, std::string sentence,
                       std::string citation = "") {
    return add(std::move(name), member, rule, std::move(sentence), std::move(citation), true);
  }
  /// The default is the member's value in a T{}.
  template <class Member, class R>
  ObjectRule& optional(std::string name, Member member, const R& rule, std::string sentence,
                       std::string citation = "") {
    return add(std::move(name), member, rule, std::move(sentence), std::move(citation), false);
  }
  /// Exactly one tag of the alternatives stands among the keys of this object.
  template <class Member, class R>
  ObjectRule& choice(Member member, const R& rule) {
    using M = std::remove_reference_t<std::invoke_result_t<Member, T&>>;
    const Rule<M> alternatives = rule;
    shape_.choice = alternatives.shape;
    steps_.push_back([alternatives, member](const DeckNode& node, T& value, Reading& reading) {
      const auto part = read_choice(node, *alternatives.shape, reading);
      if (part) alternatives.read(*part, std::invoke(member, value), reading);
    });
    shows_.push_back([alternatives, member](const T& value) {
      const auto json = alternatives.show(std::invoke(member, value));
      return json.substr(1, json.size() - 2);
    });
    return *this;
  }
  /// A key that this release does not have; `instead` says what to do.
  ObjectRule& not_yet(std::string name, std::string instead) {
    shape_.entries.push_back({.name = std::move(name), .instead = std::move(instead)});
    return *this;
  }
  /// `work(node, value, reading)` runs when the keys declared before it have been read, also if they had faults.
  ObjectRule& then(std::function<void(const DeckNode&, T&, Reading&)> work) {
    steps_.push_back(std::move(work));
    return *this;
  }
  /// `work(node, value, reading)` runs when the object has been read without a fault.
  ObjectRule& check(std::function<void(const DeckNode&, const T&, Reading&)> work) {
    checks_.push_back(std::move(work));
    return *this;
  }

  operator Rule<T>() const {
    const auto shape = std::make_shared<const Shape>(shape_);
    return {shape,
            [shape, steps = steps_, checks = checks_](const DeckNode& node, T& value, Reading& reading) {
              const auto before = reading.num_faults();
              const bool is_map = check_object(node, *shape, reading);
              reading.alternatives = nullptr;
              if (!is_map) return;
              for (const auto& step : steps)
                step(node, value, reading);
              if (reading.num_faults() != before) return;
              for (const auto& check : checks)
                check(node, value, reading);
            },
            [shows = shows_](const T& value) {
              std::vector<std::string> parts;
              for (const auto& show : shows)
                if (auto part = show(value); !part.empty()) parts.push_back(std::move(part));
              return json_object(parts);
            }};
  }

 private:
  template <class Member, class R>
  ObjectRule& add(std::string name, Member member, const R& rule, std::string sentence, std::string citation,
                  bool is_required) {
    using M = std::remove_reference_t<std::invoke_result_t<Member, T&>>;
    const Rule<M> bound = lifted<M>(plain(rule));
    Entry entry;
    entry.name = name;
    entry.sentence = std::move(sentence);
    entry.citation = std::move(citation);
    entry.shape = bound.shape;
    entry.required = is_required;
    if (!is_required) {
      const auto json = bound.show(std::invoke(member, *fresh_));
      if (!shows_nothing(json)) entry.default_value = json;
    }
    shape_.entries.push_back(std::move(entry));
    steps_.push_back([name, bound, member](const DeckNode& node, T& value, Reading& reading) {
      if (const auto* item = node.find(name)) bound.read(*item, std::invoke(member, value), reading);
    });
    shows_.push_back([name, bound, member](const T& value) {
      const auto json = bound.show(std::invoke(member, value));
      return shows_nothing(json) ? std::string() : json_pair(name, json);
    });
    return *this;
  }
  // Builders convert to the Rule that they build.
  template <class U>
  static const Rule<U>& plain(const Rule<U>& rule) {
    return rule;
  }
  template <template <class> class Builder, class U>
  static Rule<U> plain(const Builder<U>& builder) {
    return builder;
  }

  Shape shape_;
  std::shared_ptr<const T> fresh_ = std::make_shared<const T>(); // holds the defaults
  std::vector<std::function<void(const DeckNode&, T&, Reading&)>> steps_;
  std::vector<std::function<void(const DeckNode&, const T&, Reading&)>> checks_;
  std::vector<std::function<std::string(const T&)>> shows_;
};

// --- alternatives
// -----------------------------------------------------------------------------------------------------

/// `{tag: value}` chooses the type that a std::variant V holds; the tag alone stands for `{tag: {}}`.
template <class V>
class TaggedRule {
 public:
  TaggedRule() { shape_.kind = Shape::Kind::Alternatives; }

  template <class A>
  TaggedRule& tag(std::string name, const Rule<A>& rule, std::string sentence, std::string citation = "") {
    readers_.push_back(reader(rule));
    shows_.push_back([name, rule](const V& value) -> std::string {
      const auto* alternative = std::get_if<A>(&value);
      return alternative ? json_object({json_pair(name, rule.show(*alternative))}) : "";
    });
    auto& entry = shape_.entries.emplace_back();
    entry.name = std::move(name);
    entry.sentence = std::move(sentence);
    entry.citation = std::move(citation);
    entry.shape = rule.shape;
    return *this;
  }
  template <class A>
  TaggedRule& tag(std::string name, const ObjectRule<A>& rule, std::string sentence, std::string citation = "") {
    return tag(std::move(name), Rule<A>(rule), std::move(sentence), std::move(citation));
  }
  /// What may stand there without a tag.
  template <class A>
  TaggedRule& bare(const Rule<A>& rule) {
    shape_.bare = rule.shape;
    bare_ = reader(rule);
    shows_.push_back([rule](const V& value) -> std::string {
      const auto* alternative = std::get_if<A>(&value);
      return alternative ? rule.show(*alternative) : "";
    });
    return *this;
  }
  /// A tag that this release does not have; `instead` says what to do.
  TaggedRule& not_yet(std::string name, std::string instead) {
    readers_.emplace_back();
    shape_.entries.push_back({.name = std::move(name), .instead = std::move(instead)});
    return *this;
  }

  operator Rule<V>() const {
    const auto shape = std::make_shared<const Shape>(shape_);
    return {shape,
            [shape, readers = readers_, bare = bare_](const DeckNode& node, V& value, Reading& reading) {
              const auto chosen = read_alternative(node, *shape, reading);
              if (!chosen) return;
              const auto& [index, inner] = *chosen;
              if (index < readers.size()) {
                reading.alternatives = shape.get();
                readers[index](inner, value, reading);
                reading.alternatives = nullptr;
              } else {
                bare(inner, value, reading);
              }
            },
            [shows = shows_](const V& value) {
              for (const auto& show : shows)
                if (auto json = show(value); !json.empty()) return json;
              return std::string("null");
            }};
  }

 private:
  using Reader = std::function<void(const DeckNode&, V&, Reading&)>;
  template <class A>
  static Reader reader(const Rule<A>& rule) {
    return [rule](const DeckNode& node, V& value, Reading& reading) {
      rule.read(node, value.template emplace<A>(), reading);
    };
  }
  Shape shape_;
  std::vector<Reader> readers_;
  Reader bare_;
  std::vector<std::function<std::string(const V&)>> shows_;
};

} // namespace amontons
