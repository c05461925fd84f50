#include "friction/weakening_strengthening.hpp"

#include "friction/weakening_check.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

FrictionLimit WeakeningStrengthening::limit(const FrictionContext& context, double p, double s,
                                            const FrictionState&) const {
  const double per_time = context.dt > 0 ? 1 / context.dt : 0.0;
  const double v = s * per_time;
  const double excess = (mu_s - mu_k) * std::exp(-v / v_c);
  const double f = context.factor * (mu_k + excess + kappa * v);
  return {.tau = cohesion + f * p, .dtau_dp = f, .dtau_ds = context.factor * p * (kappa - excess / v_c) * per_time};
}

double WeakeningStrengthening::steepest_weakening(const FrictionContext& context, double p, double,
                                                  const FrictionState&) const {
  if (context.dt <= 0) return 0;
  return context.factor * p * std::max(0.0, (mu_s - mu_k) / v_c - kappa) / context.dt; // at s = 0
}

Rule<WeakeningStrengthening> weakening_strengthening_rule() {
  using Law = WeakeningStrengthening;
  return ObjectRule<Law>()
      .required("mu_s", &Law::mu_s, number("1", Range::at_least(0)), "Friction coefficient at rest.")
      .required("mu_k", &Law::mu_k, number("1", Range::at_least(0)),
                "What the coefficient would fall to without strengthening.")
      .required("v_c", &Law::v_c, number("length / time", Range::above(0)), "Slip rate over which it weakens.")
      .required("kappa", &Law::kappa, number("time / length", Range::at_least(0)),
                "Growth of the coefficient with the slip rate.")
      .optional("cohesion", &Law::cohesion, number("stress", Range::at_least(0)), "Shear limit at zero pressure.")
      .check(check_weakens<Law>);
}

} // namespace amontons
