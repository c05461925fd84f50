// Coulomb's law up to a maximum shear.
#pragma once

#include "friction/law.hpp"

namespace amontons {

/// τ = min(c + μ p, τ_max): sliding until the softer surface itself yields in shear. At the kink the derivative is that
/// of the Coulomb side.
/// E. Orowan, Proc. Inst. Mech. Eng. 150 (1943) 140-167.
struct Orowan {
  double mu = 0.0;       // >= 0
  double tau_max = 0.0;  // stress, >= 0
  double cohesion = 0.0; // c, stress, 0 <= c <= τ_max

  FrictionLimit limit(const FrictionContext& context, double p, double, const FrictionState&) const;
};

Rule<Orowan> orowan_rule();

} // namespace amontons
