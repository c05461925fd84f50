// Cutting intervals and convex polygons by each other: the overlaps over which two surfaces are integrated against one
// another. Signs decide and nothing else, so that what one side of a cut loses the other side gains: coincident,
// touching and sliver-thin overlaps come out with an area that is right to rounding, with vertices that may coincide.
// Pure functions of numbers.
#pragma once

#include "math/tensor.hpp"

#include <array>
#include <vector>

namespace amontons {

/// Part of a line; empty when low >= high.
struct Interval {
  double low = 0.0, high = 0.0;
};

/// Convex polygon in a plane, counter-clockwise, vertices may coincide; empty with fewer than three.
using Polygon = std::vector<Point<2>>;

/// Length or area; zero when empty. Of a polygon that runs clockwise, the area is negative.
double measure(const Interval& interval);
double measure(const Polygon& polygon);

/// The part that both have in common. A `clip` of no measure has nothing in common with anything.
Interval overlap(const Interval& subject, const Interval& clip);
/// I. E. Sutherland, G. W. Hodgman, Reentrant polygon clipping, Comm. ACM 17 (1974) 32-42.
Polygon overlap(const Polygon& subject, const Polygon& clip);

/// The rest of the subject in convex parts, which meet only in their borders and not the overlap. Parts of no measure
/// are left out.
std::vector<Interval> difference(const Interval& subject, const Interval& clip);
std::vector<Polygon> difference(const Polygon& subject, const Polygon& clip);

/// A polygon cut in two by the line from a to b: the parts on its left and on its right.
struct Halves {
  Polygon left, right;
};
Halves cut(const Polygon& polygon, const Point<2>& a, const Point<2>& b);

/// Ends of the interval; corners of triangles that make up the polygon (those of no area left out).
std::vector<std::array<Point<1>, 2>> simplices(const Interval& interval);
std::vector<std::array<Point<2>, 3>> simplices(const Polygon& polygon);

double measure(const std::array<Point<1>, 2>& interval);
double measure(const std::array<Point<2>, 3>& triangle);

/// Convex polygons that make up a quadrilateral or triangle without crossing edges, in any orientation: itself, or two
/// triangles when one of its corners is re-entrant.
std::vector<Polygon> convex_parts(Polygon polygon);

} // namespace amontons
