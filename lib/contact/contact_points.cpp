#include "contact/contact_points.hpp"

#include "fe/node_numbering.hpp"
#include "geometry/projection.hpp"
#include "geometry/segment_quadrature.hpp"
#include "math/reference_element.hpp"
#include "mesh/welded_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace amontons {

namespace {

/// A node has a master when this part of its support does; the equation of its multiplier is no smaller than that.
constexpr double least_cover = 1e-6;

std::vector<double> facet_positions(const Mesh& mesh, std::span<const std::int32_t> nodes) {
  std::vector<double> positions;
  for (const auto node : nodes) {
    const auto place = mesh.position(node);
    positions.insert(positions.end(), place.begin(), place.end());
  }
  return positions;
}

void include_node(Box& box, const Mesh& mesh, std::int32_t node, std::span<const double> displacement) {
  std::array<double, 3> place{};
  for (int c = 0; c < mesh.dim; ++c)
    place[c] = mesh.position(node)[c] + displacement[std::size_t(node) * mesh.dim + c];
  box.include(std::span<const double>(place.data(), mesh.dim));
}

/// Neighbours of a facet are no farther from it. Collective.
double largest_diagonal(MPI_Comm comm, std::span<const Box> boxes) {
  double largest = 0.0;
  for (const auto& box : boxes)
    largest = std::max(largest, box.diagonal());
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, comm);
  return largest;
}

/// Those whose body is in.
template <class IsIn>
FacetSet facets_of(const FacetSet& all, IsIn&& is_in) {
  FacetSet part;
  for (std::int32_t f = 0; f < all.size(); ++f) {
    if (!is_in(all.bodies[f])) continue;
    const auto nodes = all.facet(f);
    part.types.push_back(all.types[f]);
    part.bodies.push_back(all.bodies[f]);
    part.nodes.insert(part.nodes.end(), nodes.begin(), nodes.end());
    part.offsets.push_back(static_cast<std::int32_t>(part.nodes.size()));
  }
  return part;
}

std::array<double, 2> centre_of(ElementType type) {
  return num_vertices(type) == 3 ? std::array{1.0 / 3.0, 1.0 / 3.0} : std::array{0.0, 0.0};
}

} // namespace

ContactPoints::ContactPoints(const DofLayout& layout, const ContactPair& pair)
    : layout_(layout), mesh_(layout.mesh()), pair_(pair), slave_(&mesh_.surfaces.at(pair.slave)) {
  displacement_.assign(std::size_t(mesh_.num_local()) * mesh_.dim, 0.0);
  accepted_displacement_ = gathered_displacement_ = displacement_;
  if (const auto* surface = std::get_if<std::string>(&pair.master)) gather_master(*surface);
  if (const auto* segment = std::get_if<SegmentIntegration>(&pair.integration); segment && master_)
    place_by_segments(segment->degree);
  else
    place_by_rule(std::visit([](const auto& integration) { return integration.degree; }, pair.integration));
  if (std::holds_alternative<Penalty>(pair.enforcement)) find_mean_size();
  if (pair.meets_itself()) measure_thickness();
  if (master_) {
    search();
    average_over_master();
  } else {
    move_rigid_master(0.0);
  }
  scratch_ = {};
  if (is_following()) follow_all();
}

/// Box around the slave nodes of this rank, displaced.
Box ContactPoints::slave_box(std::span<const double> displacement) const {
  Box box;
  for (const auto node : slave_->nodes)
    include_node(box, mesh_, node, displacement);
  return box;
}

/// The facets that slave points can meet between the last accepted state and the present iterate, or after either side
/// has moved on by another search distance.
void ContactPoints::gather_master(const std::string& surface) {
  const auto& facets = mesh_.surfaces.at(surface);
  std::vector<Box> boxes(facets.size());
  Box reach;
  for (const auto* displacement : {&accepted_displacement_, &displacement_}) {
    reach.include(slave_box(*displacement));
    for (std::int32_t f = 0; f < facets.size(); ++f)
      for (const auto node : facets.facet(f))
        include_node(boxes[f], mesh_, node, *displacement);
  }
  double margin = (is_following() ? 3.0 : 1.0) * pair_.search_distance;
  if (std::holds_alternative<CubicMaster>(pair_.smoothing)) margin += largest_diagonal(mesh_.comm, boxes);
  if (!reach.empty()) reach.inflate(margin);
  if (mesh_.dim == 2) reach.low[2] = reach.high[2] = 0.0;
  master_ = std::make_unique<MasterSurface>(layout_, facets, boxes, reach, pair_.smoothing);
  gathered_displacement_ = displacement_;
  accepted_is_gathered_ = true;
}

/// Of the body behind every point: see own_body.hpp. One body (with those welded to it) after the other, for others may
/// be in the way. Collective.
void ContactPoints::measure_thickness() {
  welded_ = welded_bodies(mesh_);
  const auto d = static_cast<std::size_t>(mesh_.dim);
  Box reach = slave_box(displacement_);
  if (!reach.empty()) reach.inflate(pair_.search_distance);
  if (mesh_.dim == 2) reach.low[2] = reach.high[2] = 0.0;
  for (std::int32_t body = 0; body < static_cast<std::int32_t>(welded_.size()); ++body) {
    if (welded_[body] != body) continue;
    const auto facets = facets_of(mesh_.exterior, [&](std::int32_t other) { return welded_[other] == body; });
    std::vector<Box> boxes(facets.size());
    for (std::int32_t f = 0; f < facets.size(); ++f)
      for (const auto node : facets.facet(f))
        boxes[f].include(mesh_.position(node));
    const MasterSurface exterior(layout_, facets, boxes, reach);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (welded_[slave_->bodies[points_[i].facet]] != body) continue;
      const std::span<const double> place(points_[i].place.data(), d), normal(scratch_[i].slave_normal.data(), d);
      points_[i].thickness = thickness_behind(exterior, place, normal, pair_.search_distance, found_);
    }
  }
}

