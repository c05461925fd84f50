// Smooth saturation of the shear traction with pressure.
#pragma once

#include "friction/law.hpp"

namespace amontons {

/// τ = c + k (1 − exp(−μ p / k)), k = τ_max − c: slope μ at zero pressure, limit τ_max at infinite pressure, where the
/// real area of contact has grown to the apparent one.
/// Regimes: M. C. Shaw, A. Ber, P. A. Mamin, J. Basic Eng. 82 (1960) 342-345. The exponential form: E. Usui,
/// T. Shirakashi, ASME PED 7 (1982) 13-35.
struct Shaw {
  double mu = 0.0;       // >= 0, slope at zero pressure
  double tau_max = 1.0;  // stress, > 0
  double cohesion = 0.0; // c, stress, 0 <= c < τ_max

  FrictionLimit limit(const FrictionContext& context, double p, double, const FrictionState&) const;
};

Rule<Shaw> shaw_rule();

} // namespace amontons
