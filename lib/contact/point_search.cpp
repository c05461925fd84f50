#include "contact/point_search.hpp"

#include "geometry/projection.hpp"
#include "math/reference_element.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

namespace {

/// Slave and master must face each other: cosine of the angle between outward normals below this.
constexpr double facing_cosine = -0.1;
/// A projection onto the rim of the master counts when the point stands over it within this part of a facet.
constexpr double rim_tolerance = 1e-6;

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    sum += a[i] * b[i];
  return sum;
}

/// Of x above the facet at its projection.
double height_over(const Projection& projection, std::span<const double> x) {
  double height = 0.0;
  for (std::size_t c = 0; c < x.size(); ++c)
    height += (x[c] - projection.point[c]) * projection.normal[c];
  return height;
}

/// Corners of the facet between which ξ lies: one for a vertex, two for an edge.
std::vector<std::int32_t> corners_at(ElementType type, Feature feature, std::span<const double> xi) {
  if (element_dim(type) == 1) return {xi[0] < 0.0 ? 0 : 1};
  const auto reference = reference_nodes(type);
  const int corners = num_vertices(type);
  std::vector<std::pair<double, std::int32_t>> near;
  for (int v = 0; v < corners; ++v)
    near.emplace_back(std::hypot(reference[2 * v] - xi[0], reference[2 * v + 1] - xi[1]), v);
  if (feature == Feature::Vertex) return {std::min_element(near.begin(), near.end())->second};
  // The edge whose two corners see ξ in between: smallest detour.
  std::int32_t best = 0;
  double smallest = 1e300;
  for (int v = 0; v < corners; ++v) {
    const int w = (v + 1) % corners;
    const double length = std::hypot(reference[2 * v] - reference[2 * w], reference[2 * v + 1] - reference[2 * w + 1]);
    const double detour = near[v].first + near[w].first - length;
    if (detour < smallest) {
      smallest = detour;
      best = v;
    }
  }
  return {best, (best + 1) % corners};
}

ProjectionHold hold_at(ElementType type, std::span<const std::int32_t> corners) {
  if (corners.size() == 1) return OnCorner{};
  const auto reference = reference_nodes(type);
  const std::size_t v = 2 * std::size_t(corners[0]), w = 2 * std::size_t(corners[1]);
  return OnEdge{{reference[w] - reference[v], reference[w + 1] - reference[v + 1]}};
}

/// The closest projection on facing facets, and its facet.
struct Nearest {
  Projection projection;
  std::int32_t facet = -1;
};

Nearest nearest_facing(const MasterSurface& master, const SearchPoint& point, double search_distance,
                       std::vector<std::int32_t>& scratch) {
  double best = search_distance;
  Nearest nearest;
  const auto consider = [&](std::int32_t candidate, double radius) {
    if (point.own && master.share_a_node(point.own->facet, candidate)) return;
    const auto projection = master.closest_point(candidate, point.place);
    if (!projection.found || projection.distance > std::min(best, radius)) return;
    if (!is_facing(point.normal, projection.normal)) return;
    if (point.own && !is_partner(master, *point.own, candidate, projection, height_over(projection, point.place)))
      return;
    const bool tie = nearest.facet >= 0 && projection.distance > best * (1.0 - 1e-12);
    if (tie && projection.feature != Feature::Facet) return;
    best = projection.distance;
    nearest = {projection, candidate};
  };
  if (point.guess >= 0) consider(point.guess, best);
  // Nothing farther than the guess can be nearest. Without one: a box that doubles until something is found in it.
  double radius = std::min(nearest.facet < 0 ? point.size : best, search_distance);
  for (;; radius = std::min(2.0 * radius, search_distance)) {
    Box box;
    box.include(point.place);
    box.inflate(radius);
    master.tree().query(box, scratch);
    for (const auto candidate : scratch)
      if (candidate != point.guess) consider(candidate, radius);
    if (nearest.facet >= 0 || radius >= search_distance) return nearest;
  }
}

} // namespace

bool is_facing(std::span<const double> slave_normal, std::span<const double> master_normal) {
  return dot(slave_normal, master_normal) <= facing_cosine;
}

MasterPlace find_closest(const MasterSurface& master, const SearchPoint& point, double search_distance,
                         std::vector<std::int32_t>& scratch) {
  const auto [nearest, facet] = nearest_facing(master, point, search_distance, scratch);
  if (facet < 0) return {};
  std::array<double, 3> away{};
  for (std::size_t c = 0; c < point.place.size(); ++c)
    away[c] = point.place[c] - nearest.point[c];
  const double height = dot(away, nearest.normal);
  const double aside = std::sqrt(std::max(0.0, nearest.distance * nearest.distance - height * height));
  MasterPlace place{.facet = facet, .xi = nearest.xi, .normal = nearest.normal, .gap = height};
  if (nearest.feature == Feature::Facet) return place;
  const auto type = master.type(facet);
  const auto corners = corners_at(type, nearest.feature, nearest.xi);
  const double size = facet_size(type, master.positions(facet));
  if (master.on_rim(facet, corners)) { // beyond the end of the master: nothing to touch
    if (aside > rim_tolerance * size) return {};
  } else if (master.is_smooth() && aside <= rim_tolerance * size) {
    return place; // no edge: the facet beyond has the same normal there
  } else if (nearest.distance > rim_tolerance * size) {
    const double sign = height < 0.0 ? -1.0 : 1.0;
    for (std::size_t c = 0; c < point.place.size(); ++c)
      place.normal[c] = sign * away[c] / nearest.distance;
    place.gap = sign * nearest.distance;
    place.hold = hold_at(type, corners);
  }
  return place;
}

MasterPlace find_along_normal(const MasterSurface& master, const SearchPoint& point, double search_distance,
                              std::vector<std::int32_t>& scratch) {
  const std::size_t d = point.place.size();
  Box box;
  for (const double s : {-search_distance, search_distance}) {
    std::array<double, 3> end{};
    for (std::size_t c = 0; c < d; ++c)
      end[c] = point.place[c] + s * point.normal[c];
    box.include(std::span<const double>(end.data(), d));
  }
  box.inflate(1e-9 * search_distance);
  master.tree().query(box, scratch);
  double best = search_distance;
  MasterPlace place;
  for (const auto candidate : scratch) {
    if (point.own && master.share_a_node(point.own->facet, candidate)) continue;
    const auto projection = master.project_along(candidate, point.place, point.normal);
    if (!projection.found || projection.distance > best || !is_facing(point.normal, projection.normal)) continue;
    if (point.own && !is_partner(master, *point.own, candidate, projection, height_over(projection, point.place)))
      continue;
    best = projection.distance;
    place = {.facet = candidate, .xi = projection.xi, .normal = {}, .gap = 0.0, .hold = AlongSlaveNormal{}};
    for (std::size_t c = 0; c < d; ++c) {
      place.normal[c] = -point.normal[c];
      place.gap += place.normal[c] * (point.place[c] - projection.point[c]);
    }
  }
  return place;
}

} // namespace amontons
