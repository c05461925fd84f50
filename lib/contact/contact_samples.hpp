// What the solver claims about one contact pair at an accepted state, point by point on this rank's slave facets. Plain
// data: the output writes it, the certificate checks it.
#pragma once

#include "geometry/rigid_shape.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace amontons {

enum class ContactStatus : std::uint8_t { Open = 0, Stick = 1, Slip = 2 };

struct ContactSamples {
  std::vector<std::int32_t> facet;           // of the slave surface's FacetSet
  std::vector<std::array<double, 2>> xi;     // on that facet
  std::vector<std::array<double, 3>> place;  // reference position X of the point
  std::vector<std::array<double, 3>> normal; // n, out of the master; the traction on the slave is pressure * n
  std::vector<double> weight;                // area (per unit thickness in 2D, of the full turn when axisymmetric)
  std::vector<double> facet_size;            // h
  std::vector<double> pressure;              // -sigma_n >= 0
  std::vector<double> gap;                   // g_n as the solver sees it; 1e300 where nothing is near
  std::vector<ContactStatus> status;         // Slip where in frictionless contact
  /// Nodal pressure on the slave surface at the local mesh nodes `nodes` (owned vertices): multipliers, or for penalty
  /// the projected pressure.
  std::vector<std::int32_t> nodes;
  std::vector<double> nodal_pressure;
  std::size_t size() const { return facet.size(); }
};

/// A rigid master at a moment: the shape and where it has moved.
struct MovedShape {
  RigidShape shape;
  std::array<double, 3> shift{};
};

/// One pair as the scene declares it.
struct ContactPairNames {
  std::string name;
  std::string slave;                            // surface of the mesh
  std::variant<std::string, MovedShape> master; // surface of the mesh, or a shape
};

} // namespace amontons
