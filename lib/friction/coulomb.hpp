// The law of Amontons and Coulomb, with cohesion.
#pragma once

#include "friction/law.hpp"

namespace amontons {

/// τ = c + μ p, p = |σ_n|.
/// G. Amontons, Mém. Acad. R. Sci. (1699) 206; C. A. Coulomb, Mém. Math. Phys. Acad. Sci. 10 (1785) 161.
struct Coulomb {
  double mu = 0.0;       // >= 0
  double cohesion = 0.0; // c, stress, >= 0: the limit at zero pressure, while there is contact

  FrictionLimit limit(const FrictionContext& context, double p, double, const FrictionState&) const;
};

Rule<Coulomb> coulomb_rule();

} // namespace amontons
