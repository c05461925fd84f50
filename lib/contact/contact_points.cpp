#include "contact/contact_points.hpp"

#include "geometry/projection.hpp"
#include "math/reference_element.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

namespace {

/// Slave and master must face each other: cosine of the angle between outward normals below this.
constexpr double facing = -0.1;
/// A projection onto the rim of the master counts when the point stands over it within this part of a facet.
constexpr double rim_tolerance = 1e-6;

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    sum += a[i] * b[i];
  return sum;
}

std::vector<double> facet_positions(const Mesh& mesh, std::span<const std::int32_t> nodes) {
  std::vector<double> positions;
  for (const auto node : nodes) {
    const auto place = mesh.position(node);
    positions.insert(positions.end(), place.begin(), place.end());
  }
  return positions;
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

} // namespace

ContactPoints::ContactPoints(const DofLayout& layout, const ContactPair& pair)
    : mesh_(layout.mesh()), pair_(pair), slave_(&mesh_.surfaces.at(pair.slave)) {
  place_points();
  if (const auto* surface = std::get_if<std::string>(&pair.master)) {
    Box reach;
    for (const auto& point : points_)
      reach.include(point.place);
    if (!reach.empty()) reach.inflate(pair.search_distance);
    if (mesh_.dim == 2) reach.low[2] = reach.high[2] = 0.0;
    master_ = std::make_unique<MasterSurface>(layout, mesh_.surfaces.at(*surface), reach);
    search();
  } else {
    move_rigid_master(0.0);
  }
}

void ContactPoints::place_points() {
  const int d = mesh_.dim;
  for (std::int32_t f = 0; f < slave_->size(); ++f) {
    const auto type = slave_->types[f];
    const auto nodes = slave_->facet(f);
    const auto positions = facet_positions(mesh_, nodes);
    const double size = facet_size(type, positions);
    const auto& table = tabulation(type, pair_.integration_degree);
    for (int q = 0; q < table.rule->size(); ++q) {
      ContactPoint point{.facet = f, .rule_point = q};
      std::array<double, 3> normal{};
      const double measure = facet_normal(type, positions, table.rule->point(q), normal);
      const auto shape = table.value(q);
      for (std::size_t a = 0; a < nodes.size(); ++a)
        for (int c = 0; c < d; ++c)
          point.place[c] += shape[a] * positions[a * d + c];
      point.size = size;
      point.weight = table.rule->weights[q] * measure * circumference(pair_.space, point.place[0]);
      points_.push_back(point);
      slave_normals_.push_back(normal);
    }
  }
}

void ContactPoints::search() {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (std::holds_alternative<SlaveNormal>(pair_.projection))
      find_along_normal(points_[i], slave_normals_[i]);
    else
      find_closest(points_[i], slave_normals_[i]);
    set_epsilon(points_[i]);
  }
  std::stable_sort(points_.begin(), points_.end(), [](const ContactPoint& a, const ContactPoint& b) {
    return a.facet != b.facet ? a.facet < b.facet : a.master < b.master;
  });
  slave_normals_.clear();
}

void ContactPoints::set_epsilon(ContactPoint& point) const {
  double stiffness = pair_.stiffness[slave_->bodies[point.facet]];
  if (point.master >= 0) { // the softer side decides: harmonic mean
    const double other = pair_.stiffness[master_->body(point.master)];
    stiffness = 2.0 * stiffness * other / (stiffness + other);
  }
  point.epsilon = pair_.alpha * stiffness / point.size;
}

void ContactPoints::attach(ContactPoint& point, std::int32_t facet, std::span<const double> xi) const {
  const auto type = master_->type(facet);
  point.master = facet;
  shape_values(type, xi.first(element_dim(type)), std::span(point.master_shape).first(num_nodes(type)));
}

