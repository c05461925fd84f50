#include "contact/contact_points.hpp"

#include "fe/node_numbering.hpp"
#include "geometry/projection.hpp"
#include "geometry/segment_quadrature.hpp"
#include "math/reference_element.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace amontons {

namespace {

/// Slave and master must face each other: cosine of the angle between outward normals below this.
constexpr double facing_cosine = -0.1;
/// A projection onto the rim of the master counts when the point stands over it within this part of a facet.
constexpr double rim_tolerance = 1e-6;

/// A node has a master when this part of its support does; the equation of its multiplier is no smaller than that.
constexpr double least_cover = 1e-6;

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

std::array<double, 2> centre_of(ElementType type) {
  return num_vertices(type) == 3 ? std::array{1.0 / 3.0, 1.0 / 3.0} : std::array{0.0, 0.0};
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
  if (const auto* surface = std::get_if<std::string>(&pair.master)) gather_master(layout, *surface);
  if (const auto* segment = std::get_if<SegmentIntegration>(&pair.integration); segment && master_)
    place_by_segments(segment->degree);
  else
    place_by_rule(std::visit([](const auto& integration) { return integration.degree; }, pair.integration));
  if (std::holds_alternative<Penalty>(pair.enforcement)) find_mean_size();
  if (master_) {
    search();
    average_over_master();
  } else {
    move_rigid_master(0.0);
  }
  scratch_ = {};
}

void ContactPoints::gather_master(const DofLayout& layout, const std::string& surface) {
  Box reach;
  for (const auto node : slave_->nodes)
    reach.include(mesh_.position(node));
  if (!reach.empty()) reach.inflate(pair_.search_distance);
  if (mesh_.dim == 2) reach.low[2] = reach.high[2] = 0.0;
  master_ = std::make_unique<MasterSurface>(layout, mesh_.surfaces.at(surface), reach);
}

// --- placing ---------------------------------------------------------------------------------------------------------

void ContactPoints::place_by_rule(int degree) {
  std::map<ElementType, std::vector<std::size_t>> values; // of the rule's points
  for (std::int32_t f = 0; f < slave_->size(); ++f) {
    const auto type = slave_->types[f];
    const auto& rule = quadrature(type, degree);
    auto& rows = values[type];
    for (int q = static_cast<int>(rows.size()); q < rule.size(); ++q)
      rows.push_back(add_values(type, rule.point(q)));
    const auto positions = facet_positions(mesh_, slave_->facet(f));
    for (int q = 0; q < rule.size(); ++q) {
      std::array<double, 3> normal{};
      const double measure = facet_normal(type, positions, rule.point(q), normal);
      add_point(f, positions, rule.point(q), rule.weights[q] * measure, rows[q], ContactPoint::none);
    }
  }
}

void ContactPoints::place_by_segments(int degree) {
  for (std::int32_t f = 0; f < slave_->size(); ++f) {
    const auto type = slave_->types[f];
    const auto positions = facet_positions(mesh_, slave_->facet(f));
    const auto across = facets_across(f);
    std::vector<FacetNodes> others;
    for (const auto facet : across)
      others.push_back({master_->type(facet), master_->positions(facet)});
    for (const auto& point : segment_quadrature({type, positions}, others, degree)) {
      const std::span<const double> xi(point.xi.data(), element_dim(type));
      const bool is_covered = point.other != SegmentPoint::uncovered;
      add_point(f, positions, xi, point.weight, add_values(type, xi),
                is_covered ? across[point.other] : ContactPoint::none);
    }
  }
}

/// Master facets within reach of a slave facet across its mean normal that face it, in an order that does not depend on
/// the number of ranks.
std::vector<std::int32_t> ContactPoints::facets_across(std::int32_t facet) {
  const std::size_t d = mesh_.dim;
  const auto type = slave_->types[facet];
  const auto positions = facet_positions(mesh_, slave_->facet(facet));
  std::array<double, 3> normal{};
  facet_normal(type, positions, centre_of(type), normal);
  Box box;
  for (std::size_t at = 0; at < positions.size(); at += d)
    for (const double s : {-pair_.search_distance, pair_.search_distance}) {
      std::array<double, 3> end{};
      for (std::size_t c = 0; c < d; ++c)
        end[c] = positions[at + c] + s * normal[c];
      box.include(std::span<const double>(end.data(), d));
    }
  box.inflate(1e-9 * box.diagonal());
  master_->tree().query(box, found_);
  std::vector<std::pair<std::array<double, 3>, std::int32_t>> facing;
  for (const auto candidate : found_) {
    const auto nodes = master_->positions(candidate);
    std::array<double, 3> other{}, sum{};
    facet_normal(master_->type(candidate), nodes, centre_of(master_->type(candidate)), other);
    if (dot(normal, other) > facing_cosine) continue;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      sum[i % d] += nodes[i];
    facing.emplace_back(sum, candidate);
  }
  std::sort(facing.begin(), facing.end());
  std::vector<std::int32_t> facets;
  for (const auto& [place, candidate] : facing)
    facets.push_back(candidate);
  return facets;
}

/// `area`: part of the facet's reference area that the point stands for; `values`: its row.
void ContactPoints::add_point(std::int32_t facet, std::span<const double> positions, std::span<const double> xi,
                              double area, std::size_t values, std::int32_t guess) {
  const int d = mesh_.dim;
  const auto type = slave_->types[facet];
  const std::size_t behind_slave = element_order(type) == 1 ? 0 : num_nodes(type);
  ContactPoint point{.facet = facet, .values = values, .multipliers = values + 2 + behind_slave};
  Scratch scratch{.slave_normal = {}, .guess = guess};
  facet_normal(type, positions, xi, scratch.slave_normal);
  const auto shape = slave_shape(point);
  for (std::size_t a = 0; a < shape.size(); ++a)
    for (int c = 0; c < d; ++c)
      point.place[c] += shape[a] * positions[a * d + c];
  point.size = facet_size(type, positions);
  point.weight = area * circumference(pair_.space, point.place[0]);
  points_.push_back(point);
  scratch_.push_back(scratch);
}

/// Returns where the row begins.
std::size_t ContactPoints::add_values(ElementType type, std::span<const double> xi) {
  const std::size_t row = values_.size();
  values_.push_back(xi[0]);
  values_.push_back(xi.size() > 1 ? xi[1] : 0.0);
  const auto append = [&](ElementType element) {
    values_.resize(values_.size() + num_nodes(element));
    shape_values(element, xi, std::span(values_).last(num_nodes(element)));
  };
  append(type);
  if (element_order(type) > 1) append(linear_element(type));
  return row;
}

// --- searching -------------------------------------------------------------------------------------------------------

void ContactPoints::search() {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (std::holds_alternative<SlaveNormal>(pair_.projection))
      find_along_normal(points_[i], scratch_[i].slave_normal);
    else
      find_closest(points_[i], scratch_[i]);
    set_epsilon(points_[i]);
  }
  order_by_master();
}

