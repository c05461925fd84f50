#include "friction/prakash_clifton.hpp"

#include "deck/rule.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

FrictionLimit PrakashClifton::limit(const FrictionContext& context, double p, double s,
                                    const FrictionState& state_old) const {
  const double f = context.factor * mu;
  if (context.new_contact || p <= 0) return {.tau = cohesion + f * p, .dtau_dp = f, .state = {f * p, 0.0}};
  const double x = (s + creep_rate * context.dt) / L;
  const double memory = (state_old[0] - f * p) * std::exp(-x);
  const double resistance = f * p + memory;
  return {
      .tau = cohesion + resistance, .dtau_dp = -f * std::expm1(-x), .dtau_ds = -memory / L, .state = {resistance, 0.0}};
}

FrictionState PrakashClifton::initial_state(const FrictionContext& context, double p) const {
  return {context.factor * mu * p, 0.0};
}

double PrakashClifton::steepest_weakening(const FrictionContext& context, double p, double,
                                          const FrictionState& state_old) const {
  if (context.new_contact || p <= 0) return 0;
  return std::max(0.0, state_old[0] - context.factor * mu * p) * std::exp(-creep_rate * context.dt / L) / L; // at s = 0
}

Rule<PrakashClifton> prakash_clifton_rule() {
  using Law = PrakashClifton;
  return ObjectRule<Law>()
      .required("mu", &Law::mu, number("1", Range::at_least(0)), "Friction coefficient at constant pressure.")
      .required("L", &Law::L, number("length", Range::above(0)), "Slip over which the resistance follows the pressure.")
      .optional("creep_rate", &Law::creep_rate, number("length / time", Range::at_least(0)),
                "Added to the slip rate in the relaxation; relaxes at rest.")
      .optional("cohesion", &Law::cohesion, number("stress", Range::at_least(0)), "Shear limit at zero pressure.");
}

} // namespace amontons
