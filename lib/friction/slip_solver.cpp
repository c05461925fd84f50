#include "friction/slip_solver.hpp"

#include <cmath>
#include <limits>

namespace amontons {
namespace {

constexpr double rounding = std::numeric_limits<double>::epsilon();

/// F and F' at s.
struct Value {
  double s, F, slope;
  FrictionLimit limit;
  bool above() const { return F > 0; }
};

Value value_at(const SlipEquation& equation, double s) {
  const auto limit = equation.limit(s);
  return {s, equation.r - equation.epsilon * s - limit.tau, -equation.epsilon - limit.dtau_ds, limit};
}

struct Bracket {
  double low, high; // F(low) > 0 >= F(high)
};

/// A step that stays strictly inside the bracket: Newton's in s, else in ln s, else a bisection (of ln s, so that roots
/// many orders of magnitude below the upper end are reached fast).
double next_inside(const Value& value, const Bracket& bracket, bool bisect) {
  const auto is_inside = [&](double s) { return s > bracket.low && s < bracket.high; };
  if (!bisect && value.slope < 0) {
    const double step = value.F / value.slope;
    if (is_inside(value.s - step)) return value.s - step;
    const double scaled = value.s * std::exp(-step / value.s);
    if (is_inside(scaled) && scaled >= std::numeric_limits<double>::min()) return scaled;
  }
  if (bracket.low <= 0) return 1e-4 * bracket.high;
  return bracket.high > 2 * bracket.low ? std::sqrt(bracket.low) * std::sqrt(bracket.high)
                                        : 0.5 * (bracket.low + bracket.high);
}

/// The root in the bracket; `guess` lies in (low, high].
Value find_root(const SlipEquation& equation, Bracket bracket, double guess) {
  Value value = value_at(equation, guess);
  double before = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 400; ++i) {
    if (std::abs(value.F) <= 4 * rounding * equation.r) break;
    (value.above() ? bracket.low : bracket.high) = value.s;
    if (bracket.high - bracket.low <= 2 * rounding * bracket.high || bracket.high < std::numeric_limits<double>::min())
      break;
    const double next = next_inside(value, bracket, std::abs(value.F) > 0.5 * before);
    before = std::abs(value.F);
    value = value_at(equation, next);
  }
  return value;
}

/// Between two points with F of the same sign whose slopes announce an extremum towards zero: a point where F has the
/// other sign, or the extremum where it has not.
Value towards_zero(const SlipEquation& equation, Value left, Value right) {
  const bool above = left.above();
  Value middle = left;
  while (right.s - left.s > 1e-12 * right.s) {
    middle = value_at(equation, 0.5 * (left.s + right.s));
    if (middle.above() != above) break;
    const bool goes_to_zero = above ? middle.slope < 0 : middle.slope > 0;
    (goes_to_zero ? left : right) = middle;
  }
  return middle;
}

struct Crossings {
  int count = 0;
  Bracket first{};
};

/// Changes of sign of F over 0 < s <= r / ε.
Crossings find_crossings(const SlipEquation& equation) {
  constexpr int num_cells = 64;
  Crossings crossings;
  const auto note = [&](double low, double high) {
    if (crossings.count++ == 0) crossings.first = {low, high};
  };
  Value left = value_at(equation, 0);
  for (int cell = num_cells; cell >= 0; --cell) {
    const Value right = value_at(equation, std::ldexp(equation.largest_slip(), -cell));
    if (left.above() != right.above()) {
      note(left.s, right.s);
    } else if (left.above() ? left.slope < 0 && right.slope > 0 : left.slope > 0 && right.slope < 0) {
      const Value middle = towards_zero(equation, left, right);
      if (middle.above() != left.above()) {
        note(left.s, middle.s);
        note(middle.s, right.s);
      }
    }
    left = right;
  }
  return crossings;
}

} // namespace

SlipSolution solve_slip(const SlipEquation& equation) {
  const auto at_rest = equation.limit(0);
  const double largest = equation.largest_slip();
  const bool sticks = equation.r <= at_rest.tau;
  const bool is_steep = largest > 0 && steepest_weakening(equation.law, equation.context, equation.p, largest,
                                                          equation.state_old) >= equation.epsilon;
  const Crossings crossings = is_steep ? find_crossings(equation) : Crossings{};
  if (sticks) return {.limit = at_rest, .is_several = crossings.count > 0};
  // F may miss its sign at the upper end by rounding alone: then that end is the root.
  const Bracket bracket = crossings.count > 0 ? crossings.first : Bracket{0, largest};
  double guess = (equation.r - at_rest.tau) / equation.epsilon; // exact for limits that do not depend on s
  if (guess <= bracket.low || guess > bracket.high) guess = bracket.high;
  const Value root = find_root(equation, bracket, guess);
  return {.s = root.s, .limit = root.limit, .is_several = crossings.count > 1};
}

} // namespace amontons
