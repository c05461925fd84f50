#include "friction/velocity_weakening.hpp"

#include "friction/weakening_check.hpp"

#include <cmath>

namespace amontons {

FrictionLimit VelocityWeakening::limit(const FrictionContext& context, double p, double s, const FrictionState&) const {
  const double inverse_length = context.dt > 0 ? 1 / (v_c * context.dt) : 0.0;
  const double excess = (mu_s - mu_k) * std::exp(-s * inverse_length);
  const double f = context.factor * (mu_k + excess);
  return {.tau = cohesion + f * p, .dtau_dp = f, .dtau_ds = -context.factor * p * excess * inverse_length};
}

double VelocityWeakening::steepest_weakening(const FrictionContext& context, double p, double,
                                             const FrictionState&) const {
  return context.dt > 0 ? context.factor * p * (mu_s - mu_k) / (v_c * context.dt) : 0.0; // at s = 0
}

Rule<VelocityWeakening> velocity_weakening_rule() {
  return ObjectRule<VelocityWeakening>()
      .required("mu_s", &VelocityWeakening::mu_s, number("1", Range::at_least(0)), "Friction coefficient at rest.")
      .required("mu_k", &VelocityWeakening::mu_k, number("1", Range::at_least(0)),
                "Friction coefficient at high rates.")
      .required("v_c", &VelocityWeakening::v_c, number("length / time", Range::above(0)),
                "Slip rate at which a share 1/e of the difference is left.")
      .optional("cohesion", &VelocityWeakening::cohesion, number("stress", Range::at_least(0)),
                "Shear limit at zero pressure.")
      .check(check_weakens<VelocityWeakening>);
}

} // namespace amontons
