// What a deck says, as plain data. Declared (keys, types, units, ranges, sentences) in deck.cpp with the vocabulary of
// lib/deck; everything downstream reads these structs and never YAML.
#pragma once

#include "base/expression.hpp"
#include "deck/located.hpp"
#include "friction/friction_law.hpp"
#include "geometry/rounded_box.hpp"
#include "material/bulk_material.hpp"
#include "math/space.hpp"

#include <array>
#include <map>
#include <mpi.h>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace amontons {

struct MeshDeck {
  Located<std::string> file; // relative to the deck's folder
  std::map<std::string, double> parameters;
  std::optional<int> order;
  int refine = 0;
};

struct MaterialDeck {
  BulkMaterial law;
  double density = 0.0; // rho: for body_force expressions, and for the audit of effects
  // For the audit of effects only:
  std::optional<double> yield_stress;
  std::optional<double> heat_capacity; // per mass
};

/// Components that are absent are free (displacement) or zero (forces).
using VectorDeck = std::array<std::optional<Expression>, 3>;

struct BoundaryDeck {
  Located<std::string> on; // physical group
  VectorDeck displacement;
  VectorDeck traction;                // force per reference area
  std::optional<Expression> pressure; // positive pushes into the body
  VectorDeck resultant;               // total force on the group, which moves as one in that direction
};

/// Rigid master shapes; `displacement` moves the shape. Normals point out of the rigid body, towards the deformable
/// one.
struct PlaneDeck {
  std::vector<double> point, normal;
  VectorDeck displacement;
};
/// A ball; with `inside: true` a cavity. In plane and axisymmetric space a circle (centre on the axis there).
struct SphereDeck {
  std::vector<double> centre;
  double radius = 0.0;
  VectorDeck displacement;
};
/// Infinite cylinder; in 2D (no axis) a circle like the sphere.
struct CylinderDeck {
  std::vector<double> centre, axis;
  double radius = 0.0;
  VectorDeck displacement;
};
/// A convex edge between two planes, rounded.
struct CornerDeck {
  std::vector<double> point; // of the edge before it is rounded
  std::vector<std::vector<double>> normals;
  double radius = 0.0;
  VectorDeck displacement;
};
/// A flat face that ends in a rounded edge along a rectangle with rounded corners; 3D only.
struct RoundedBoxDeck {
  BoxPart part = BoxPart::Punch;
  std::vector<double> point;  // middle of the rectangle
  std::vector<double> normal; // of the face
  std::vector<double> side;   // across a pair of walls
  std::vector<double> half_widths;
  double corner_radius = 0.0;
  double edge_radius = 0.0;
  VectorDeck displacement;
};
using MasterDeck = std::variant<Located<std::string>, PlaneDeck, SphereDeck, CylinderDeck, CornerDeck, RoundedBoxDeck>;

struct PenaltyDeck {
  double alpha = 30.0;
};
struct UzawaDeck {
  double alpha = 1.0;
  double tolerance = 1e-8; // relative change of the multipliers at which the outer loop stops
  int max_iterations = 100;
};
/// Of the multipliers: unknown nodal values of the slave's corner functions, or of functions dual to the displacements'
/// and eliminated node by node.
enum class MultiplierBasis { Nodal, Dual };
struct SemismoothDeck {
  double alpha = 1.0;
  MultiplierBasis basis = MultiplierBasis::Nodal;
};
struct ViDeck {};
using EnforceDeck = std::variant<SemismoothDeck, UzawaDeck, PenaltyDeck, ViDeck>;

/// Semismooth with the dual basis: no multiplier is an unknown.
bool is_condensed(const EnforceDeck& enforce);

struct ClosestPointDeck {};
struct SlaveNormalDeck {};
struct FacetedMasterDeck {};
struct CubicMasterDeck {
  double crease_angle = 40.0; // degrees
};
struct FacetIntegrationDeck {
  int order = 4; // polynomial degree integrated exactly on a slave facet
};
struct SegmentIntegrationDeck {
  int order = 4; // polynomial degree integrated exactly on each piece of a slave facet
};

/// Which surfaces meet: a slave and a master, one surface with itself, or all surfaces with each other and themselves.
enum class ContactSides { SlaveAndMaster, Itself, All };

struct ContactDeck {
  Located<std::string> name;
  ContactSides sides = ContactSides::SlaveAndMaster;
  Located<std::string> slave; // otherwise the surface that meets itself; it is the master, too
  Located<MasterDeck> master;
  EnforceDeck enforce;
  std::variant<ClosestPointDeck, SlaveNormalDeck> projection;
  std::variant<FacetedMasterDeck, CubicMasterDeck> smoothing;
  std::variant<FacetIntegrationDeck, SegmentIntegrationDeck> integration;
  std::optional<double> search_distance; // absent: a tenth of the diagonal of the smaller surface's box
  std::optional<FrictionLaw> friction;   // absent: frictionless
  std::optional<Expression> friction_factor;
};

