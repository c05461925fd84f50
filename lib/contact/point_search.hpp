// Where a slave point meets the master: the closest facing point, or the one along the slave's normal. Positions are
// those in which the MasterSurface stands.
#pragma once

#include "contact/own_body.hpp"
#include "geometry/contact_kinematics.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace amontons {

/// A slave point that looks for its master.
struct SearchPoint {
  std::span<const double> place;  // dim coordinates
  std::span<const double> normal; // outward normal of the slave there, dim components
  double size;                    // of the slave facet
  std::int32_t guess;             // master facet that is likely to be the nearest, or negative
  const OwnBody* own = nullptr;   // where the master is the surface that the point is on, else null
};

/// What it finds.
struct MasterPlace {
  std::int32_t facet = -1; // none within the search distance, or only the rim of the master
  std::array<double, 2> xi{};
  std::array<double, 3> normal{}; // n: place − ρ(ξ) = gap · n
  double gap = 1e300;
  ProjectionHold hold = OnFacet{};
};

/// The closest facing master point. n is the facet's normal inside a facet; on an edge or vertex that the surface
/// continues across, the direction from the projection to the point (or away from it, for a penetrating point).
/// `scratch` is for the search's own use.
MasterPlace find_closest(const MasterSurface& master, const SearchPoint& point, double search_distance,
                         std::vector<std::int32_t>& scratch);

/// Along the slave's normal: n = −n_slave.
MasterPlace find_along_normal(const MasterSurface& master, const SearchPoint& point, double search_distance,
                              std::vector<std::int32_t>& scratch);

/// Do facets with these outward normals face each other?
bool is_facing(std::span<const double> slave_normal, std::span<const double> master_normal);

} // namespace amontons
