// Compressible neo-Hookean elasticity.
#pragma once

#include "material/elastic.hpp"
#include "material/point.hpp"

namespace amontons {

/// W = G/2 (tr C − 3 − 2 ln J) + λ/2 (ln J)²,  P = G (F − F^-T) + λ ln J F^-T.
/// The volumetric term is λ/2 (ln J)²; the first term is not isochoric, so a pressure belongs to both. λ and G are
/// those of linear elasticity at zero strain. (ln J)² is not convex for J > e; such volumes do not occur in solids.
///
/// J. C. Simo, K. S. Pister, Comput. Methods Appl. Mech. Eng. 46 (1984) 201-215; J. Bonet, R. D. Wood, Nonlinear
/// Continuum Mechanics for Finite Element Analysis, 2nd ed. (2008), ch. 6.
struct NeoHookean {
  Elastic elastic{}; // E, nu at zero strain

  double energy(const Tensor& F) const;
  Tensor piola(const Tensor& F) const;
  PiolaTangent tangent(const Tensor& F) const;
  Lame lame() const { return lame_constants(elastic, Space::Solid); }
};

Rule<NeoHookean> neo_hookean_rule();

} // namespace amontons
