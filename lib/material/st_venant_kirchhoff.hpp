// The law of St. Venant and Kirchhoff: linear elasticity between Green's strain and the second Piola-Kirchhoff stress.
#pragma once

#include "material/elastic.hpp"
#include "material/point.hpp"

namespace amontons {

/// W = λ/2 (tr E)² + G E : E,  E = (F^T F − 1) / 2,  P = F S,  S = λ tr(E) 1 + 2 G E.
/// For large rotations at small strains. In compression it softens: a bar held laterally has its largest nominal stress
/// at the stretch 1/√3, and det F -> 0 meets no resistance. Use NeoHookean or Hencky where strains are large.
///
/// A. J. C. B. de Saint-Venant, C. R. Acad. Sci. 24 (1847) 260; J. Bonet, R. D. Wood, Nonlinear Continuum Mechanics for
/// Finite Element Analysis, 2nd ed. (2008), ch. 6.
struct StVenantKirchhoff {
  Elastic elastic{}; // E, nu at zero strain

  double energy(const Tensor& F) const;
  Tensor piola(const Tensor& F) const;
  PiolaTangent tangent(const Tensor& F) const;
  Lame lame() const { return lame_constants(elastic, Space::Solid); }
};

Rule<StVenantKirchhoff> st_venant_kirchhoff_rule();

} // namespace amontons
