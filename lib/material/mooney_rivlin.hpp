// Mooney-Rivlin elasticity of rubber, slightly compressible.
#pragma once

#include "material/elastic.hpp"
#include "material/point.hpp"

namespace amontons {

/// W = C10 (Ī1 − 3) + C01 (Ī2 − 3) + U(J),  Ī1 = J^(-2/3) tr C,  Ī2 = J^(-4/3) (tr²C − tr C²) / 2,
/// U = K/4 (J² − 1 − 2 ln J), which is convex and infinite at J -> 0; the pressure −U' belongs to U alone. At zero
/// strain G = 2 (C10 + C01) and the bulk modulus is K. C01 = 0 is the isochoric neo-Hookean law.
///
/// M. Mooney, J. Appl. Phys. 11 (1940) 582-592; R. S. Rivlin, Phil. Trans. R. Soc. A 241 (1948) 379-397; U: J. C. Simo,
/// T. J. R. Hughes, Computational Inelasticity (1998), ch. 9.
struct MooneyRivlin {
  double C_10 = 1.0; // stress, > 0
  double C_01 = 0.0; // stress, >= 0
  double K = 1.0;    // bulk modulus, stress, > 0

  double energy(const Tensor& F) const;
  Tensor piola(const Tensor& F) const;
  PiolaTangent tangent(const Tensor& F) const;
  Lame lame() const;
};

Rule<MooneyRivlin> mooney_rivlin_rule();

} // namespace amontons
