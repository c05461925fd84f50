// Cutting intervals and convex polygons: what is cut off and what is left add up, whatever lies on what.
#include "geometry/clipping.hpp"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <random>

using namespace amontons;

namespace {

using Random = std::mt19937;

Point<2> random_place(Random& random) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  return {number(random), number(random)};
}

/// A triangle or quadrilateral inscribed in an ellipse, so convex; one in four is a sliver.
Polygon random_polygon(Random& random) {
  std::uniform_real_distribution<double> number(0.0, 1.0);
  std::array<double, 4> turns;
  const std::size_t n = random() % 2 == 0 ? 3 : 4;
  for (std::size_t i = 0; i < n; ++i)
    turns[i] = 2.0 * M_PI * number(random);
  std::sort(turns.begin(), turns.begin() + n);
  const double thin = random() % 4 == 0 ? std::pow(10.0, -14.0 * number(random)) : 0.3 + number(random);
  const double tilt = 2.0 * M_PI * number(random), cosine = std::cos(tilt), sine = std::sin(tilt);
  const Point<2> centre = 0.5 * random_place(random);
  Polygon polygon;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = std::cos(turns[i]), y = thin * std::sin(turns[i]);
    polygon.push_back(centre + Point<2>(cosine * x - sine * y, sine * x + cosine * y));
  }
  return polygon;
}

/// A second polygon that has something awkward to do with the first.
Polygon awkward_partner(const Polygon& first, Random& random) {
  switch (random() % 8) {
  case 0: { // the same, begun at another corner
    Polygon same = first;
    std::rotate(same.begin(), same.begin() + 1, same.end());
    return same;
  }
  case 1: { // shares an edge, on its other side
    const Point<2> outwards(first[1][1] - first[0][1], first[0][0] - first[1][0]);
    return {first[1], first[0], first[0] + outwards, first[1] + outwards};
  }
  case 2: { // has a corner in one of the first's, and an edge along one
    const Point<2> along = first[1] - first[0];
    const Point<2> inwards(-along[1], along[0]);
    return {first[0], first[0] + 0.6 * along, first[0] + inwards};
  }
  case 3: { // as the first, moved by rounding
    Polygon moved = first;
    for (auto& vertex : moved)
      vertex += 1e-15 * random_place(random);
    return moved;
  }
  case 4: // no area
    return {first[0], first[1], 0.5 * (first[0] + first[1])};
  case 5: // a point, three times
    return {first[0], first[0], first[0]};
  default:
    return random_polygon(random);
  }
}

double area_of_all(const std::vector<Polygon>& polygons) {
  double sum = 0.0;
  for (const auto& polygon : polygons)
    sum += measure(polygon);
  return sum;
}

double shortest_edge(const Polygon& polygon) {
  double shortest = 1e300;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    shortest = std::min(shortest, (polygon[(i + 1) % polygon.size()] - polygon[i]).norm());
  return shortest;
}

bool is_convex(const Polygon& polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Point<2> before = polygon[(i + 1) % n] - polygon[i], after = polygon[(i + 2) % n] - polygon[(i + 1) % n];
    if (before[0] * after[1] - before[1] * after[0] < -1e-14) return false;
  }
  return true;
}

} // namespace

TEST_CASE("a million pairs of polygons: overlap and rest add up, and the overlap is that of the exchanged pair") {
  Random random(4);
  double worst_sum = 0.0, worst_exchange = 0.0, worst_triangles = 0.0, largest = 0.0;
  int overlapping = 0, bent = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const auto first = random_polygon(random), second = awkward_partner(first, random);
    const auto common = overlap(first, second);
    const double area = measure(common);
    if (area > 0.0) ++overlapping;
    const auto rest = difference(first, second);
    worst_sum = std::max(worst_sum, std::abs(area + area_of_all(rest) - measure(first)));
    // The line of a short edge is known to rounding over its length only, so which of the two polygons cuts matters.
    const double exchange = std::abs(area - measure(overlap(second, first)));
    const double rounding = 1e-15 / std::min({1.0, shortest_edge(first), shortest_edge(second)});
    if (measure(second) > 0.0) worst_exchange = std::max(worst_exchange, exchange / (2e-14 + rounding));
    double triangles = 0.0;
    for (const auto& triangle : simplices(common))
      triangles += measure(triangle);
    worst_triangles = std::max(worst_triangles, std::abs(triangles - area));
    largest = std::max(largest, area);
    if (i % 16 != 0) continue;
    if (!is_convex(common)) ++bent;
    for (const auto& part : rest)
      if (!is_convex(part)) ++bent;
  }
  CHECK(overlapping > 300'000);
  CHECK(largest > 1.0);
  CHECK(bent == 0);
  CHECK(worst_sum < 2e-14);
  CHECK(worst_exchange < 1.0);
  CHECK(worst_triangles < 2e-14);
}