/// Brings the points of a slave facet that have found the same master facet together, in the order in which the facet's
/// points came upon their masters.
void ContactPoints::order_by_master() {
  std::vector<ContactPoint> ordered;
  ordered.reserve(points_.size());
  std::vector<std::int32_t> masters;
  for (std::size_t begin = 0, end = 0; begin < points_.size(); begin = end) {
    masters.clear();
    for (end = begin; end < points_.size() && points_[end].facet == points_[begin].facet; ++end)
      if (std::find(masters.begin(), masters.end(), points_[end].master) == masters.end())
        masters.push_back(points_[end].master);
    for (const auto master : masters)
      for (std::size_t i = begin; i < end; ++i)
        if (points_[i].master == master) ordered.push_back(points_[i]);
  }
  points_ = std::move(ordered);
}

/// Takes the points without a master out of the multiplier basis of nodes that have a master in part of their support.
void ContactPoints::average_over_master() {
  NodeSpace space(mesh_, {{.name = pair_.slave, .nodes = mesh_.node_groups.at(pair_.slave)}});
  const auto& nodes = space.fields()[0].nodes;
  std::vector<std::int32_t> position(mesh_.num_local(), -1);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    position[nodes[i]] = static_cast<std::int32_t>(i);
  std::vector<std::vector<double>> covered(1, std::vector<double>(nodes.size(), 0.0)), all = covered;
  for (const auto& point : points_) {
    const auto shape = multiplier_shape(point);
    for (std::size_t a = 0; a < shape.size(); ++a) {
      const auto at = position[slave_->facet(point.facet)[a]];
      all[0][at] += point.weight * shape[a];
      if (point.master != ContactPoint::none) covered[0][at] += point.weight * shape[a];
    }
  }
  for (auto* part : {&covered, &all}) { // sums over the ranks that share a node
    const auto global = space.new_vector();
    space.add(*part, global);
    space.gather(global, *part);
  }
  for (auto& point : points_) {
    if (point.master != ContactPoint::none) continue;
    const auto shape = multiplier_shape(point);
    std::vector<double> rest(shape.begin(), shape.end());
    for (std::size_t a = 0; a < rest.size(); ++a) {
      const auto at = position[slave_->facet(point.facet)[a]];
      if (covered[0][at] > least_cover * all[0][at]) rest[a] = 0.0;
    }
    point.multipliers = values_.size();
    values_.insert(values_.end(), rest.begin(), rest.end());
  }
}

