// Kinematics of laws that are linear elasticity between logarithmic strain and rotated Kirchhoff stress: from F to the
// strain, and from the stress back to P and dP/dF. A flow rule between the two looks as at small strain.
#pragma once

#include "material/elastic.hpp"
#include "material/point.hpp"

namespace amontons {

/// F = R U with U = Σ λ_a N_a N_a^T; the logarithmic (Hencky) strain is E = ln U = Σ ln λ_a N_a N_a^T.
struct LogStrain {
  Tensor F;
  Eigen::Vector3d stretch; // λ_a, ascending
  Tensor directions;       // N_a in column a; any basis where stretches coalesce
  Tensor E;                // ln U
  Tensor inverse_stretch;  // U^-1
};

/// det F > 0. Small strains have all their digits: the spectrum is that of U² − 1. Of large ones ln λ has an error of
/// up to 5e-15 max(1, λ_max)² / λ_min². Where F^T F leaves the range of numbers the strain is not finite.
LogStrain log_strain(const Tensor& F);

/// dT/dE of a stress that is isotropic but for one direction of flow n, |n| = 1, tr n = 0:
/// dT = bulk tr(dE) 1 + shear dev dE − drop n (n : dE). Elasticity: shear = 2 G, drop = 0.
struct FlowModuli {
  double bulk = 0.0;
  double shear = 0.0;
  double drop = 0.0;
  Tensor flow = Tensor::Zero(); // n
};

/// P = R T U^-1: the stress T in the axes of the rotated material (R T R^T is the Kirchhoff stress τ).
Tensor piola_stress(const LogStrain& strain, const Tensor& T);

/// d(R T(E) U^-1 G^T)/dF for strain = log_strain(F G), G constant (1 for elasticity, F_p^-1 in plasticity). Derivation
/// in the source: only log_quotient and sums of stretches stand in it, so coalescing stretches need no care.
PiolaTangent piola_tangent(const LogStrain& strain, const Tensor& T, const FlowModuli& moduli, const Tensor& G);

} // namespace amontons
