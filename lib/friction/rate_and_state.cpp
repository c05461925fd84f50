#include "friction/rate_and_state.hpp"

#include "deck/rule.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace amontons {
namespace {

struct Theta {
  double value;
  double ds; // dθ/ds
};

/// g(x) = (1 − e^(−x)) / x and its derivative (e^(−x) − g) / x, by series where the quotients would cancel.
struct Relaxation {
  double g, dg;
};
Relaxation relaxation(double x) {
  if (x < 1e-3)
    return {1 - x * (0.5 - x * (1.0 / 6 - x * (1.0 / 24 - x / 120))), -0.5 + x * (1.0 / 3 - x * (0.125 - x / 30))};
  const double g = -std::expm1(-x) / x;
  return {g, (std::exp(-x) - g) / x};
}

/// Slip law; s > 0.
Theta slip_state(const RateAndState& law, double dt, double s, double theta_old) {
  const double x = s / law.L, left = std::exp(-x), gone = -std::expm1(-x);
  const double log_rate = dt > 0 ? std::log(s / dt / law.v0) : 0.0;
  const double log_rate_ds = dt > 0 ? 1 / s : 0.0;
  return {theta_old * left - log_rate * gone, -(theta_old + log_rate) * left / law.L - gone * log_rate_ds};
}

/// Ageing law through φ = e^θ = v0 Θ / L.
Theta ageing_state(const RateAndState& law, double dt, double s, double theta_old) {
  const double x = s / law.L, left = std::exp(theta_old - x);
  double phi = left, phi_ds = -left / law.L;
  if (dt > 0) {
    const auto [g, dg] = relaxation(x);
    phi += law.v0 * dt / law.L * g;
    phi_ds += law.v0 * dt / (law.L * law.L) * dg;
  } else {
    phi -= std::expm1(-x);
    phi_ds += std::exp(-x) / law.L;
  }
  return {std::log(phi), phi_ds / phi};
}

/// asinh(e^y) and its derivative without overflow.
struct AsinhExp {
  double value, derivative;
};
AsinhExp asinh_exp(double y) {
  if (y > 20) return {y + std::numbers::ln2 + 0.25 * std::exp(-2 * y), 1 / std::sqrt(1 + std::exp(-2 * y))};
  const double e = std::exp(y);
  return {std::asinh(e), e / std::sqrt(1 + e * e)};
}

/// s = 0 with time passing: v = 0. The slope is that of asinh at zero, capped where it leaves the range of numbers.
FrictionLimit at_rest(const RateAndState& law, const FrictionContext& context, double p, double theta_old) {
  const double theta =
      law.evolution == StateEvolution::Slip ? theta_old : ageing_state(law, context.dt, 0, theta_old).value;
  const double exponent = std::min((law.mu + law.b * theta) / law.a, 600.0);
  return {.tau = law.cohesion,
          .dtau_ds = context.factor * p * law.a * std::exp(exponent) / (2 * law.v0 * context.dt),
          .state = {theta, 0.0}};
}

} // namespace

FrictionLimit RateAndState::limit(const FrictionContext& context, double p, double s,
                                  const FrictionState& state_old) const {
  const double dt = context.dt;
  if (dt > 0 && s <= 0) return at_rest(*this, context, p, state_old[0]);
  const auto [theta, theta_ds] = evolution == StateEvolution::Slip ? slip_state(*this, dt, s, state_old[0])
                                                                   : ageing_state(*this, dt, s, state_old[0]);
  const double log_rate = dt > 0 ? std::log(s / dt / v0) : 0.0;
  const double log_rate_ds = dt > 0 ? 1 / s : 0.0;
  const auto [value, derivative] = asinh_exp(log_rate - std::numbers::ln2 + (mu + b * theta) / a);
  const double f = context.factor * a * value;
  return {.tau = cohesion + f * p,
          .dtau_dp = f,
          .dtau_ds = context.factor * p * derivative * (a * log_rate_ds + b * theta_ds),
          .state = {theta, 0.0}};
}

FrictionState RateAndState::initial_state(const FrictionContext&, double) const { return {theta_initial, 0.0}; }

// −dτ/ds <= p (−b dθ/ds − a / s), and −L dθ/ds is below 1 for the ageing law and below max(0, θ_old + ln(v / v0)) + 1
// for the slip law ((1 − e^(−x)) / x <= 1).
double RateAndState::steepest_weakening(const FrictionContext& context, double p, double s_max,
                                        const FrictionState& state_old) const {
  const double dt = context.dt;
  double fall = 1.0;
  if (evolution == StateEvolution::Slip)
    fall += std::max(0.0, state_old[0] + (dt > 0 ? std::log(s_max / dt / v0) : 0.0));
  return context.factor * p * std::max(0.0, b * fall / L - (dt > 0 ? a / s_max : 0.0));
}

Rule<RateAndState> rate_and_state_rule() {
  using Law = RateAndState;
  WordRule<StateEvolution> evolution;
  evolution.word("slip", StateEvolution::Slip, "Slip law: the state changes only with slip.")
      .word("ageing", StateEvolution::Ageing, "Ageing law: contacts heal at rest, too.");
  return ObjectRule<Law>()
      .required("mu", &Law::mu, number("1", Range::at_least(0)), "Steady friction coefficient at the rate v0.")
      .required("a", &Law::a, number("1", Range::above(0)), "Direct effect of the logarithm of the slip rate.")
      .required("b", &Law::b, number("1", Range::at_least(0)), "Effect of the state.")
      .required("L", &Law::L, number("length", Range::above(0)), "Slip over which the state evolves.")
      .required("v0", &Law::v0, number("length / time", Range::above(0)), "Reference slip rate.")
      .optional("theta_initial", &Law::theta_initial, number("1", Range::between(-500, 500)),
                "State when contact begins; 0: steady sliding at v0.")
      .optional("cohesion", &Law::cohesion, number("stress", Range::at_least(0)), "Shear limit at zero pressure.")
      .optional("evolution", &Law::evolution, evolution, "How the state evolves.");
}

} // namespace amontons
