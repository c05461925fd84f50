// A punch or a die for boxes: a flat face that ends in a rounded edge along a rectangle with rounded corners. Signed
// distance, normal and the normal's derivative in closed form.
#pragma once

#include <array>

namespace amontons {

/// Which side of the rectangle is solid: the inside (a punch), or the outside (a die with an opening).
enum class BoxPart { Punch, Die };

/// The walls are parallel to `normal` and without end. Unit vectors, `side` orthogonal to `normal`.
/// corner_radius <= both half widths, and for a punch edge_radius <= corner_radius: else the distances are not those of
/// the body. Lengths in the unit of the mesh.
struct RigidRoundedBox {
  BoxPart part = BoxPart::Punch;
  std::array<double, 3> point{};      // in the flat face, the middle of the rectangle
  std::array<double, 3> normal{};     // of the flat face, out of the rigid body
  std::array<double, 3> side{};       // across a pair of walls
  std::array<double, 2> half_width{}; // along `side` and across it
  double corner_radius = 0.0;         // of the rectangle
  double edge_radius = 0.0;           // between wall and flat face
};

struct RoundedBoxPlace {
  double gap;                                           // signed distance, positive outside the rigid body
  std::array<double, 3> normal;                         // ∂gap/∂x, unit
  std::array<std::array<double, 3>, 3> normal_gradient; // ∂normal/∂x, symmetric
};

/// At the place r relative to `point`.
///
/// Let d be the signed distance from the rectangle in its plane (negative inside, g its gradient), s = 1 for a punch
/// and -1 for a die, h the height over the flat face. The body is s d < 0, h < 0 with an edge rounded by e, and as s d
/// is a distance itself, |g| = 1, so is that of the section:
///   gap = |(a, b)| - e on the rounding, a = s d + e > 0 and b = h + e > 0; elsewhere the larger of s d and h.
///   ∂normal/∂x = (g ⊗ g + n ⊗ n − N ⊗ N + a s ∂g/∂x) / |(a, b)| on the rounding, s ∂g/∂x on the walls.
/// Inside the rectangle of the corners' centres d has a crease where the nearest wall changes; one of its gradients is
/// taken there. That is at least corner_radius from the walls. ∂g/∂x jumps where a corner meets a wall: there it is the
/// corner's.
RoundedBoxPlace place_at(const RigidRoundedBox& box, const std::array<double, 3>& r);

} // namespace amontons
