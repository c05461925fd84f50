#include "friction/shaw.hpp"

#include "deck/rule.hpp"

#include <cmath>

namespace amontons {

FrictionLimit Shaw::limit(const FrictionContext& context, double p, double, const FrictionState&) const {
  const double f = context.factor * mu;
  const double k = tau_max - cohesion;
  const double x = f * p / k;
  return {.tau = cohesion - k * std::expm1(-x), .dtau_dp = f * std::exp(-x)};
}

Rule<Shaw> shaw_rule() {
  return ObjectRule<Shaw>()
      .required("mu", &Shaw::mu, number("1", Range::at_least(0)), "Friction coefficient at low pressure.")
      .required("tau_max", &Shaw::tau_max, number("stress", Range::above(0)),
                "Shear traction that is approached at high pressure.")
      .optional("cohesion", &Shaw::cohesion, number("stress", Range::at_least(0)), "Shear limit at zero pressure.")
      .check([](const DeckNode& node, const Shaw& law, Reading& reading) {
        if (law.cohesion >= law.tau_max)
          reading.fail(node.place, node.path + " must have cohesion < tau_max, but has " + number_text(law.cohesion) +
                                       " >= " + number_text(law.tau_max) + ".");
      });
}

} // namespace amontons
