// For rules that hold many others: copies that are one.
#pragma once

#include "deck/rule.hpp"

#include <memory>
#include <utility>

namespace amontons {

/// The same rule, to be copied at the cost of a pointer. Rules hold the rules of their parts by value, and each wrapper
/// (list, map, alternative, member) copies what it wraps: without this a rule near the leaves of the deck would be
/// copied as a whole hundreds of times, in runs that never use it.
template <class T>
Rule<T> shared(Rule<T> rule) {
  const auto one = std::make_shared<const Rule<T>>(std::move(rule));
  return {one->shape, [one](const DeckNode& node, T& value, Reading& reading) { one->read(node, value, reading); },
          [one](const T& value) { return one->show(value); }};
}

} // namespace amontons
