#include "friction/static_kinetic.hpp"

#include "friction/weakening_check.hpp"

namespace amontons {

FrictionLimit StaticKinetic::limit(const FrictionContext& context, double p, double s,
                                   const FrictionState& state_old) const {
  const bool slides = s > 0;
  const double f = context.factor * (slides || state_old[0] > 0 ? mu_k : mu_s);
  return {.tau = cohesion + f * p, .dtau_dp = f, .state = {slides ? 1.0 : 0.0, 0.0}};
}

Rule<StaticKinetic> static_kinetic_rule() {
  return ObjectRule<StaticKinetic>()
      .required("mu_s", &StaticKinetic::mu_s, number("1", Range::at_least(0)), "Friction coefficient at rest.")
      .required("mu_k", &StaticKinetic::mu_k, number("1", Range::at_least(0)), "Friction coefficient in motion.")
      .optional("cohesion", &StaticKinetic::cohesion, number("stress", Range::at_least(0)),
                "Shear limit at zero pressure.")
      .check(check_weakens<StaticKinetic>);
}

} // namespace amontons
