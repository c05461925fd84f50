// Constant shear limit.
#pragma once

#include "friction/law.hpp"

namespace amontons {

/// τ = τ_max, whatever the pressure: sticking or shearing of the softer body's surface layer. Holds wherever there is
/// contact, at zero pressure too.
/// H. Tresca, C. R. Acad. Sci. Paris 59 (1864) 754; as a friction law: N. Kikuchi, J. T. Oden, Contact Problems in
/// Elasticity, SIAM (1988).
struct Tresca {
  double tau_max = 0.0; // stress, >= 0

  FrictionLimit limit(const FrictionContext&, double, double, const FrictionState&) const;
};

Rule<Tresca> tresca_rule();

} // namespace amontons
