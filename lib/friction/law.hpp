// What a friction law takes and gives at one point: plain numbers. A law limits the shear traction, |σ_t| <= τ(p, s);
// it knows no direction, no element and no unknown. Which way the traction points is for the return mapping.
#pragma once

#include <array>

namespace amontons {

/// State variables of a law at a point; a law uses the first `state_names.size()` of them, the others stay zero.
using FrictionState = std::array<double, 2>;

/// What a law may know of the increment besides pressure and slip.
struct FrictionContext {
  /// Duration of the increment, >= 0, unit of time. Each rate-dependent law says what it takes zero for.
  double dt = 0.0;
  /// Multiplies the friction coefficient of the law (all of it, rate and state terms included) at this point and time;
  /// >= 0. It is how a coefficient depends on place and time. Cohesions and shear limits are not multiplied.
  double factor = 1.0;
  /// The point was open at the last accepted increment: what it remembered is void, `state_old` is not looked at.
  bool new_contact = false;
};

/// The limit at (p, s) and its total derivatives: those of the state at the end of the increment with respect to p and
/// s are included.
struct FrictionLimit {
  double tau = 0.0;      // largest shear traction, >= 0, unit of stress
  double dtau_dp = 0.0;  // dimensionless
  double dtau_ds = 0.0;  // stress per length; one-sided (s -> 0+) at s = 0
  FrictionState state{}; // at the end of the increment
};

/// A key of the deck with its reader (deck/rule.hpp); each law declares its own.
template <class T>
struct Rule;

} // namespace amontons