/// The closest facing master point. n is the facet's normal inside a facet; on an edge or vertex that the surface
/// continues across, the direction from the projection to the point (or away from it, for a penetrating point).
void ContactPoints::find_closest(ContactPoint& point, std::span<const double> slave_normal) {
  const int d = mesh_.dim;
  const std::span<const double> x(point.place.data(), d);
  double best = pair_.search_distance;
  Projection nearest;
  std::int32_t facet = ContactPoint::none;
  // Look in a box that doubles until something is found inside of it.
  for (double radius = std::min(point.size, best); facet == ContactPoint::none; radius *= 2.0) {
    radius = std::min(radius, pair_.search_distance);
    Box box;
    box.include(x);
    box.inflate(radius);
    master_->tree().query(box, found_);
    for (const auto candidate : found_) {
      const auto projection = closest_point(master_->type(candidate), master_->positions(candidate), x);
      if (!projection.found || projection.distance > std::min(best, radius)) continue;
      if (dot(projection.normal, slave_normal.first(d)) > facing) continue;
      const bool tie = facet != ContactPoint::none && projection.distance > best * (1.0 - 1e-12);
      if (tie && projection.feature != Feature::Facet) continue;
      best = projection.distance;
      nearest = projection;
      facet = candidate;
    }
    if (radius >= pair_.search_distance) break;
  }
  if (facet == ContactPoint::none) return;

  std::array<double, 3> away{};
  for (int c = 0; c < d; ++c)
    away[c] = x[c] - nearest.point[c];
  const double height = dot(away, nearest.normal);
  const double aside = std::sqrt(std::max(0.0, nearest.distance * nearest.distance - height * height));
  point.normal = nearest.normal;
  point.gap0 = height;
  if (nearest.feature != Feature::Facet) {
    const auto corners = corners_at(master_->type(facet), nearest.feature, nearest.xi);
    const double size = facet_size(master_->type(facet), master_->positions(facet));
    if (master_->on_rim(facet, corners)) {
      if (aside > rim_tolerance * size) { // beyond the end of the master: nothing to touch
        point.gap0 = 1e300;
        return;
      }
    } else if (nearest.distance > rim_tolerance * size) {
      const double sign = height < 0.0 ? -1.0 : 1.0;
      for (int c = 0; c < d; ++c)
        point.normal[c] = sign * away[c] / nearest.distance;
      point.gap0 = sign * nearest.distance;
    }
  }
  attach(point, facet, nearest.xi);
}

/// Along the slave's normal: n = −n_slave.
void ContactPoints::find_along_normal(ContactPoint& point, std::span<const double> slave_normal) {
  const int d = mesh_.dim;
  const std::span<const double> x(point.place.data(), d);
  Box box;
  for (const double s : {-pair_.search_distance, pair_.search_distance}) {
    std::array<double, 3> end{};
    for (int c = 0; c < d; ++c)
      end[c] = x[c] + s * slave_normal[c];
    box.include(std::span<const double>(end.data(), d));
  }
  box.inflate(1e-9 * pair_.search_distance);
  master_->tree().query(box, found_);
  double best = pair_.search_distance;
  for (const auto candidate : found_) {
    const auto projection =
        project_along(master_->type(candidate), master_->positions(candidate), x, slave_normal.first(d));
    if (!projection.found || projection.distance > best) continue;
    if (dot(projection.normal, slave_normal.first(d)) > facing) continue;
    best = projection.distance;
    point.gap0 = 0.0;
    for (int c = 0; c < d; ++c) {
      point.normal[c] = -slave_normal[c];
      point.gap0 += point.normal[c] * (x[c] - projection.point[c]);
    }
    attach(point, candidate, projection.xi);
  }
}

void ContactPoints::move_rigid_master(double t) {
  const auto& rigid = std::get<RigidMaster>(pair_.master);
  for (int c = 0; c < 3; ++c)
    shift_[c] = rigid.displacement[c] ? (*rigid.displacement[c])(t) : 0.0;
  for (auto& point : points_) {
    const auto contact = signed_distance(rigid.shape, shift_, std::span<const double>(point.place.data(), mesh_.dim));
    point.gap0 = contact.gap;
    point.normal = contact.normal;
    point.master = ContactPoint::rigid;
    set_epsilon(point);
  }
}

std::span<const double> ContactPoints::slave_shape(const ContactPoint& point) const {
  return tabulation(slave_->types[point.facet], pair_.integration_degree).value(point.rule_point);
}

std::span<const double> ContactPoints::multiplier_shape(const ContactPoint& point) const {
  const auto type = linear_element(slave_->types[point.facet]);
  return tabulation(type, pair_.integration_degree).value(point.rule_point);
}

std::array<double, 3> ContactPoints::displacement_jump(const ContactPoint& point, const State& state) const {
  const int d = mesh_.dim;
  std::array<double, 3> jump{};
  const auto nodes = slave_->facet(point.facet);
  const auto shape = slave_shape(point);
  for (std::size_t a = 0; a < nodes.size(); ++a)
    for (int c = 0; c < d; ++c)
      jump[c] += shape[a] * state.displacement[std::size_t(nodes[a]) * d + c];
  if (point.master < 0) return jump;
  const auto masters = master_->nodes(point.master);
  for (std::size_t b = 0; b < masters.size(); ++b) {
    const auto displacement = master_->displacement(masters[b]);
    for (int c = 0; c < d; ++c)
      jump[c] -= point.master_shape[b] * displacement[c];
  }
  return jump;
}

std::array<double, 2> ContactPoints::xi(const ContactPoint& point) const {
  const auto& rule = quadrature(slave_->types[point.facet], pair_.integration_degree);
  const auto place = rule.point(point.rule_point);
  return {place[0], place.size() > 1 ? place[1] : 0.0};
}

} // namespace amontons
