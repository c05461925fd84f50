#include "friction/slip_weakening.hpp"

#include "friction/weakening_check.hpp"

namespace amontons {

FrictionLimit SlipWeakening::limit(const FrictionContext& context, double p, double s,
                                   const FrictionState& state_old) const {
  const double D = state_old[0] + s;
  const bool weakens = D < D_c;
  const double f = context.factor * (weakens ? mu_s - (mu_s - mu_k) * D / D_c : mu_k);
  return {.tau = cohesion + f * p,
          .dtau_dp = f,
          .dtau_ds = weakens ? -context.factor * p * (mu_s - mu_k) / D_c : 0.0,
          .state = {D, 0.0}};
}

double SlipWeakening::steepest_weakening(const FrictionContext& context, double p, double,
                                         const FrictionState& state_old) const {
  return state_old[0] < D_c ? context.factor * p * (mu_s - mu_k) / D_c : 0.0;
}

Rule<SlipWeakening> slip_weakening_rule() {
  return ObjectRule<SlipWeakening>()
      .required("mu_s", &SlipWeakening::mu_s, number("1", Range::at_least(0)), "Friction coefficient before slip.")
      .required("mu_k", &SlipWeakening::mu_k, number("1", Range::at_least(0)),
                "Friction coefficient after the critical distance.")
      .required("D_c", &SlipWeakening::D_c, number("length", Range::above(0)), "Critical slip distance.")
      .optional("cohesion", &SlipWeakening::cohesion, number("stress", Range::at_least(0)),
                "Shear limit at zero pressure; does not weaken.")
      .check(check_weakens<SlipWeakening>);
}

} // namespace amontons
