// Friction that forgets a change of pressure only with slip.
#pragma once

#include "friction/law.hpp"

#include <string_view>

namespace amontons {

/// τ = c + R, dR/dt = −((v + v*) / L)(R − μ p). State `resistance`: R, stress. With p its value at the end of the
/// increment, R is the exact solution: R = μ p + (R_old − μ p) exp(−(s + v* dt) / L). A jump of the pressure gives no
/// jump of the shear. dt = 0 is no exception: v* then adds nothing.
/// First contact and re-contact: R = μ p, nothing to forget. At p = 0 the memory is lost too (R = 0): surfaces that
/// just touch do not hold. V. Prakash, R. J. Clifton, in: Experimental Techniques in the Dynamics of Deformable Solids,
/// ASME AMD 165 (1993) 33-48; with v*: A. Cochard, J. R. Rice, J. Geophys. Res. 105 (2000) 25891-25907.
struct PrakashClifton {
  double mu = 0.0;         // >= 0
  double L = 1.0;          // length, > 0
  double creep_rate = 0.0; // v*, velocity, >= 0: relaxation at rest
  double cohesion = 0.0;   // c, stress, >= 0
  static constexpr std::array<std::string_view, 1> state_names{"resistance"};

  FrictionLimit limit(const FrictionContext& context, double p, double s, const FrictionState& state_old) const;
  FrictionState initial_state(const FrictionContext& context, double p) const;
  double steepest_weakening(const FrictionContext& context, double p, double s_max,
                            const FrictionState& state_old) const;
};

Rule<PrakashClifton> prakash_clifton_rule();

} // namespace amontons
