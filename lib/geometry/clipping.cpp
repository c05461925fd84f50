#include "geometry/clipping.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

namespace {

double cross(const Point<2>& a, const Point<2>& b) { return a[0] * b[1] - a[1] * b[0]; }

/// Below this part of the square of its extent a polygon's area is rounding.
constexpr double no_area = 1e-15;

double extent(const Polygon& polygon) {
  double largest = 0.0;
  for (const auto& vertex : polygon)
    largest = std::max(largest, (vertex - polygon.front()).lpNorm<Eigen::Infinity>());
  return largest;
}

bool has_area(const Polygon& polygon) {
  const double size = polygon.empty() ? 0.0 : extent(polygon);
  return measure(polygon) > no_area * size * size;
}

} // namespace

double measure(const Interval& interval) { return std::max(0.0, interval.high - interval.low); }

double measure(const Polygon& polygon) {
  double doubled = 0.0;
  for (std::size_t i = 2; i < polygon.size(); ++i)
    doubled += cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  return 0.5 * doubled;
}

Interval overlap(const Interval& subject, const Interval& clip) {
  return {std::max(subject.low, clip.low), std::min(subject.high, clip.high)};
}

std::vector<Interval> difference(const Interval& subject, const Interval& clip) {
  if (measure(overlap(subject, clip)) <= 0.0) return {subject};
  std::vector<Interval> rest;
  if (subject.low < clip.low) rest.push_back({subject.low, clip.low});
  if (subject.high > clip.high) rest.push_back({clip.high, subject.high});
  return rest;
}

Halves cut(const Polygon& polygon, const Point<2>& a, const Point<2>& b) {
  Halves halves;
  if (polygon.empty()) return halves;
  const Point<2> along = b - a;
  Point<2> previous = polygon.back();
  double previous_side = cross(along, previous - a);
  for (const auto& vertex : polygon) {
    const double side = cross(along, vertex - a);
    if ((side > 0.0 && previous_side < 0.0) || (side < 0.0 && previous_side > 0.0)) {
      // Both halves take the same point, so that their areas add up.
      const Point<2> crossing = previous + (vertex - previous) * (previous_side / (previous_side - side));
      halves.left.push_back(crossing);
      halves.right.push_back(crossing);
    }
    if (side >= 0.0) halves.left.push_back(vertex);
    if (side <= 0.0) halves.right.push_back(vertex);
    previous = vertex;
    previous_side = side;
  }
  return halves;
}

Polygon overlap(const Polygon& subject, const Polygon& clip) {
  if (!has_area(clip)) return {};
  Polygon rest = subject;
  for (std::size_t i = 0; i < clip.size() && rest.size() > 2; ++i)
    if (const auto& next = clip[(i + 1) % clip.size()]; next != clip[i]) rest = cut(rest, clip[i], next).left;
  return has_area(rest) ? rest : Polygon{};
}

std::vector<Polygon> difference(const Polygon& subject, const Polygon& clip) {
  if (overlap(subject, clip).empty()) return {subject};
  std::vector<Polygon> parts;
  Polygon rest = subject;
  for (std::size_t i = 0; i < clip.size(); ++i) {
    const auto& next = clip[(i + 1) % clip.size()];
    if (next == clip[i]) continue;
    auto halves = cut(rest, clip[i], next);
    if (has_area(halves.right)) parts.push_back(std::move(halves.right));
    rest = std::move(halves.left);
  }
  return parts;
}

std::vector<std::array<Point<1>, 2>> simplices(const Interval& interval) {
  if (measure(interval) <= 0.0) return {};
  return {{Point<1>(interval.low), Point<1>(interval.high)}};
}

std::vector<std::array<Point<2>, 3>> simplices(const Polygon& polygon) {
  std::vector<std::array<Point<2>, 3>> triangles;
  if (polygon.size() < 3) return triangles;
  const double size = extent(polygon);
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const double doubled = cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
    if (doubled > no_area * size * size) triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
  }
  return triangles;
}

double measure(const std::array<Point<1>, 2>& interval) { return interval[1][0] - interval[0][0]; }

double measure(const std::array<Point<2>, 3>& triangle) {
  return 0.5 * cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
}

std::vector<Polygon> convex_parts(Polygon polygon) {
  if (measure(polygon) < 0.0) std::reverse(polygon.begin(), polygon.end());
  const std::size_t n = polygon.size();
  if (n != 4) return {polygon};
  for (std::size_t i = 0; i < n; ++i) {
    const Point<2>&before = polygon[(i + 3) % n], &here = polygon[i], &after = polygon[(i + 1) % n];
    if (cross(here - before, after - here) >= 0.0) continue;
    const auto& opposite = polygon[(i + 2) % n];
    return {{here, after, opposite}, {here, opposite, before}};
  }
  return {polygon};
}

} // namespace amontons
