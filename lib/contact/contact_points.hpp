// The quadrature points of a slave surface and what each finds on the master: normal, gap, shape functions. In small
// kinematics this is done once, in the reference configuration (rigid masters: at their present place):
//   g = g0 + n · (u_slave − u_master),  n and ρ(ξ) fixed.
// In finite kinematics follow() does it for every iterate, in the current configuration, and takes weights there.
#pragma once

#include "contact/contact_pair.hpp"
#include "contact/master_surface.hpp"
#include "contact/point_search.hpp"
#include "form/form.hpp"
#include "geometry/contact_kinematics.hpp"

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace amontons {

/// Surfaces that are closer than this part of a facet size are guessed to be in contact where nothing is known yet.
constexpr double guess_reach = 1e-2;

/// A quadrature point of the slave surface.
struct ContactPoint {
  std::int32_t facet;            // of the slave FacetSet
  std::int32_t master = none;    // facet of the MasterSurface, or one of the marks below
  std::size_t values;            // where ContactPoints keeps its ξ and slave shape functions,
  std::size_t multipliers;       // and its multiplier basis
  double reference_weight = 0.0; // area of the reference configuration
  double weight = 0.0;           // in finite kinematics that of the current one
  double size = 0.0;             // h of the slave facet
  double epsilon = 0.0;          // augmentation parameter, force / volume
  double gap0 = 1e300;           // in finite kinematics the current gap
  std::array<double, 3> place{}; // reference position
  std::array<double, 3> normal{};
  double thickness = no_thickness;                       // of the body behind it, where the surface may meet itself
  std::array<double, most_stencil_nodes> master_shape{}; // of the master facet's stencil

  static constexpr std::int32_t none = -1;  // nothing within the search distance: open for good
  static constexpr std::int32_t rigid = -2; // the pair's rigid shape
};

/// A point and its projection in the current configuration.
struct PointNow {
  SurfacePoint slave;
  std::array<double, 3> reference_normal{}; // of the slave
  std::array<double, 2> xi{};               // of the projection on the master's facet
  Eigen::Vector3d projection = Eigen::Vector3d::Zero();
  ProjectionHold hold = OnFacet{};
};

/// The points of a pair on this rank, facet by facet; within a facet those with the same master facet stand together,
/// in an order that does not depend on the number of ranks.
class ContactPoints {
 public:
  /// Searches the master. Collective.
  ContactPoints(const DofLayout& layout, const ContactPair& pair);

  const FacetSet& slave() const { return *slave_; }
  const std::vector<ContactPoint>& points() const { return points_; }
  MasterSurface* master() const { return master_.get(); }
  bool has_rigid_master() const { return !master_; }
  /// Values of the slave facet's shape functions at a point.
  std::span<const double> slave_shape(const ContactPoint& point) const {
    return std::span(values_).subspan(point.values + 2, num_nodes(slave_->types[point.facet]));
  }
  /// Values of the facet's multiplier basis (linear). A point without a master, which is open for good, counts only for
  /// nodes that have no master anywhere around them: theirs is zero, and all others are an average over the area that
  /// has a master.
  std::span<const double> multiplier_shape(const ContactPoint& point) const {
    return std::span(values_).subspan(point.multipliers, num_vertices(slave_->types[point.facet]));
  }
  /// Place on the slave facet.
  std::array<double, 2> xi(const ContactPoint& point) const {
    return {values_[point.values], values_[point.values + 1]};
  }
  /// u_slave − u_master at a point, with the master's displacements as of its last refresh (a rigid master's motion is
  /// not in it).
  std::array<double, 3> displacement_jump(const ContactPoint& point, const State& state) const;
  /// Moves a rigid master to where it is at time t and takes normals and gaps anew.
  void move_rigid_master(double t);
  std::array<double, 3> rigid_shift() const { return shift_; }
  /// Makes ε `factor` times what the pair says.
  void scale_augmentation(double factor);

  // Finite kinematics:
  bool is_following() const { return pair_.kinematics == Kinematics::Finite; }
  /// Takes normals, gaps, weights and master shape functions to the iterate; gathers the master anew when surfaces have
  /// moved as far as the last gathering looked. Does nothing when the iterate is that of the last call. Collective.
  void follow(const State& state);
  /// Makes the iterate of the last follow() the state from which the next increment starts; and takes up an earlier
  /// such state again.
  void accept();
  const std::vector<double>& accepted_displacement() const { return accepted_displacement_; }
  void restore(std::vector<double> accepted_displacement);
  /// Where the surface may meet itself: has a point gone through the wall that was in front of it at the last accepted
  /// state, and so far behind it that it has lost sight of it (own_body.hpp)? On this rank, as of the last follow().
  bool has_gone_through() const;
  /// As of the last follow().
  const PointNow& now(std::size_t i) const { return now_[i]; }
  /// A master facet at ξ.
  SurfacePoint master_at(std::int32_t facet, std::span<const double> xi) const { return master_->at(facet, xi); }
  /// Where forces at a point act: in small kinematics at its reference place; in finite kinematics at its current
  /// place, or at the projection where the slave takes the couple of shear over a gap (along the slave's normal, at
  /// edges and corners of the master; point_tangent.cpp).
  std::array<double, 3> force_place(std::size_t i) const;

 private:
  /// What the search needs to know of a point besides its place.
  struct Scratch {
    std::array<double, 3> slave_normal;
    std::int32_t guess; // master facet that is likely to be the nearest, or none
  };
  /// A place on a master facet.
  struct FacetPlace {
    std::int64_t facet = none_in_front; // its name
    std::array<double, 2> xi{};
    static constexpr std::int64_t none_in_front = -1;
  };
  void gather_master(const std::string& surface);
  void measure_thickness();
  std::optional<OwnBody> own_body(const ContactPoint& point, std::span<const double> reference_normal) const;
  Box slave_box(std::span<const double> displacement) const;
  void gather_where_needed();
  void follow_all();
  void place_now(ContactPoint& point, PointNow& now) const;
  void follow_master(ContactPoint& point, PointNow& now);
  void place_by_rule(int degree);
  void place_by_segments(int degree);
  std::vector<std::int32_t> facets_across(std::int32_t facet);
  void add_point(std::int32_t facet, std::span<const double> positions, std::span<const double> xi, double area,
                 std::size_t values, std::int32_t guess);
  std::size_t add_values(ElementType type, std::span<const double> xi);
  std::size_t row_of_multipliers(const ContactPoint& point) const;
  void average_over_master();
  void search();
  void order_by_master();
  MasterPlace find_master(const SearchPoint& point);
  void attach(ContactPoint& point, const MasterPlace& place) const;
  void set_epsilon(ContactPoint& point) const;
  void find_mean_size();

  const DofLayout& layout_;
  const Mesh& mesh_;
  const ContactPair& pair_;
  const FacetSet* slave_;
  std::vector<ContactPoint> points_;
  /// ξ (two numbers), slave shape functions, multiplier basis where it differs (order 2). Rows of a rule on facets are
  /// shared by all facets of a type, those on segments belong to one point.
  std::vector<double> values_;
  std::vector<Scratch> scratch_; // per point, during construction
  std::unique_ptr<MasterSurface> master_;
  std::array<double, 3> shift_{};
  double augmentation_ = 1.0;       // factor of ε
  double mean_size_ = 0.0;          // harmonic, of the slave facets; of a penalty only
  std::vector<std::int32_t> found_; // scratch
  std::vector<std::int32_t>
      welded_; // of bodies, where the surface may meet itself; and what was in front of its points
  std::vector<FacetPlace> in_front_; // at the last accepted state; empty when that is not known
  std::size_t num_values_ = 0;       // of values_ that are not the averages' over the master
  // Finite kinematics:
  std::vector<PointNow> now_;
  std::vector<double> displacement_, accepted_displacement_, gathered_displacement_; // num_local x dim
  std::vector<std::uint8_t> covered_; // points with a master when averages were last taken
  bool accepted_is_gathered_ = true;
  std::optional<double> followed_time_;
};

} // namespace amontons
