// What a contact pair remembers of the last accepted state, as plain data: what a snapshot keeps and a checkpoint
// stores.
#pragma once

#include "friction/return_mapping.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace amontons {

/// Friction at a point or a node of the slave surface. All vectors are Cartesian, so nothing depends on how facets are
/// numbered.
struct PointHistory {
  TangentVector traction{};     // what the slave exerts, stress
  std::array<double, 3> jump{}; // u_slave − u_master − rigid shift, length
  FrictionState state{};        // of the law
  double slip = 0.0;            // accumulated over all contacts of the point, length
  double slip_rate = 0.0;       // in the last increment, length / time
  bool open = true;

  /// As a row of numbers, and back.
  static constexpr int row_size = 11;
  void append_to(std::vector<double>& row) const;
  static PointHistory from_row(std::span<const double> row);
};

/// The normal part at a point over a curved rigid master, whose normal turns as it moves.
struct NormalHistory {
  double sigma = 0.0, gap = 0.0;
  std::array<double, 3> normal{}, jump{}; // jump: u_slave − rigid shift
};

/// Finite kinematics: the projection of a point and the tangents of the slave there.
struct PlaceHistory {
  std::int64_t facet = -1;          // MasterSurface::name, or ContactPoint::none or rigid
  std::array<double, 2> xi{};       // on that facet
  std::array<double, 3> on_shape{}; // on a rigid master: the projection less the shape's shift
  std::array<double, 6> tangents{}; // two columns
};

struct ContactHistory {
  double time = 0.0;
  std::vector<double> multipliers;                         // at PairReport::nodes(), stress
  std::vector<std::vector<double>> tangential_multipliers; // [component][node], stress; empty without friction
  std::vector<PointHistory> points;                        // of this rank; empty without friction or with `nodes`
  std::vector<PointHistory> nodes;                         // at MortarForm::nodes() with friction, instead of `points`
  std::vector<NormalHistory> normals;                      // of this rank; empty without a curved rigid master
  // Of this rank in finite kinematics, else empty:
  std::vector<double> displacement; // num_local x dim
  std::vector<PlaceHistory> places; // empty without friction
};

} // namespace amontons
