// Static and kinetic friction with a drop between them.
#pragma once

#include "friction/law.hpp"

#include <string_view>

namespace amontons {

/// τ = c + μ_s p at rest, c + μ_k p in motion. State `sliding`: 1 when the point slid in the last accepted increment,
/// else 0.
///   from rest:    the limit is c + μ_s p at s = 0 and c + μ_k p for every s > 0: a point that breaks loose drops at
///   once; from sliding: the limit is c + μ_k p for s = 0 too, so that a point that goes on sliding does not climb to
///   μ_s again
///                 in every increment. It is at rest once an increment ends without slip.
/// When c + μ_k p < |q| <= c + μ_s p a point at rest stays at rest.
/// First contact and re-contact: at rest. The slip rate and dt have no influence.
/// C. A. Coulomb, Mém. Math. Phys. Acad. Sci. 10 (1785) 161; E. Rabinowicz, Proc. Phys. Soc. 71 (1958) 668-675.
struct StaticKinetic {
  double mu_s = 0.0;     // >= mu_k
  double mu_k = 0.0;     // >= 0
  double cohesion = 0.0; // c, stress, >= 0
  static constexpr std::array<std::string_view, 1> state_names{"sliding"};

  FrictionLimit limit(const FrictionContext& context, double p, double s, const FrictionState& state_old) const;
};

Rule<StaticKinetic> static_kinetic_rule();

} // namespace amontons
