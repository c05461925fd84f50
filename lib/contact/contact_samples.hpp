// What the solver claims about one contact pair at an accepted state, point by point on this rank's slave facets. Plain
// data: the output writes it, the certificate checks it.
#pragma once

#include "friction/friction_law.hpp"
#include "geometry/rigid_shape.hpp"

#include <array>
#include <cstdint>
#include <optional>
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
  /// Where the traction acts on both sides, in finite kinematics (point_tangent.cpp: at the slave's point or at the
  /// projection); empty: on each side at its own point. With shear over a gap it matters to moments.
  std::vector<std::array<double, 3>> acts_at;
  std::vector<double> weight;        // area (per unit thickness in 2D, of the full turn when axisymmetric)
  std::vector<double> facet_size;    // h
  std::vector<double> pressure;      // -sigma_n >= 0
  std::vector<double> gap;           // g_n as the solver sees it; 1e300 where nothing is near
  std::vector<ContactStatus> status; // Slip where in frictionless contact
  bool has_friction = false;         // the same on all ranks, also on those without points
  // Empty without friction:
  std::vector<std::array<double, 3>> shear; // traction on the slave in the tangent plane
  std::vector<double> tau_c;                // the law's limit of |shear|
  std::vector<std::array<double, 3>> slip;  // of the slave over the master in this increment
  std::vector<double> accumulated_slip;
  std::vector<FrictionContext> friction_context; // what the law was asked with, besides pressure and slip
  std::vector<FrictionState> friction_state_old; // at the last accepted state
  /// State variables of the friction law, as many as it has: [variable][point], at the end of the increment; zero where
  /// open.
  std::vector<std::string> state_names;
  std::vector<std::vector<double>> states;
  /// Nodal pressure on the slave surface at the local mesh nodes `nodes` (owned vertices): multipliers, or for penalty
  /// the projected pressure.
  std::vector<std::int32_t> nodes;
  std::vector<double> nodal_pressure;
  std::size_t size() const { return facet.size(); }
  /// Traction on the slave.
  std::array<double, 3> traction(std::size_t i) const {
    std::array<double, 3> all{};
    for (std::size_t c = 0; c < 3; ++c)
      all[c] = pressure[i] * normal[i][c] + (has_friction ? shear[i][c] : 0.0);
    return all;
  }
};

/// A rigid master at a moment: the shape, where it has moved, and by how much since the last accepted state.
struct MovedShape {
  RigidShape shape;
  std::array<double, 3> shift{};
  std::array<double, 3> increment{};
};

/// One pair as the scene declares it.
struct ContactPairNames {
  std::string name;
  std::string slave;                            // surface of the mesh
  std::variant<std::string, MovedShape> master; // surface of the mesh, or a shape
  std::optional<FrictionLaw> friction = std::nullopt;
};

} // namespace amontons
