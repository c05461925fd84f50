// The gap between points of a slave surface and a whole master surface, from a search of its own. For lib/accuracy
// only.
#pragma once

#include "accuracy/facet_cloud.hpp"
#include "contact/contact_samples.hpp"

#include <array>
#include <span>
#include <variant>
#include <vector>

namespace amontons::accuracy {

// All of it starts from a configuration, given by its displacement `start` (num_local x dim; empty: the reference
// configuration), and a displacement from there. Small kinematics starts from the reference and takes the gap after the
// displacement; finite kinematics starts from the current configuration, where the gap is that of zero displacement,
// and for slips from the last accepted one.

/// A point of the slave surface: place and outward normal at the start, displacement from there, size of its facet.
struct SlavePoint {
  std::array<double, 3> place{};
  std::array<double, 3> displacement{};
  std::array<double, 3> normal{};
  double size = 0.0;
  std::int32_t body = -1;
  std::array<double, 3> origin{}, origin_normal{}; // place and outward normal in the reference configuration
};

/// What a slave surface may find: another surface, or itself. Facets of itself (of the same body, or one welded to it,
/// by mesh/welded_bodies.hpp) that are behind the point, that were behind it in the reference configuration, and to
/// which the way has not become shorter by more than three quarters, are the other side of its own wall. That wall is
/// no partner, nor is what lies behind it.
struct OtherSurface {};
struct SameSurface {
  std::span<const std::int32_t> welded;
};
using Opposite = std::variant<OtherSurface, SameSurface>;
/// Of a pair with a meshed master. `welded` outlives it.
Opposite opposite_of(const ContactPairNames& pair, std::span<const std::int32_t> welded);

/// What a slave point finds on the master. The gap is that of small kinematics,
///   g = n · (X_s − ρ(ξ)) + n · (u_s − u_m(ξ)),
/// with ρ(ξ) the point of the master closest to X_s and n the normal there: the facet's inside a facet; on an edge or
/// vertex where facets meet the direction of X_s − ρ, when it lies between their normals.
struct MasterHit {
  bool found = false;     // false: no master facet that faces the point is near enough to be reached
  double gap = 0.0;       // beyond the rim of the master: of the surface continued straight on
  double beyond = 0.0;    // distance beyond the rim; zero over the surface. Points beyond the rim do not penetrate.
  std::int32_t body = -1; // of the master facet
  std::array<double, 3> jump{}; // u_s − u_m(ξ)
  std::array<double, 3> away{}; // X_s − ρ(ξ)
};

/// Point ξ of a facet of the slave surface with this displacement (num_local x dim).
SlavePoint slave_point(const Mesh& mesh, std::span<const double> displacement, const FacetSet& slave, std::int32_t f,
                       std::span<const double> xi, std::span<const double> start = {});

/// How far apart two points may be at the start and still meet: the largest difference between
/// displacements of the two surfaces, and a facet. Collective.
double reach_of(const Mesh& mesh, std::span<const double> displacement, const FacetSet& master,
                std::span<const SlavePoint> points, std::span<const double> start = {});

/// Searches the master for every point of this rank. A master facet farther than `reach` is not looked at. Collective.
std::vector<MasterHit> find_on_master(const Mesh& mesh, std::span<const double> displacement, const FacetSet& master,
                                      std::span<const SlavePoint> points, double reach,
                                      std::span<const double> start = {}, const Opposite& opposite = OtherSurface{});

/// Distance of r from the cone of the combinations Σ a_i n_i, a_i >= 0, of unit vectors.
double distance_to_cone(const std::array<double, 3>& r, std::span<const std::array<double, 3>> normals);

} // namespace amontons::accuracy
