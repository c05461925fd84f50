// Derivatives of gap, normal, place and rotation at a contact point against central differences of projections that are
// made anew, on random pairs of facets.
#include "geometry/contact_kinematics.hpp"

#include "facets.hpp"
#include "geometry/rigid_shape.hpp"

#include <Eigen/Geometry>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::testing;

namespace {

using Eigen::Vector3d;

enum class Hold { Facet, Edge, Corner, SlaveNormal };

/// A slave facet and a master facet, a point of each, and a direction in which all nodes move.
struct Pair {
  ElementType type;
  Hold hold;
  std::vector<double> slave, master, slave_motion, master_motion;
  std::array<double, 2> slave_xi{}, master_xi{};
  Eigen::Vector2d along = Eigen::Vector2d::Zero();
  double gap = 0.0;

  Pair(ElementType facet, Hold kind, double height, std::mt19937& random) : type(facet), hold(kind), gap(height) {
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    const int d = element_dim(type), dim = d + 1;
    slave = random_facet(type, 0.1, random);
    master = random_facet(type, 0.1, random);
    for (auto* motion : {&slave_motion, &master_motion})
      for (std::size_t k = 0; k < slave.size(); ++k)
        motion->push_back(number(random));
    for (auto* xi : {&slave_xi, &master_xi})
      for (int k = 0; k < d; ++k)
        (*xi)[k] = is_triangle(type) ? 0.3 + 0.1 * number(random) : 0.6 * number(random);
    const auto reference = reference_nodes(type);
    if (hold == Hold::Edge) {
      along = {reference[2] - reference[0], reference[3] - reference[1]};
      const double s = 0.5 + 0.3 * number(random);
      master_xi = {reference[0] + s * along[0], reference[1] + s * along[1]};
    }
    if (hold == Hold::Corner)
      for (int k = 0; k < d; ++k)
        master_xi[k] = reference[k];
    // The slave is put where its point stands over that of the master, along whatever is the normal there.
    const auto place = surface_point(type, master, master_xi);
    Vector3d n = place.tangents.col(0).cross(place.tangents.col(1)).normalized();
    if (hold == Hold::Edge) { // any direction across the edge
      const Vector3d t = (place.tangents * along).normalized();
      n = Eigen::AngleAxisd(0.6, t) * n;
    }
    if (hold == Hold::Corner) n = dim == 2 ? Vector3d(0.6, 0.8, 0.0) : Vector3d(0.48, 0.6, 0.64);
    if (hold == Hold::SlaveNormal) {
      const auto own = surface_point(type, slave, slave_xi);
      n = -own.tangents.col(0).cross(own.tangents.col(1)).normalized();
    }
    const Vector3d shift = place.place + gap * n - surface_point(type, slave, slave_xi).place;
    for (std::size_t k = 0; k < slave.size(); ++k)
      slave[k] += shift[static_cast<Eigen::Index>(k) % dim];
  }

  static std::vector<double> moved(const std::vector<double>& nodes, const std::vector<double>& motion, double h) {
    auto result = nodes;
    for (std::size_t k = 0; k < nodes.size(); ++k)
      result[k] += h * motion[k];
    return result;
  }
};

/// What a projection gives: found by Newton's method from its defining equations alone.
struct Found {
  SurfacePoint slave, master;
  Eigen::Vector2d xi;
  Vector3d normal;
  double gap;
};

Eigen::Vector2d solve_place(const Pair& pair, const std::vector<double>& master, const SurfacePoint& slave) {
  const int d = element_dim(pair.type);
  Eigen::Vector2d start(pair.master_xi[0], pair.master_xi[1]), xi = start;
  Eigen::Matrix<double, 2, Eigen::Dynamic> ways;
  if (pair.hold == Hold::Edge)
    ways = pair.along;
  else
    ways = Eigen::Matrix2d::Identity().leftCols(d);
  Eigen::VectorXd eta = Eigen::VectorXd::Zero(ways.cols());
  const auto equations = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
    const Eigen::Vector2d place = start + ways * at;
    const auto there = surface_point(pair.type, master, std::span(place.data(), 2));
    const Vector3d r = slave.place - there.place;
    if (pair.hold == Hold::SlaveNormal) return (slave.tangents.leftCols(d).transpose() * r).eval(); // r along n_s
    return ((there.tangents * ways).transpose() * r).eval();
  };
  for (int iteration = 0; iteration < 30; ++iteration) {
    const Eigen::VectorXd value = equations(eta);
    Eigen::MatrixXd slope(value.size(), eta.size());
    for (int k = 0; k < eta.size(); ++k) {
      Eigen::VectorXd plus = eta, minus = eta;
      plus[k] += 1e-5;
      minus[k] -= 1e-5;
      slope.col(k) = (equations(plus) - equations(minus)) / 2e-5;
    }
    eta -= Eigen::MatrixXd(slope.inverse()) * value;
  }
  xi = start + ways * eta;
  return xi;
}