TEST_CASE("a polygon is shared out completely between the cells of a partition of the plane") {
  Random random(5);
  constexpr int n = 5;
  for (int trial = 0; trial < 3000; ++trial) {
    Point<2> grid[n + 1][n + 1];
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j)
        grid[i][j] = Point<2>(i, j) * (4.0 / n) - Point<2>(2.0, 2.0) + 0.15 * random_place(random);
    const auto polygon = random_polygon(random);
    double sum = 0.0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const Polygon cell = {grid[i][j], grid[i + 1][j], grid[i + 1][j + 1], grid[i][j + 1]};
        if (trial % 2 == 0) {
          sum += measure(overlap(polygon, cell));
          continue;
        }
        sum += measure(overlap(polygon, {cell[0], cell[1], cell[2]}));
        sum += measure(overlap(polygon, {cell[0], cell[2], cell[3]}));
      }
    CHECK(std::abs(sum - measure(polygon)) < 1e-14);
  }
}

TEST_CASE("areas of overlaps that can be told by hand") {
  const Polygon square = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const auto moved = [&](double x, double y) {
    Polygon copy = square;
    for (auto& vertex : copy)
      vertex += Point<2>(x, y);
    return copy;
  };
  CHECK(measure(overlap(square, moved(0.25, 0.5))) == doctest::Approx(0.375));
  CHECK(overlap(square, moved(1.0, 0.0)).empty()); // touch along an edge
  CHECK(overlap(square, moved(1.0, 1.0)).empty()); // in a corner
  CHECK(overlap(square, moved(3.0, 0.0)).empty());
  CHECK(measure(overlap(square, moved(1.0 - 1e-9, 0.0))) == doctest::Approx(1e-9).epsilon(1e-6));
  // A diamond through the middles of the square's edges, and one whose corners stick out of them.
  CHECK(measure(overlap(square, {{0.5, 0}, {1, 0.5}, {0.5, 1}, {0, 0.5}})) == doctest::Approx(0.5));
  const Polygon octagon = overlap(square, {{0.5, -0.25}, {1.25, 0.5}, {0.5, 1.25}, {-0.25, 0.5}});
  CHECK(octagon.size() == 8);
  CHECK(measure(octagon) == doctest::Approx(1.0 - 4.0 * 0.5 * 0.25 * 0.25));
  CHECK(area_of_all(difference(square, moved(0.25, 0.25))) == doctest::Approx(1.0 - 0.5625));
  CHECK(difference(square, square).empty());
  CHECK(difference(square, moved(2.0, 0.0)).size() == 1);
}

TEST_CASE("a quadrilateral with a re-entrant corner becomes two triangles, in whichever direction it runs") {
  Polygon arrow = {{0, 0}, {2, 1}, {0, 2}, {0.5, 1}};
  for (const bool reversed : {false, true}) {
    if (reversed) std::reverse(arrow.begin(), arrow.end());
    for (int turn = 0; turn < 4; ++turn) {
      std::rotate(arrow.begin(), arrow.begin() + 1, arrow.end());
      const auto parts = convex_parts(arrow);
      REQUIRE(parts.size() == 2);
      CHECK(measure(parts[0]) > 0.0);
      CHECK(measure(parts[1]) > 0.0);
      CHECK(area_of_all(parts) == doctest::Approx(1.5));
    }
  }
  const auto whole = convex_parts({{0, 1}, {1, 1}, {1, 0}, {0, 0}}); // clockwise
  REQUIRE(whole.size() == 1);
  CHECK(measure(whole[0]) == doctest::Approx(1.0));
}

TEST_CASE("intervals: overlap and rest") {
  CHECK(measure(overlap(Interval{0, 2}, Interval{1, 3})) == 1.0);
  CHECK(measure(overlap(Interval{0, 1}, Interval{1, 3})) == 0.0);
  CHECK(measure(overlap(Interval{0, 1}, Interval{2, 3})) == 0.0);
  CHECK(difference({0, 3}, {1, 2}).size() == 2);
  CHECK(difference({1, 2}, {0, 3}).empty());
  CHECK(difference({0, 1}, {2, 3}).size() == 1);
  Random random(6);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (int i = 0; i < 10000; ++i) {
    const auto [a, b] = std::minmax({number(random), number(random)});
    const auto [c, d] = std::minmax({number(random), number(random)});
    double sum = measure(overlap(Interval{a, b}, Interval{c, d}));
    CHECK(sum == measure(overlap(Interval{c, d}, Interval{a, b})));
    for (const auto& rest : difference({a, b}, {c, d}))
      sum += measure(rest);
    CHECK(std::abs(sum - (b - a)) < 1e-15);
  }
}
