// The four kinds of problem by dimension: what a 2D coordinate pair means and which strain components exist.
#pragma once

#include <numbers>

namespace amontons {

/// Plane spaces: x, y with unit thickness. Axisymmetric: x radial, y axial, forces over the whole circumference.
enum class Space { PlaneStrain, PlaneStress, Axisymmetric, Solid };

/// Small: linear strains, all integrals in the reference configuration. Finite: the equations of the deformed body.
enum class Kinematics { Small, Finite };

constexpr int space_dim(Space space) { return space == Space::Solid ? 3 : 2; }

/// Measure of what a point of the mesh stands for: 2 π r in axisymmetric space, else 1 (thickness or nothing).
constexpr double circumference(Space space, double x) {
  return space == Space::Axisymmetric ? 2 * std::numbers::pi * x : 1.0;
}

} // namespace amontons
