// Rate-and-state friction with the slip law (Ruina) or the ageing law (Dieterich).
#pragma once

#include "friction/law.hpp"

#include <string_view>

namespace amontons {

enum class StateEvolution { Slip, Ageing };

/// τ = c + p f,  f = μ + b θ + a ln(v / v0), regularized near v = 0 to
///     f = a asinh( v / (2 v0) exp((μ + b θ) / a) ),
/// which is zero at v = 0 and differs from the logarithm by less than a exp(−2 f / a): nothing where f >> a, that is at
/// any rate that is seen. State `theta`: θ, dimensionless (θ = ln(v0 Θ / L) for the state Θ in units of time),
///     Slip:    dθ/dt = −(v / L)(θ + ln(v / v0))
///     Ageing:  dΘ/dt = 1 − v Θ / L
/// Both have the steady state θ = −ln(v / v0). v = s / dt is constant in the increment and the state at its end is the
/// exact solution at that v, so θ depends on s implicitly and steps at constant rate have no time error, whatever their
/// length:
///     Slip:    θ = θ_old e^(−x) − ln(v / v0)(1 − e^(−x)),             x = s / L
///     Ageing:  e^θ = e^θ_old e^(−x) + (v0 dt / L) (1 − e^(−x)) / x
/// v = 0: τ = c, the slip law keeps θ, the ageing law heals, e^θ = e^θ_old + v0 dt / L. Without cohesion there is no
/// stick: any traction creeps, at rates that may be as small as 1e-300. dt = 0: the slip is taken at the reference
/// rate, v = v0 for every s (also s = 0), and lasts s / v0. Then f ≈ μ + b θ, below which the point sticks: pressing
/// without a time is possible. First contact and re-contact: θ = theta_initial; the default 0 is the steady state at
/// v0. A. Ruina, J. Geophys. Res. 88 (1983) 10359-10370; J. H. Dieterich, J. Geophys. Res. 84 (1979) 2161-2168; G.
/// Perrin, J. R. Rice, G. Zheng, J. Mech. Phys. Solids 43 (1995) 1461-1495; regularization: J. R. Rice, Y. Ben-Zion,
/// Proc. Natl. Acad. Sci. 93 (1996) 3811-3818.
struct RateAndState {
  double mu = 0.0;            // steady coefficient at v0, >= 0
  double a = 1.0;             // direct effect, > 0
  double b = 0.0;             // evolution effect, >= 0
  double L = 1.0;             // length, > 0
  double v0 = 1.0;            // reference rate, > 0
  double theta_initial = 0.0; // θ when contact begins
  double cohesion = 0.0;      // c, stress, >= 0
  StateEvolution evolution = StateEvolution::Slip;
  static constexpr std::array<std::string_view, 1> state_names{"theta"};

  FrictionLimit limit(const FrictionContext& context, double p, double s, const FrictionState& state_old) const;
  FrictionState initial_state(const FrictionContext& context, double p) const;
  double steepest_weakening(const FrictionContext& context, double p, double s_max,
                            const FrictionState& state_old) const;
};

Rule<RateAndState> rate_and_state_rule();

} // namespace amontons
