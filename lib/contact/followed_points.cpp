// The part of ContactPoints for finite kinematics: points and projections in the current configuration. What is found
// is a function of the iterate alone: every call looks at all facets within the search distance, the one found before
// being no more than the first guess, so that no history of iterations gets into the residual, and a point passes from
// facet to facet, and from rank to rank, by itself.
#include "contact/contact_points.hpp"

#include "math/reference_element.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace amontons {

namespace {

Eigen::Vector3d vector(const std::array<double, 3>& v) { return Eigen::Vector3d(v[0], v[1], v[2]); }
std::array<double, 3> array(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }
std::array<double, 3> normal_of(const SurfacePoint& at) {
  return array(at.tangents.col(0).cross(at.tangents.col(1)).normalized());
}

} // namespace

void ContactPoints::follow(const State& state) {
  int is_new = followed_time_ != state.time || !std::equal(displacement_.begin(), displacement_.end(),
                                                           state.displacement.begin(), state.displacement.end());
  MPI_Allreduce(MPI_IN_PLACE, &is_new, 1, MPI_INT, MPI_MAX, mesh_.comm);
  if (!is_new) return;
  followed_time_ = state.time;
  displacement_.assign(state.displacement.begin(), state.displacement.end());
  if (master_) {
    gather_where_needed();
    master_->refresh(state.unknowns);
    master_->move();
  }
  follow_all();
}

void ContactPoints::follow_all() {
  now_.resize(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    place_now(points_[i], now_[i]);
    follow_master(points_[i], now_[i]);
  }
  if (!master_) return;
  std::vector<std::uint8_t> covered(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i)
    covered[i] = points_[i].master != ContactPoint::none;
  int changed = covered != covered_;
  MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPI_INT, MPI_MAX, mesh_.comm);
  covered_ = std::move(covered);
  if (changed) average_over_master();
}

/// The last gathering looked a search distance ahead for each side.
void ContactPoints::gather_where_needed() {
  const auto& name = std::get<std::string>(pair_.master);
  double farthest = 0.0;
  for (const auto* surface : {slave_, &mesh_.surfaces.at(name)})
    for (const auto node : surface->nodes) {
      double square = 0.0;
      for (int c = 0; c < mesh_.dim; ++c) {
        const std::size_t at = std::size_t(node) * mesh_.dim + c;
        square += std::pow(displacement_[at] - gathered_displacement_[at], 2);
      }
      farthest = std::max(farthest, std::sqrt(square));
    }
  MPI_Allreduce(MPI_IN_PLACE, &farthest, 1, MPI_DOUBLE, MPI_MAX, mesh_.comm);
  if (accepted_is_gathered_ && farthest <= pair_.search_distance) return;
  gather_master(name);
  for (auto& point : points_)
    point.master = ContactPoint::none; // numbers of the facets gathered before
}

void ContactPoints::accept() {
  accepted_displacement_ = displacement_;
  if (welded_.empty()) return;
  in_front_.assign(points_.size(), {});
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (points_[i].master >= 0) in_front_[i] = {master_->name(points_[i].master), now_[i].xi};
}

bool ContactPoints::has_gone_through() const {
  for (std::size_t i = 0; i < in_front_.size(); ++i) {
    const auto facet = in_front_[i].facet < 0 ? -1 : master_->find(in_front_[i].facet);
    if (facet < 0) continue;
    const auto wall = master_at(facet, in_front_[i].xi);
    const double height = (now_[i].slave.place - wall.place).dot(vector(normal_of(wall)));
    if (height <= -points_[i].thickness) return true;
  }
  return false;
}

void ContactPoints::restore(std::vector<double> accepted_displacement) {
  accepted_displacement_ = std::move(accepted_displacement);
  accepted_is_gathered_ = false;
  in_front_.clear();
  followed_time_.reset();
}

/// Place, tangents and weight: that of the reference configuration times the stretch of the area.
void ContactPoints::place_now(ContactPoint& point, PointNow& now) const {
  const auto type = slave_->types[point.facet];
  const auto nodes = slave_->facet(point.facet);
  const std::size_t d = mesh_.dim;
  std::array<double, 27> reference{}, current{};
  for (std::size_t a = 0; a < nodes.size(); ++a)
    for (std::size_t c = 0; c < d; ++c) {
      reference[a * d + c] = mesh_.position(nodes[a])[c];
      current[a * d + c] = reference[a * d + c] + displacement_[std::size_t(nodes[a]) * d + c];
    }
  const auto place = xi(point);
  const auto before = surface_point(type, std::span(reference).first(nodes.size() * d), place);
  now.slave = surface_point(type, std::span(current).first(nodes.size() * d), place);
  now.reference_normal = normal_of(before);
  const auto area = [&](const SurfacePoint& at) {
    return at.tangents.col(0).cross(at.tangents.col(1)).norm() * circumference(pair_.space, at.place[0]);
  };
  point.weight = point.reference_weight * area(now.slave) / area(before);
}

void ContactPoints::follow_master(ContactPoint& point, PointNow& now) {
  const std::size_t d = mesh_.dim;
  const std::span<const double> place(now.slave.place.data(), d);
  if (!master_) {
    const auto& shape = std::get<RigidMaster>(pair_.master).shape;
    const auto contact = signed_distance(shape, shift_, place);
    const auto gradient = normal_gradient(shape, shift_, place);
    OnRigidShape hold;
    for (int i = 0; i < 3; ++i)
      hold.curvature.row(i) = vector(gradient[i]).transpose();
    now.hold = hold;
    now.projection = now.slave.place - contact.gap * vector(contact.normal);
    point.gap0 = contact.gap;
    point.normal = contact.normal;
    return;
  }
  const auto normal = normal_of(now.slave);
  const auto own = own_body(point, std::span(now.reference_normal).first(d));
  const auto found = find_master({.place = place,
                                  .normal = std::span(normal).first(d),
                                  .size = point.size,
                                  .guess = std::max(-1, point.master),
                                  .own = own ? &*own : nullptr});
  attach(point, found);
  set_epsilon(point);
  if (found.facet < 0) return;
  now.xi = found.xi;
  now.hold = found.hold;
  now.projection = now.slave.place - found.gap * vector(found.normal);
}

std::array<double, 3> ContactPoints::force_place(std::size_t i) const {
  if (!is_following()) return points_[i].place;
  const auto& now = now_[i];
  const bool at_slave = std::holds_alternative<OnFacet>(now.hold) || std::holds_alternative<OnRigidShape>(now.hold);
  return array(at_slave ? now.slave.place : now.projection);
}

} // namespace amontons
