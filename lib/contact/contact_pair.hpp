// What defines a contact pair, as plain data: surfaces, projection, integration, enforcement. Built by the application
// from the deck.
#pragma once

#include "base/expression.hpp"
#include "friction/friction_law.hpp"
#include "geometry/rigid_shape.hpp"
#include "math/space.hpp"

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace amontons {

/// A rigid master and how it moves (components of t; absent: at rest).
struct RigidMaster {
  RigidShape shape;
  std::array<std::optional<Expression>, 3> displacement;
};

/// How a slave point finds its master point.
struct ClosestPoint {};
struct SlaveNormal {};
using ProjectionKind = std::variant<ClosestPoint, SlaveNormal>;

/// What a slave point is projected onto: the facets of the mesh, or cubic ones through their nodes that have a
/// continuous tangent plane (smooth_master.hpp), but for creases where neighbours meet at `crease_angle` (degrees) or
/// more.
struct FacetedMaster {};
struct CubicMaster {
  double crease_angle = 40.0;
};
using MasterSmoothing = std::variant<FacetedMaster, CubicMaster>;

/// How the slave surface is integrated over: by a rule on each slave facet, or on the pieces of slave facets that
/// single master facets cover. `degree`: of polynomials that are integrated exactly on a facet or piece.
struct FacetIntegration {
  int degree = 4;
};
struct SegmentIntegration {
  int degree = 4;
};
using Integration = std::variant<FacetIntegration, SegmentIntegration>;

/// Where gap, normal, slip and area are taken: in the reference configuration, with projections that are found once,
/// or in the current one, anew for every iterate.
struct SmallKinematics {};
struct FiniteKinematics {};
using ContactKinematics = std::variant<SmallKinematics, FiniteKinematics>;

/// Where λ comes from: nowhere, an outer loop, an unknown of the system (extra field number `field` of the layout), the
/// force on a bound of the normal motion, or the out-of-balance force on a node's relative motion (semismooth with the
/// dual basis).
struct Penalty {};
struct Uzawa {};
struct Semismooth {
  int field;
};
struct BoundConstraint {};
struct CondensedSemismooth {};
using Enforcement = std::variant<Penalty, Uzawa, Semismooth, BoundConstraint, CondensedSemismooth>;

/// Friction of a pair. Unknown tangential multipliers (`semismooth`) are the dim extra fields from `field` on.
struct Friction {
  FrictionLaw law;
  std::optional<Expression> factor; // of the friction coefficient, in place and time
  int field = -1;
};

struct ContactPair {
  std::string name;
  std::string slave; // surface group of the mesh
  std::variant<std::string, RigidMaster> master;
  Enforcement enforcement;
  ProjectionKind projection;
  MasterSmoothing smoothing = FacetedMaster{};  // of a meshed master that is not the slave itself, order 1
  Integration integration = FacetIntegration{}; // segment: with a meshed master and small kinematics only
  /// Small: gap, normal, slip and area of the reference configuration, with projections that are found once. Finite:
  /// those of the current one, anew for every iterate.
  Kinematics kinematics = Kinematics::Small;
  double alpha = 1.0;           // dimensionless augmentation: ε = alpha · stiffness / h
  double search_distance = 0.0; // farther master facets are not looked at
  Space space = Space::Solid;
  /// A body of this pair is held by contact alone, and touches nothing at the start: then contact is guessed where the
  /// surfaces are nearest, however far that is.
  bool holds_floating_body = false;
  std::vector<double> stiffness; // Young's modulus per body of the mesh
  std::optional<Friction> friction = std::nullopt;

  /// Slave and master are the same surface: see own_body.hpp.
  bool meets_itself() const {
    const auto* surface = std::get_if<std::string>(&master);
    return surface && *surface == slave;
  }
};

} // namespace amontons
