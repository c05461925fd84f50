// Linear isotropic elasticity, pointwise: parameters, constants, stress, energy and moduli as pure functions of
// numbers.
#pragma once

#include "math/space.hpp"
#include "math/tensor.hpp"

namespace amontons {

/// σ = λ tr(ε) 1 + 2 G ε over the in-plane components (all three in axisymmetric and solid space). Same unit as stress.
struct Lame {
  double lambda;
  double G;
};

/// Young's modulus E = G (3 λ + 2 G) / (λ + G), of three-dimensional constants.
inline double young(const Lame& lame) { return lame.G * (3 * lame.lambda + 2 * lame.G) / (lame.lambda + lame.G); }

/// Parameters as a user knows them.
struct Elastic {
  double young;   // E > 0, unit of stress
  double poisson; // -1 < nu < 1/2
};

/// The constants with which σ = λ tr(ε) 1 + 2 G ε holds in the given space. Plane stress: σ_zz = 0 condenses ε_zz out,
/// which leaves the in-plane law with λ* = 2 λ G / (λ + 2 G) = E nu / (1 - nu²).
/// Throws UserError for parameters outside their range.
Lame lame_constants(const Elastic& material, Space space);

/// σ(ε). In plane stress ε_zz is ignored and σ_zz = 0.
template <int dim>
Stress<dim> elastic_stress(const Lame& lame, Space space, const Strain<dim>& strain);

/// ½ σ : ε, energy per volume.
template <int dim>
double elastic_energy(const Lame& lame, Space space, const Strain<dim>& strain);

/// dσ/dε with engineering shear strains.
template <int dim>
Moduli<dim> elastic_moduli(const Lame& lame, Space space);

/// ε_zz = -nu / (1 - nu) (ε_xx + ε_yy) in plane stress.
double plane_stress_zz_strain(const Elastic& material, double xx, double yy);

} // namespace amontons
