#include "friction/tresca.hpp"

#include "deck/rule.hpp"

namespace amontons {

FrictionLimit Tresca::limit(const FrictionContext&, double, double, const FrictionState&) const {
  return {.tau = tau_max};
}

Rule<Tresca> tresca_rule() {
  return ObjectRule<Tresca>().required("tau_max", &Tresca::tau_max, number("stress", Range::at_least(0)),
                                       "Shear traction at which the surfaces slide, whatever the pressure.");
}

} // namespace amontons