Found find(const Pair& pair, double h) {
  const auto slave = Pair::moved(pair.slave, pair.slave_motion, h);
  const auto master = Pair::moved(pair.master, pair.master_motion, h);
  Found found;
  found.slave = surface_point(pair.type, slave, pair.slave_xi);
  found.xi = {pair.master_xi[0], pair.master_xi[1]};
  if (pair.hold != Hold::Corner) found.xi = solve_place(pair, master, found.slave);
  found.master = surface_point(pair.type, master, std::span(found.xi.data(), 2));
  const Vector3d r = found.slave.place - found.master.place;
  const auto normal_of = [](const SurfacePoint& s) { return s.tangents.col(0).cross(s.tangents.col(1)).normalized(); };
  if (pair.hold == Hold::Facet)
    found.normal = normal_of(found.master);
  else if (pair.hold == Hold::SlaveNormal)
    found.normal = -normal_of(found.slave);
  else
    found.normal = (pair.gap < 0.0 ? -1.0 : 1.0) * r.normalized();
  found.gap = found.normal.dot(r);
  return found;
}

/// The vectors' variation when the nodes move.
Eigen::Matrix<double, contact_slot::count, 1> direction(const Pair& pair, const Found& found) {
  Eigen::Matrix<double, contact_slot::count, 1> all = Eigen::Matrix<double, contact_slot::count, 1>::Zero();
  const auto put = [&](const std::vector<double>& motion, std::span<const double> xi, int place, int tangents) {
    // The map from nodes to places and tangents is linear: that of the motion is what the nodes' motion makes of them.
    auto point = surface_point(pair.type, motion, xi);
    if (element_dim(pair.type) == 1) point.tangents.col(1).setZero(); // e_z does not move
    all.segment<3>(place) = point.place;
    all.segment<3>(tangents) = point.tangents.col(0);
    all.segment<3>(tangents + 3) = point.tangents.col(1);
  };
  put(pair.slave_motion, pair.slave_xi, contact_slot::x, contact_slot::s);
  put(pair.master_motion, std::span(found.xi.data(), 2), contact_slot::rho, contact_slot::m);
  return all;
}

ProjectionHold hold_of(const Pair& pair) {
  switch (pair.hold) {
  case Hold::Facet:
    return OnFacet{};
  case Hold::Edge:
    return OnEdge{pair.along};
  case Hold::Corner:
    return OnCorner{};
  default:
    return AlongSlaveNormal{};
  }
}

} // namespace

TEST_CASE("derivatives of gap, normal and place are those of projections made anew") {
  std::mt19937 random(11);
  for (const auto type : facet_types())
    for (const auto hold : {Hold::Facet, Hold::Edge, Hold::Corner, Hold::SlaveNormal})
      for (const double gap : {0.03, -0.04, 0.0}) {
        if (hold == Hold::Edge && element_dim(type) == 1) continue;
        if (gap == 0.0 && (hold == Hold::Edge || hold == Hold::Corner)) continue; // no normal there
        CAPTURE(int(type));
        CAPTURE(int(hold));
        CAPTURE(gap);
        for (int sample = 0; sample < 5; ++sample) {
          Pair pair(type, hold, gap, random);
          if (hold == Hold::SlaveNormal) { // surfaces that face each other
            const auto s = surface_point(type, pair.slave, pair.slave_xi);
            const auto m = surface_point(type, pair.master, pair.master_xi);
            const double cosine = s.tangents.col(0)
                                      .cross(s.tangents.col(1))
                                      .normalized()
                                      .dot(m.tangents.col(0).cross(m.tangents.col(1)).normalized());
            if (std::abs(cosine) < 0.5) continue;
          }
          const auto here = find(pair, 0.0);
          CHECK(here.gap == doctest::Approx(gap).epsilon(1e-9));
          const auto kinematics = point_kinematics(here.slave, here.master, hold_of(pair), here.normal, here.gap);
          const auto change = direction(pair, here);
          const double h = 1e-6;
          const auto plus = find(pair, h), minus = find(pair, -h);
          const Vector3d dn = (plus.normal - minus.normal) / (2.0 * h);
          const Eigen::Vector2d dxi = (plus.xi - minus.xi) / (2.0 * h);
          const double scale = 1.0 + dn.norm() + dxi.norm();
          CHECK(std::abs(kinematics.gap.dot(change.transpose()) - (plus.gap - minus.gap) / (2.0 * h)) < 1e-7 * scale);
          CHECK((kinematics.normal * change - dn).norm() < 1e-6 * scale);
          CHECK((kinematics.xi * change - dxi).norm() < 1e-6 * scale);
          CHECK(dn.norm() > 1e-3);
        }
      }
}

