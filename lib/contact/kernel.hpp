// The contact law at a point, the same for every formulation (they differ only in where λ comes from):
//   λ̂ = λ + ε g,  contact when λ̂ < 0,  σ = min(0, λ̂)
// the derivative of the augmented Lagrangian (σ² − λ²) / (2 ε) of Alart and Curnier (1991), Comput. Methods Appl. Mech.
// Eng. 92, 353-375, with the sign of λ that is negative in compression. Pure functions of numbers.
#pragma once

#include <algorithm>

namespace amontons {

/// λ̂, force per area.
inline double augmented_traction(double lambda, double epsilon, double gap) { return lambda + epsilon * gap; }

/// Normal traction σ_n <= 0.
inline double normal_traction(double augmented) { return std::min(0.0, augmented); }

/// dσ_n / dλ̂: 1 in contact, 0 when open.
inline double normal_traction_derivative(double augmented) { return augmented < 0.0 ? 1.0 : 0.0; }

/// The potential whose derivative with respect to the gap is σ_n; energy per area. `multiplier_square`: λ², or what
/// stands for it when multipliers are lumped.
inline double contact_potential(double augmented, double multiplier_square, double epsilon) {
  const double sigma = normal_traction(augmented);
  return (sigma * sigma - multiplier_square) / (2.0 * epsilon);
}

} // namespace amontons