/// What the search must know of a point of a surface that may meet itself; nothing for other pairs.
std::optional<OwnBody> ContactPoints::own_body(const ContactPoint& point,
                                               std::span<const double> reference_normal) const {
  if (welded_.empty()) return std::nullopt;
  return OwnBody{.facet = master_->find_own(point.facet),
                 .place = std::span(point.place).first(reference_normal.size()),
                 .normal = reference_normal,
                 .thickness = point.thickness,
                 .welded = welded_};
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
    if (!is_facing(std::span(normal).first(d), other)) continue;
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

/// Where the linear basis of a point stands: that of the slave itself on facets of order 1, else behind it.
std::size_t ContactPoints::row_of_multipliers(const ContactPoint& point) const {
  const auto type = slave_->types[point.facet];
  return point.values + 2 + (element_order(type) == 1 ? 0 : num_nodes(type));
}

/// `area`: part of the facet's reference area that the point stands for; `values`: its row.
void ContactPoints::add_point(std::int32_t facet, std::span<const double> positions, std::span<const double> xi,
                              double area, std::size_t values, std::int32_t guess) {
  const int d = mesh_.dim;
  const auto type = slave_->types[facet];
  ContactPoint point{.facet = facet, .values = values, .multipliers = 0};
  point.multipliers = row_of_multipliers(point);
  Scratch scratch{.slave_normal = {}, .guess = guess};
  facet_normal(type, positions, xi, scratch.slave_normal);
  const auto shape = slave_shape(point);
  for (std::size_t a = 0; a < shape.size(); ++a)
    for (int c = 0; c < d; ++c)
      point.place[c] += shape[a] * positions[a * d + c];
  point.size = facet_size(type, positions);
  point.reference_weight = area * circumference(pair_.space, point.place[0]);
  if (pair_.meets_itself()) point.reference_weight *= half_pass;
  point.weight = point.reference_weight;
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
    const auto d = static_cast<std::size_t>(mesh_.dim);
    const auto normal = std::span(scratch_[i].slave_normal).first(d);
    const auto own = own_body(points_[i], normal);
    attach(points_[i], find_master({.place = std::span(points_[i].place).first(d),
                                    .normal = normal,
                                    .size = points_[i].size,
                                    .guess = scratch_[i].guess,
                                    .own = own ? &*own : nullptr}));
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
/// By areas of the reference configuration, for the basis must follow from who has a master alone: an iterate that has
/// gone over the axis of revolution has negative areas, and it would stay as that iterate left it until this changes.
void ContactPoints::average_over_master() {
  if (num_values_ == 0) num_values_ = values_.size();
  values_.resize(num_values_);
  for (auto& point : points_)
    point.multipliers = row_of_multipliers(point);
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
      all[0][at] += point.reference_weight * shape[a];
      if (point.master != ContactPoint::none) covered[0][at] += point.reference_weight * shape[a];
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
  double sums[2] = {0.0, 0.0}; // facets, and their 1 / h
  std::int32_t last = -1;
  for (const auto& point : points_) { // facet by facet
    if (point.facet == last) continue;
    last = point.facet;
    sums[0] += 1.0;
    sums[1] += 1.0 / point.size;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  mean_size_ = sums[1] > 0.0 ? sums[0] / sums[1] : 0.0;
}

void ContactPoints::scale_augmentation(double factor) {
  augmentation_ = factor;
  for (auto& point : points_)
    set_epsilon(point);
}

MasterPlace ContactPoints::find_master(const SearchPoint& point) {
  const auto find = std::holds_alternative<SlaveNormal>(pair_.projection) ? find_along_normal : find_closest;
  return find(*master_, point, pair_.search_distance, found_);
}

void ContactPoints::attach(ContactPoint& point, const MasterPlace& place) const {
  point.gap0 = place.gap;
  point.normal = place.normal;
  point.master = place.facet >= 0 ? place.facet : ContactPoint::none;
  if (place.facet < 0) return;
  if (master_->is_smooth()) {
    const auto shape = master_->shape_table(place.facet, place.xi).row(0).eval();
    std::copy(shape.begin(), shape.end(), point.master_shape.begin());
    return;
  }
  const auto type = master_->type(place.facet);
  shape_values(type, std::span(place.xi).first(element_dim(type)),
               std::span(point.master_shape).first(num_nodes(type)));
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
  const auto masters = master_->stencil(point.master);
  for (std::size_t b = 0; b < masters.size(); ++b) {
    const auto displacement = master_->displacement(masters[b]);
    for (int c = 0; c < d; ++c)
      jump[c] -= point.master_shape[b] * displacement[c];
  }
  return jump;
}

} // namespace amontons
