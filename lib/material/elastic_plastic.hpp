// Parameters of elastoplasticity after von Mises (J2): elasticity, isotropic hardening, and what is asked for besides.
// The same material serves small strain (SmallPlastic) and finite strain (FinitePlastic).
#pragma once

#include "material/elastic.hpp"
#include "material/hardening.hpp"

#include <optional>

namespace amontons {

/// Linear kinematic hardening: backstress dβ = 2/3 H dε_p, so that H is its slope in a uniaxial test. The energy
/// H/3 ε_p : ε_p of the backstress is stored, not dissipated.
/// W. Prager, Proc. Inst. Mech. Eng. 169 (1955) 41-57; H. Ziegler, Q. Appl. Math. 17 (1959) 55-65.
struct Prager {
  double H = 1.0; // stress, > 0
};
using KinematicHardening = std::variant<Prager>;

/// Overstress: flow at the rate dp/dt = D (q / σ_y(p) − 1)^n for q > σ_y, that is q = σ_y(p) (1 + (dp/dt / D)^(1/n)).
/// dt = 0: no time to flow, the response is elastic (the limit of dt -> 0). D -> infinity or slow loading: the law
/// without rate. With static σ_y this is the law of Cowper and Symonds.
/// P. Perzyna, Adv. Appl. Mech. 9 (1966) 243-377; G. R. Cowper, P. S. Symonds, Brown University TR 28 (1957).
struct Perzyna {
  double D = 1.0; // rate at which the stress is doubled, 1 / time, > 0
  double n = 1.0; // >= 1
};
using RateDependence = std::variant<Perzyna>;

struct ElasticPlastic {
  Elastic elastic{};
  Hardening hardening;
  std::optional<KinematicHardening> kinematic;
  std::optional<RateDependence> rate;
};

/// Slope H of kinematic hardening, 0 without.
double kinematic_modulus(const ElasticPlastic& material);

/// `{E: 210e3, nu: 0.3, hardening: {...}, kinematic: {prager: {H: 500}}, rate: {perzyna: {D: 40, n: 5}}}`
Rule<ElasticPlastic> elastic_plastic_rule();

} // namespace amontons
