#include "contact/own_body.hpp"

#include "math/reference_element.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace amontons {

namespace {

/// A penetration is less than this part of the way that the material behind the point had in the reference
/// configuration.
constexpr double deepest = 0.25;
/// Relative to the length of a way: what counts as zero.
constexpr double rounding = 1e-9;

} // namespace

bool is_partner(const MasterSurface& surface, const OwnBody& own, std::int32_t candidate, const Projection& projection,
                double height) {
  if (height >= 0.0) return true;
  const double depth = projection.distance;
  if (depth >= own.thickness) return false;
  if (own.welded[surface.body(own.facet)] != own.welded[surface.body(candidate)]) return true;
  const auto type = surface.type(candidate);
  const auto nodes = surface.reference_positions(candidate);
  const std::size_t d = own.place.size();
  std::array<double, 9> shape{};
  shape_values(type, std::span(projection.xi).first(element_dim(type)), std::span(shape).first(num_nodes(type)));
  double along = 0.0, square = 0.0;
  for (std::size_t c = 0; c < d; ++c) {
    double way = -own.place[c];
    for (std::size_t a = 0; a * d < nodes.size(); ++a)
      way += shape[a] * nodes[a * d + c];
    along += way * own.normal[c];
    square += way * way;
  }
  const double way = std::sqrt(square);
  return along > -rounding * way || depth <= deepest * way;
}

double thickness_behind(const MasterSurface& exterior, std::span<const double> place, std::span<const double> normal,
                        double reach, std::vector<std::int32_t>& scratch) {
  Box box;
  box.include(place);
  std::array<double, 3> end{};
  for (std::size_t c = 0; c < place.size(); ++c)
    end[c] = place[c] - reach * normal[c];
  box.include(std::span<const double>(end.data(), place.size()));
  box.inflate(rounding * reach);
  exterior.tree().query(box, scratch);
  double thickness = no_thickness;
  for (const auto facet : scratch) {
    const auto exit = project_along(exterior.type(facet), exterior.reference_positions(facet), place, normal);
    double along = 0.0, cosine = 0.0;
    for (std::size_t c = 0; c < place.size(); ++c) {
      along += (exit.point[c] - place[c]) * normal[c];
      cosine += exit.normal[c] * normal[c];
    }
    if (exit.found && cosine < 0.0 && along < 0.0 && -along <= reach) thickness = std::min(thickness, -along);
  }
  return thickness;
}

} // namespace amontons
