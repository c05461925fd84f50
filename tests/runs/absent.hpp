// For builds from which an effect is taken out (without_effect.py): types that are known to be empty when the program is
// compiled, so that the compiler drops all that hangs on them, and the linker finds whether anything else needs it.
#pragma once

// What is left without use by that is no mistake.
#pragma GCC diagnostic ignored "-Wmisleading-indentation"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-variable"
#pragma GCC diagnostic ignored "-Wunused-but-set-variable"
#pragma GCC diagnostic ignored "-Wunused-const-variable"

#include <cstddef>
#include <variant>

namespace amontons {

/// Instead of a pointer or an optional.
template <class T>
struct Absent {
  constexpr Absent() = default;
  template <class Value>
  constexpr Absent(const Value&) {}
  constexpr explicit operator bool() const { return false; }
  constexpr bool has_value() const { return false; }
  T* operator->() const { __builtin_unreachable(); }
  T& operator*() const { __builtin_unreachable(); }
  constexpr T* get() const { return nullptr; }
  template <class... Values>
  T& emplace(Values&&...) {
    __builtin_unreachable();
  }
  template <class Value>
  Absent& operator=(const Value&) {
    return *this;
  }
  constexpr void reset() {}
  friend constexpr bool operator==(const Absent&, std::nullptr_t) { return true; }
};

/// Instead of std::visit, where the first alternative is the only one.
template <class Visitor, class Variant>
auto visit_first(Visitor&& visitor, const Variant& variant) {
  return visitor(*std::get_if<0>(&variant));
}

} // namespace amontons
