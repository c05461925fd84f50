// Were small kinematics enough? How large rotations, strains and the terms are that they leave out.
#pragma once

#include "math/space.hpp"
#include "mesh/mesh.hpp"

#include <span>

namespace amontons {

/// Largest values over the centres of all cells, of the displacement gradient H: dimensionless, the rotation in
/// radians.
struct KinematicsAudit {
  double rotation = 0.0; // |w|, w the axial vector of the skew part of H
  double strain = 0.0;   // Frobenius norm of ε = ½ (H + Hᵀ), with the hoop strain in axisymmetric space
  /// Frobenius norm of ½ Hᵀ H, which the Green-Lagrange strain ½ (H + Hᵀ + Hᵀ H) has besides ε (Bathe, Finite Element
  /// Procedures, 2nd ed. 2014, section 6.2.2). A body that merely rotates by θ has about ½ θ² of it and no strain.
  double neglected = 0.0;

  /// What is left out over the largest strain; 0 where nothing moves.
  double ratio() const { return strain > 0.0 ? neglected / strain : 0.0; }
};

/// `displacement`: num_local x dim. Collective.
KinematicsAudit audit_kinematics(const Mesh& mesh, Space space, std::span<const double> displacement);

} // namespace amontons
