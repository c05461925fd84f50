// Numbers of a deck that may depend on time and place: "0.01*max(t-1,0)".
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>

namespace amontons {

/// A function of t, x, y, z and named constants, compiled once by muParser. Copies share the compiled form.
/// Evaluation is not thread-safe.
class Expression {
 public:
  /// The constant zero.
  Expression() = default;
  Expression(double value) : value_(value) {}
  /// Throws UserError with muParser's message and the allowed names when `text` is not an expression.
  Expression(const std::string& text, const std::map<std::string, double>& constants);

  /// `place` holds dim coordinates; missing ones are zero.
  double operator()(double t, std::span<const double> place = {}) const;
  bool is_constant() const { return !compiled_; }
  /// As the deck has it.
  const std::string& text() const { return text_; }

 private:
  struct Compiled;
  double value_ = 0.0;
  std::string text_;
  std::shared_ptr<Compiled> compiled_;
};

} // namespace amontons
