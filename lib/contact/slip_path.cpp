#include "contact/slip_path.hpp"

#include <stdexcept>

namespace amontons {

namespace {

using Eigen::Vector3d;

Vector3d vector(const std::array<double, 3>& v) { return Vector3d(v[0], v[1], v[2]); }

} // namespace

SlipPath::SlipPath(const ContactPoints& points) : points_(points), old_(points.points().size()) { accept(); }

void SlipPath::accept() {
  const Vector3d shift = vector(points_.rigid_shift());
  for (std::size_t i = 0; i < old_.size(); ++i) {
    const auto& point = points_.points()[i];
    const auto& now = points_.now(i);
    auto& place = old_[i];
    place = {.facet = point.master >= 0 ? points_.master()->name(point.master) : point.master,
             .xi = now.xi,
             .on_shape = {},
             .tangents = {}};
    Eigen::Map<TangentPair>(place.tangents.data()) = now.slave.tangents;
    if (point.master == ContactPoint::rigid) Vector3d::Map(place.on_shape.data()) = now.projection - shift;
  }
}

std::int32_t SlipPath::old_facet(std::size_t i) const {
  if (old_[i].facet < 0) return static_cast<std::int32_t>(old_[i].facet);
  const auto facet = points_.master()->find(old_[i].facet);
  if (facet < 0) throw std::logic_error("contact: the master facet of an accepted state was not gathered");
  return facet;
}

Vector3d SlipPath::moved(std::size_t i) const {
  const auto facet = old_facet(i);
  const auto& x = points_.now(i).slave.place;
  if (facet == ContactPoint::none) return Vector3d::Zero();
  if (facet == ContactPoint::rigid) return x - vector(old_[i].on_shape) - vector(points_.rigid_shift());
  return x - points_.master_at(facet, old_[i].xi).place;
}

SurfaceRotation SlipPath::rotation(std::size_t i) const {
  return surface_rotation(Eigen::Map<const TangentPair>(old_[i].tangents.data()), points_.now(i).slave.tangents);
}

} // namespace amontons
