// All friction laws as one type, and what callers ask of any of them. The list below and the list of tags in
// friction_law.cpp are the registry.
#pragma once

#include "friction/coulomb.hpp"
#include "friction/orowan.hpp"
#include "friction/prakash_clifton.hpp"
#include "friction/rate_and_state.hpp"
#include "friction/shaw.hpp"
#include "friction/slip_weakening.hpp"
#include "friction/static_kinetic.hpp"
#include "friction/tresca.hpp"
#include "friction/velocity_weakening.hpp"
#include "friction/weakening_strengthening.hpp"

#include <span>
#include <string_view>
#include <variant>

namespace amontons {

using FrictionLaw = std::variant<Coulomb, Tresca, Orowan, Shaw, StaticKinetic, VelocityWeakening,
                                 WeakeningStrengthening, SlipWeakening, RateAndState, PrakashClifton>;

/// Limit, derivatives and new state at pressure p >= 0 and slip s >= 0 in the increment. With `new_contact` the law
/// starts from its initial state at this very p, and the derivatives include that.
FrictionLimit friction_limit(const FrictionLaw& law, const FrictionContext& context, double p, double s,
                             const FrictionState& state_old);

/// The state with which a contact of pressure p begins, at first contact as at each re-contact. An open point has no
/// state: whoever keeps states stores this (or anything) for it and sets `new_contact` when it closes.
FrictionState initial_state(const FrictionLaw& law, const FrictionContext& context, double p);

/// An upper bound of −dτ/ds over 0 < s <= s_max, >= 0, stress per length. A drop at s = 0 itself does not count.
double steepest_weakening(const FrictionLaw& law, const FrictionContext& context, double p, double s_max,
                          const FrictionState& state_old);

/// Names of the law's state variables in results; empty for a law without memory.
std::span<const std::string_view> state_names(const FrictionLaw& law);

/// `{coulomb: {mu: 0.3}}` and so on: reads, checks and documents any law.
Rule<FrictionLaw> friction_law_rule();

} // namespace amontons