struct AutoIncrements {
  double first = 0.1;     // fraction of the step
  double smallest = 1e-4; // fraction of the step below which the run gives up
  double largest = 1.0;
  int target_iterations = 8;            // Newton iterations at which the increment is kept; fewer: grow, more: shrink
  std::optional<double> path_tolerance; // of the path error of the whole step; absent: not measured
};
using IncrementsDeck = std::variant<int, AutoIncrements>;

struct StepDeck {
  Located<std::string> name;
  double to = 0.0;
  IncrementsDeck increments = 1;
};

/// A figure whose error is asked for: the mean of a displacement component over the nodes of a group.
struct FigureDeck {
  Located<std::string> of; // physical group
  int component = 0;
};

/// What adaptive meshing makes accurate: figures of the end of the run.
enum class AdaptQuantity { PeakPressure, Force, Energy, EnergyNorm };

struct AdaptDeck {
  double target_error = 0.01; // relative
  AdaptQuantity quantity = AdaptQuantity::PeakPressure;
  std::optional<std::string> pair; // of peak_pressure and force; absent: the deck's only one
  double max_unknowns = 200e3;     // displacement and multiplier unknowns of a pass
  int max_passes = 10;
};

/// Artificial viscosity (form/viscous.hpp).
struct ViscousDeck {
  double ratio = 1e-4;
};
using StabilizationDeck = std::variant<ViscousDeck>;

/// Tolerances of the certificate (DESIGN: may be changed, never switched off).
struct CertificateDeck {
  double penetration = 0.05;     // largest penetration / local facet size
  double tension = 1e-2;         // largest tensile contact traction / largest pressure
  double complementarity = 1e-2; // sum |pressure| |gap| / (total force x facet size)
  double balance = 1e-6;         // force and moment out of balance / force scale
  double energy = 1e-6;          // violation of the energy bounds / external work
  double friction = 1e-6;        // shear off the law's limit / largest limit; negative part of the frictional work
  double slip = 0.1;             // motion that is not the slip claimed / largest motion in the scene
  double volume_ratio = 0.0;     // smallest det F allowed
  double artificial = 0.05;      // work of stabilization / external work
};

struct OutputDeck {
  std::string directory; // default: results/<deck name>
  int every = 1;
  std::vector<Located<std::string>> fields = {std::string("displacement"), std::string("stress"),
                                              std::string("contact")};
};

struct Deck {
  std::string path;   // of the YAML file
  std::string folder; // that it is in
  std::string title;
  std::map<std::string, double> constants;
  MeshDeck mesh;
  Space space = Space::Solid;
  Kinematics kinematics = Kinematics::Small;
  std::map<std::string, Located<MaterialDeck>> materials;
  std::map<std::string, Located<std::string>> bodies; // body group -> material name
  std::vector<BoundaryDeck> boundary;
  std::map<std::string, Located<VectorDeck>> body_force;
  std::vector<ContactDeck> contact;
  std::vector<StepDeck> steps;
  std::optional<StabilizationDeck> stabilization; // absent: none
  bool estimate_path_error = false;
  bool look_for_other_solutions = false;
  std::map<std::string, FigureDeck> figures; // by name
  std::optional<AdaptDeck> adapt;
  CertificateDeck certificate;
  OutputDeck output;
  std::map<std::string, std::string> petsc; // option name without dash -> value

  /// 2 or 3.
  int dim() const { return space_dim(space); }
};

/// Does the pair's surface meet itself?
inline bool meets_itself(const ContactDeck& contact) { return contact.sides != ContactSides::SlaveAndMaster; }

/// Does any increment of the run need the comparison with its halves?
bool measures_path(const Deck& deck);

struct Shape;

/// Which formulation of contact to choose and why.
const std::string& enforce_advice();

/// What a deck may say: for the schema and the manual pages.
const Shape& deck_shape();

/// The deck in `text`, checked in itself; `path` is where it came from. Throws UserError with every fault, each as
/// "file:line:column: ...". With `look_for_mesh`, a mesh file that does not exist is a fault too.
Deck parse_deck(const std::string& text, const std::string& path, bool look_for_mesh);

/// Reads the file and parses it. Serial.
Deck read_deck(const std::string& path);

/// The same on all ranks; only rank 0 touches the file. Collective.
Deck read_deck(MPI_Comm comm, const std::string& path);

} // namespace amontons
