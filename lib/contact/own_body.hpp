// A surface that may meet itself: how a point of it tells its partners from its own body. Rules for one candidate, from
// the reference configuration and the current place alone, so that they do not depend on the history of iterations.
//
// Facets that share a node with the point's own facet are no partners. Neither is the other side of a wall, which faces
// the point and lies behind it just as a partner does that has been penetrated. Two things tell them apart:
//  - no contact is deeper than the own wall is thick, or the point would stand behind its own back. That also keeps
//  away
//    the layers beyond the wall of a body folded several times;
//  - the straight way to the other side of a wall leads through the material, and is about as long as it was in the
//    reference configuration. A true partner that was also behind the point there was much farther than the
//    penetration, else it could not have come round. So a candidate of the same body that was behind the point is a
//    partner while the depth is below a quarter of that way: a body squeezed to less than a quarter of its thickness
//    would be taken for folded.
//
// Every contact is found from both of its sides. Each side counts with half of its area, so that
//   ½ ∫_A σ_A δg_A + ½ ∫_B σ_B δg_B
// is the work of one contact: each law is asked at full traction, action equals reaction in both halves, and no side is
// preferred. With penalty that adds no constraint. Held multipliers (uzawa) of both sides share the load: the gap
// conditions of both are inequalities that any open state fulfils, so they never contradict each other. Unknown
// multipliers (semismooth) are refused: in the middle of a contact only the sum of both sides' is determined, and the
// matrix is singular. (Two-half-pass: R. A. Sauer, L. De Lorenzis, Comput. Methods Appl. Mech. Engrg. 253 (2013)
// 369-392, there with the traction of each pass on its own side only.)
#pragma once

#include "contact/master_surface.hpp"
#include "geometry/projection.hpp"

#include <cstdint>
#include <span>

namespace amontons {

/// Part of the area that each side of a contact of a surface with itself counts with.
constexpr double half_pass = 0.5;

/// A point of a surface that may meet itself.
struct OwnBody {
  std::int32_t facet;                   // of the MasterSurface: where the point lies
  std::span<const double> place;        // of the point in the reference configuration, dim coordinates
  std::span<const double> normal;       // outward normal there
  double thickness;                     // of the body behind the point there, or no_thickness
  std::span<const std::int32_t> welded; // see mesh/welded_bodies.hpp
};
/// More than the search looks at.
constexpr double no_thickness = 1e300;

/// May the point touch the candidate, a facet that shares no node with its own, and above whose projection it is by
/// this height (negative: behind)?
bool is_partner(const MasterSurface& surface, const OwnBody& own, std::int32_t candidate, const Projection& projection,
                double height);

/// How thick the body is behind a place of its surface: the way along the inward normal to where it leaves the body
/// through one of the facets of `exterior`, in their reference positions; no_thickness where that is farther than
/// `reach`. `scratch` is for its own use.
double thickness_behind(const MasterSurface& exterior, std::span<const double> place, std::span<const double> normal,
                        double reach, std::vector<std::int32_t>& scratch);

} // namespace amontons
