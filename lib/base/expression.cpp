#include "base/expression.hpp"

#include "base/error.hpp"

#include <muParser.h>
#include <vector>

namespace amontons {

namespace {

/// Is there a '=' that is not part of ==, <=, >= or !=?
bool assigns(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '=') continue;
    if (i + 1 < text.size() && text[i + 1] == '=')
      ++i;
    else if (i == 0 || (text[i - 1] != '<' && text[i - 1] != '>' && text[i - 1] != '!'))
      return true;
  }
  return false;
}

} // namespace

struct Expression::Compiled {
  mu::Parser parser;
  double t = 0.0;
  double place[3] = {0.0, 0.0, 0.0};
};

Expression::Expression(const std::string& text, const std::map<std::string, double>& constants)
    : text_(text), compiled_(std::make_shared<Compiled>()) {
  auto& parser = compiled_->parser;
  std::vector<std::string> names = {"t", "x", "y", "z", "pi"};
  try {
    parser.DefineVar("t", &compiled_->t);
    parser.DefineVar("x", &compiled_->place[0]);
    parser.DefineVar("y", &compiled_->place[1]);
    parser.DefineVar("z", &compiled_->place[2]);
    parser.DefineConst("pi", 3.14159265358979323846);
    for (const auto& [name, value] : constants) {
      parser.DefineConst(name, value);
      names.push_back(name);
    }
    parser.SetExpr(text);
    int num_results = 0;
    value_ = parser.Eval(num_results)[0];
    if (num_results != 1) throw mu::Parser::exception_type("it has a comma outside of a function's brackets.");
    // muParser assigns to variables: "x = 2" would change the place for whoever is evaluated next.
    if (assigns(text)) throw mu::Parser::exception_type("'=' does not compare; write '=='.");
    // Only now: before it has been evaluated, GetUsedVar would let unknown names pass as variables.
    if (parser.GetUsedVar().empty()) compiled_.reset();
  } catch (const mu::Parser::exception_type& error) {
    std::string message = "the expression \"" + text + "\" cannot be read: " + error.GetMsg();
    if (!message.ends_with('.')) message += '.';
    // Any name is near to a word of one or two letters.
    const auto match = error.GetToken().size() > 2 ? nearest_match(error.GetToken(), names) : std::string();
    if (!match.empty()) message += " Did you mean '" + match + "'?";
    throw UserError(message + " Known names: " + join_names(names) + ".");
  }
}

double Expression::operator()(double t, std::span<const double> place) const {
  if (!compiled_) return value_;
  compiled_->t = t;
  for (std::size_t i = 0; i < 3; ++i)
    compiled_->place[i] = i < place.size() ? place[i] : 0.0;
  return compiled_->parser.Eval();
}

} // namespace amontons
