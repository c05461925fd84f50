#include "friction/orowan.hpp"

#include "deck/rule.hpp"

namespace amontons {

FrictionLimit Orowan::limit(const FrictionContext& context, double p, double, const FrictionState&) const {
  const double f = context.factor * mu;
  if (cohesion + f * p > tau_max) return {.tau = tau_max};
  return {.tau = cohesion + f * p, .dtau_dp = f};
}

Rule<Orowan> orowan_rule() {
  return ObjectRule<Orowan>()
      .required("mu", &Orowan::mu, number("1", Range::at_least(0)), "Friction coefficient at low pressure.")
      .required("tau_max", &Orowan::tau_max, number("stress", Range::at_least(0)), "Largest shear traction.")
      .optional("cohesion", &Orowan::cohesion, number("stress", Range::at_least(0)), "Shear limit at zero pressure.")
      .check([](const DeckNode& node, const Orowan& law, Reading& reading) {
        if (law.cohesion > law.tau_max)
          reading.fail(node.place, node.path + " must have cohesion <= tau_max, but has " + number_text(law.cohesion) +
                                       " > " + number_text(law.tau_max) + ".");
      });
}

} // namespace amontons