TEST_CASE("surface elements: stretch and spin are derivatives, rotation that of the polar decomposition") {
  std::mt19937 random(5);
  for (const auto type : facet_types()) {
    CAPTURE(int(type));
    const Pair pair(type, Hold::Facet, 0.1, random);
    const auto at = [&](double h) {
      return surface_point(type, Pair::moved(pair.slave, pair.slave_motion, h), pair.slave_xi).tangents;
    };
    const auto old = surface_point(type, pair.master, pair.master_xi).tangents;
    const auto here = find(pair, 0.0);
    const auto change = direction(pair, here);
    const double h = 1e-6;
    const auto area = [&](double s) { return at(s).col(0).cross(at(s).col(1)).norm(); };
    CHECK(stretch_variation(at(0.0)).dot(change.transpose()) ==
          doctest::Approx((area(h) - area(-h)) / (2.0 * h * area(0.0))).epsilon(1e-7));
    const auto rotation = surface_rotation(old, at(0.0));
    const Vector3d spin = rotation.spin * change;
    const Eigen::Matrix3d rate =
        (surface_rotation(old, at(h)).rotation - surface_rotation(old, at(-h)).rotation) / (2.0 * h);
    CHECK(spin.norm() > 1e-3);
    for (int c = 0; c < 3; ++c)
      CHECK((rate.col(c) - spin.cross(rotation.rotation.col(c))).norm() < 1e-7 * (1.0 + spin.norm()));
    CHECK((rotation.rotation.transpose() * rotation.rotation - Eigen::Matrix3d::Identity()).norm() < 1e-14);

    // Symmetric stretch in the plane: Rᵀ F maps old tangents by a symmetric matrix.
    const TangentPair back = rotation.rotation.transpose() * at(0.0);
    const Eigen::Matrix2d metric = old.transpose() * old;
    const TangentPair dual = old * metric.inverse();
    const Eigen::Matrix3d F = back * dual.transpose();
    CHECK((F - F.transpose()).norm() < 1e-13 * F.norm());

    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    CHECK((surface_rotation(old, turn * old).rotation - turn).norm() < 1e-13);
    if (element_dim(type) == 2) { // the same facet with its nodes numbered from another corner
      Eigen::Matrix2d renumbered;
      renumbered << 0.0, -1.0, 1.0, 0.0;
      const TangentPair old_too = old * renumbered, now_too = at(0.0) * renumbered;
      CHECK((surface_rotation(old_too, now_too).rotation - rotation.rotation).norm() < 1e-13);
    }
  }
}

TEST_CASE("normals of rigid shapes turn as their gradient says") {
  const RigidShape shapes[] = {
      RigidPlane{{0, 0, 0}, {0, 0.6, 0.8}}, RigidSphere{{0.1, 0.2, 0.3}, 0.5},
      RigidCylinder{{0.1, 0.2, 0.3}, {0.6, 0.0, 0.8}, 0.4},
      RigidRoundedBox{BoxPart::Punch, {0, 0, 0.7}, {0, 0, 1}, {1, 0, 0}, {0.7, 0.5}, 0.4, 0.3}};
  const std::array<double, 3> shift = {0.05, -0.02, 0.01}, direction = {0.3, -0.7, 0.5};
  for (const auto& shape : shapes) {
    CAPTURE(shape.index());
    const auto at = [&](double h) {
      std::array<double, 3> x = {0.7, -0.4, 0.6};
      for (std::size_t c = 0; c < 3; ++c)
        x[c] += h * direction[c];
      return x;
    };
    const auto gradient = normal_gradient(shape, shift, at(0.0));
    const double h = 1e-6;
    const auto plus = signed_distance(shape, shift, at(h)).normal, minus = signed_distance(shape, shift, at(-h)).normal;
    double size = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      double rate = 0.0;
      for (std::size_t j = 0; j < 3; ++j)
        rate += gradient[i][j] * direction[j];
      size += std::abs(rate);
      CHECK(std::abs(rate - (plus[i] - minus[i]) / (2.0 * h)) < 1e-8);
    }
    CHECK((size > 0.1) == !std::holds_alternative<RigidPlane>(shape));
  }
}
