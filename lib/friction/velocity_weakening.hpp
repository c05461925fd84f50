// Friction that weakens smoothly with the slip rate.
#pragma once

#include "friction/law.hpp"

namespace amontons {

/// τ = c + p (μ_k + (μ_s − μ_k) exp(−v / v_c)), v = s / dt; dt = 0: v = 0, the static coefficient.
/// L. C. Bo, D. Pavelescu, Wear 82 (1982) 277-289.
struct VelocityWeakening {
  double mu_s = 0.0;     // >= mu_k
  double mu_k = 0.0;     // >= 0
  double v_c = 1.0;      // velocity, > 0
  double cohesion = 0.0; // c, stress, >= 0

  FrictionLimit limit(const FrictionContext& context, double p, double s, const FrictionState&) const;
  double steepest_weakening(const FrictionContext& context, double p, double s_max, const FrictionState&) const;
};

Rule<VelocityWeakening> velocity_weakening_rule();

} // namespace amontons
