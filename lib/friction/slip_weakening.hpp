// Friction that weakens linearly with accumulated slip.
#pragma once

#include "friction/law.hpp"

#include <string_view>

namespace amontons {

/// τ = c + p (μ_s − (μ_s − μ_k) min(D / D_c, 1)). State `slip_since_contact`: D, length, the slip since the point came
/// into contact: D = D_old + s.
/// First contact and re-contact: D = 0, the point has healed. dt has no influence.
/// Y. Ida, J. Geophys. Res. 77 (1972) 3796-3805; A. C. Palmer, J. R. Rice, Proc. R. Soc. A 332 (1973) 527-548.
struct SlipWeakening {
  double mu_s = 0.0;     // >= mu_k
  double mu_k = 0.0;     // >= 0
  double D_c = 1.0;      // length, > 0
  double cohesion = 0.0; // c, stress, >= 0
  static constexpr std::array<std::string_view, 1> state_names{"slip_since_contact"};

  FrictionLimit limit(const FrictionContext& context, double p, double s, const FrictionState& state_old) const;
  double steepest_weakening(const FrictionContext& context, double p, double s_max,
                            const FrictionState& state_old) const;
};

Rule<SlipWeakening> slip_weakening_rule();

} // namespace amontons
