// From a trial traction to the shear traction that the law allows: stick, or radial return on the cone. The same code
// in 2D and 3D, for penalty (λ_t the last accepted traction) and for multipliers (λ_t the unknown).
#pragma once

#include "friction/friction_law.hpp"

#include <array>

namespace amontons {

using TangentVector = std::array<double, 3>; // third component zero in 2D
using TangentMatrix = std::array<std::array<double, 3>, 3>;

enum class FrictionStatus { Stick, Slip };

struct FrictionResponse {
  TangentVector traction{}; // σ_t, stress, along the trial traction
  double slip = 0.0;        // s >= 0, length, in this increment
  double tau_c = 0.0;       // the limit τ(p, s); the traction's size equals it in slip
  FrictionStatus status = FrictionStatus::Stick;
  /// Other slips solve the equation, too: the law weakens faster than ε. The smallest is given.
  bool is_several = false;
  FrictionState state{};        // at the end of the increment
  TangentMatrix dtraction_dq{}; // [i][j] = ∂σ_t,i / ∂q_j; symmetric, for q lies along σ_t
  TangentVector
      dtraction_dp{}; // ∂σ_t / ∂p: the coupling to pressure, which makes tangents of frictional contact unsymmetric
};

/// Direction of the traction times the slip: length.
std::array<double, 3> slip_vector(const FrictionResponse& response);

/// q = λ_t + ε Δg_t in the tangent plane; p = |σ_n| >= 0; ε > 0, stress per length.
///
///   stick  |q| <= τ(p, 0):  σ_t = q,  s = 0
///   slip   else:            |q| − ε s = τ(p, s),  σ_t = τ n,  n = q / |q|
///
/// of several s > 0 the smallest. Where the limit at s = 0 exceeds that in motion, stick wins (see StaticKinetic).
/// Derivatives by implicit differentiation of |q| = ε s + τ(p, s):
///
///   ∂τ/∂|q| = τ_s / (ε + τ_s),  ∂τ/∂p = τ_p ε / (ε + τ_s),  ∂σ_t/∂q = ∂τ/∂|q| n⊗n + τ / |q| (1 − n⊗n)
///
/// They hold for any change of q, also out of the plane. The power of friction σ_t · n s = τ s is never negative.
///
/// Special cases: p = 0: the limit is the cohesion (or what the law says), any q is defined. A limit of zero (μ = 0):
/// no traction and no derivative. q = 0 with a limit of zero that grows with s (rate and state): the derivative of
/// slip. Where two solutions merge (ε + τ_s = 0) the derivative is infinite; the divisor is kept above 1e-8 ε.
FrictionResponse return_map(const FrictionLaw& law, const FrictionContext& context, const TangentVector& q, double p,
                            double epsilon, const FrictionState& state_old);

/// What the first tangent of an increment takes for the response, before anything has moved: that of sliding on along q
/// by `slip` (length; that of the last increment, at the same rate), or of sticking where it is zero. Without it a
/// point at its limit sticks, and a region that slides is found anew in each increment, from its edge inwards.
FrictionResponse guess_response(const FrictionLaw& law, const FrictionContext& context, const TangentVector& q,
                                double p, double epsilon, const FrictionState& state_old, double slip);

} // namespace amontons
