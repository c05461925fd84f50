// Where the points of a frictional pair were at the last accepted state, in finite kinematics: on which place of the
// master, and with which slave tangents. Slip and the turning of what friction remembers are measured from there.
#pragma once

#include "contact/contact_history.hpp"
#include "contact/contact_points.hpp"

#include <vector>

namespace amontons {

class SlipPath {
 public:
  /// The old places are those where the points stand now. `points` outlives this object.
  explicit SlipPath(const ContactPoints& points);
  /// Makes the present places the old ones.
  void accept();
  const std::vector<PlaceHistory>& places() const { return old_; }
  void restore(std::vector<PlaceHistory> places) { old_ = std::move(places); }

  /// From the present place of the old projection to the slave point, x − ρ(ξ_old): its tangential part is the slip
  /// increment, for x − ρ(ξ) lies along the normal. Zero for a point that had no projection.
  Eigen::Vector3d moved(std::size_t i) const;
  /// The facet of the old projection, or ContactPoint::none or rigid.
  std::int32_t old_facet(std::size_t i) const;
  const PlaceHistory& old(std::size_t i) const { return old_[i]; }
  /// How the slave surface has turned at the point.
  SurfaceRotation rotation(std::size_t i) const;

 private:
  const ContactPoints& points_;
  std::vector<PlaceHistory> old_;
};

} // namespace amontons
