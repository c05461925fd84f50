// Reading a piece of YAML with a rule, and the messages that come of it.
#pragma once

#include "base/error.hpp"
#include "deck/rule.hpp"

#include <doctest/doctest.h>
#include <string>
#include <vector>

namespace amontons {

template <class T>
struct ReadResult {
  T value{};
  std::vector<std::string> messages;
};

/// The value that `rule` reads from `text` (a file called "f"), and the messages in the order of the file.
template <class T>
ReadResult<T> read_text(const std::string& text, const Rule<T>& rule, Reading reading = {}) {
  ReadResult<T> result;
  try {
    rule.read(parse_yaml(text, "f"), result.value, reading);
    reading.finish();
  } catch (const UserError& error) {
    result.messages = error.messages();
  }
  return result;
}

/// Checks that there is exactly one message, that it begins with `place` ("f:1:2: ") and holds `part`.
template <class T>
void check_refused(const std::string& text, const Rule<T>& rule, const std::string& place, const std::string& part) {
  const auto result = read_text(text, rule);
  CAPTURE(text);
  REQUIRE(result.messages.size() == 1);
  CAPTURE(result.messages[0]);
  CHECK(result.messages[0].starts_with(place));
  CHECK(result.messages[0].find(part) != std::string::npos);
}

/// Checks that the text is read without a message, and returns the value.
template <class T>
T read_well(const std::string& text, const Rule<T>& rule) {
  const auto result = read_text(text, rule);
  CAPTURE(text);
  REQUIRE_MESSAGE(result.messages.empty(), (result.messages.empty() ? "" : result.messages[0]));
  return result.value;
}

} // namespace amontons