void ContactPoints::set_epsilon(ContactPoint& point) const {
  double stiffness = pair_.stiffness[slave_->bodies[point.facet]];
  if (point.master >= 0) { // the softer side decides: harmonic mean
    const double other = pair_.stiffness[master_->body(point.master)];
    stiffness = 2.0 * stiffness * other / (stiffness + other);
  }
  // A penalty carries its pressure by overlap: under a uniform pressure facets of different sizes must overlap alike,
  // or the pressure is not uniform. Multipliers make up for any ε.
  const double h = std::holds_alternative<Penalty>(pair_.enforcement) ? mean_size_ : point.size;
  point.epsilon = augmentation_ * pair_.alpha * stiffness / h;
}

void ContactPoints::find_mean_size() {
  double sums[2] = {0.0, 0.0};
  for (const auto& point : points_) {
    sums[0] += point.weight * point.size;
    sums[1] += point.weight;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  mean_size_ = sums[0] / sums[1];
}

void ContactPoints::scale_augmentation(double factor) {
  augmentation_ = factor;
  for (auto& point : points_)
    set_epsilon(point);
}

void ContactPoints::attach(ContactPoint& point, std::int32_t facet, std::span<const double> xi) const {
  const auto type = master_->type(facet);
  point.master = facet;
  shape_values(type, xi.first(element_dim(type)), std::span(point.master_shape).first(num_nodes(type)));
}

/// The closest facing master point. n is the facet's normal inside a facet; on an edge or vertex that the surface
/// continues across, the direction from the projection to the point (or away from it, for a penetrating point).
void ContactPoints::find_closest(ContactPoint& point, const Scratch& scratch) {
  const int d = mesh_.dim;
  const std::span<const double> x(point.place.data(), d);
  double best = pair_.search_distance;
  Projection nearest;
  std::int32_t facet = ContactPoint::none;
  const auto consider = [&](std::int32_t candidate, double radius) {
    const auto projection = closest_point(master_->type(candidate), master_->positions(candidate), x);
    if (!projection.found || projection.distance > std::min(best, radius)) return;
    if (dot(projection.normal, std::span(scratch.slave_normal).first(d)) > facing_cosine) return;
    const bool tie = facet != ContactPoint::none && projection.distance > best * (1.0 - 1e-12);
    if (tie && projection.feature != Feature::Facet) return;
    best = projection.distance;
    nearest = projection;
    facet = candidate;
  };
  if (scratch.guess != ContactPoint::none) consider(scratch.guess, best);
  // Nothing farther than the guess can be nearest. Without one: a box that doubles until something is found in it.
  double radius = std::min(facet == ContactPoint::none ? point.size : best, pair_.search_distance);
  for (;; radius = std::min(2.0 * radius, pair_.search_distance)) {
    Box box;
    box.include(x);
    box.inflate(radius);
    master_->tree().query(box, found_);
    for (const auto candidate : found_)
      if (candidate != scratch.guess) consider(candidate, radius);
    if (facet != ContactPoint::none || radius >= pair_.search_distance) break;
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
    if (dot(projection.normal, slave_normal.first(d)) > facing_cosine) continue;
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

} // namespace amontons
