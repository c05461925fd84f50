// Hencky elasticity: linear elasticity in the logarithmic strain.
#pragma once

#include "material/elastic.hpp"
#include "material/log_strain.hpp"

namespace amontons {

/// W = λ/2 (ln J)² + G E : E,  E = ln U;  Kirchhoff stress τ = R (λ ln J 1 + 2 G E) R^T,  P = τ F^-T.
/// What linear elasticity becomes at finite strain, and the elastic part of FinitePlastic. Good between stretches of
/// about 0.7 and 1.4: the force on a bar has a maximum at the stretch e, the stress in simple shear at γ = 3.02 (τ = 2
/// G x / cosh x, x = asinh(γ / 2)).
///
/// H. Hencky, Z. Tech. Phys. 9 (1928) 215-220; L. Anand, J. Appl. Mech. 46 (1979) 78-82.
struct Hencky {
  Elastic elastic{}; // E, nu

  double energy(const Tensor& F) const;
  Tensor piola(const Tensor& F) const;
  PiolaTangent tangent(const Tensor& F) const;
  Lame lame() const { return lame_constants(elastic, Space::Solid); }
};

} // namespace amontons
