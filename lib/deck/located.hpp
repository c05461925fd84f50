// A value together with the place in the deck that it was read from, so that later checks can point at it.
#pragma once

#include <string>
#include <utility>

namespace amontons {

/// 1-based; line 0: not from a file.
struct Place {
  std::string file;
  int line = 0;
  int column = 0;
  /// "file:line:column"
  std::string text() const { return file + ":" + std::to_string(line) + ":" + std::to_string(column); }
};

template <class T>
struct Located {
  T value{};
  Place place;
  Located() = default;
  Located(T v, Place p = {}) : value(std::move(v)), place(std::move(p)) {}
  operator const T&() const { return value; }
};

} // namespace amontons
