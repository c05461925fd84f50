#include "friction/coulomb.hpp"

#include "deck/rule.hpp"

namespace amontons {

FrictionLimit Coulomb::limit(const FrictionContext& context, double p, double, const FrictionState&) const {
  const double f = context.factor * mu;
  return {.tau = cohesion + f * p, .dtau_dp = f};
}

Rule<Coulomb> coulomb_rule() {
  return ObjectRule<Coulomb>()
      .required("mu", &Coulomb::mu, number("1", Range::at_least(0)), "Friction coefficient.")
      .optional("cohesion", &Coulomb::cohesion, number("stress", Range::at_least(0)),
                "Shear limit at zero pressure, added to mu times pressure.");
}

} // namespace amontons
