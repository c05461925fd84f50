// Friction that weakens with the slip rate and strengthens again at high rates.
#pragma once

#include "friction/law.hpp"

namespace amontons {

/// τ = c + p (μ_k + (μ_s − μ_k) exp(−v / v_c) + κ v), v = s / dt; dt = 0: v = 0, the static coefficient.
/// Smallest at v = v_c ln((μ_s − μ_k) / (κ v_c)) where that is positive; else it only strengthens. Convex in s.
/// R. Stribeck, Z. VDI 46 (1902) 1341; this form: B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30
/// (1994) 1083-1138.
struct WeakeningStrengthening {
  double mu_s = 0.0;     // >= mu_k
  double mu_k = 0.0;     // >= 0
  double v_c = 1.0;      // velocity, > 0
  double kappa = 0.0;    // time / length, >= 0
  double cohesion = 0.0; // c, stress, >= 0

  FrictionLimit limit(const FrictionContext& context, double p, double s, const FrictionState&) const;
  double steepest_weakening(const FrictionContext& context, double p, double s_max, const FrictionState&) const;
};

Rule<WeakeningStrengthening> weakening_strengthening_rule();

} // namespace amontons
