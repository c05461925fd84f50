// Signed distances: the gradient is the normal, rotation and translation change nothing, values in closed form.
#include "geometry/rigid_shape.hpp"

#include <Eigen/Geometry>
#include <doctest/doctest.h>
#include <random>

using namespace amontons;

namespace {

std::array<double, 3> array(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }

Eigen::Vector3d random_vector(std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const double x = number(random), y = number(random), z = number(random);
  return {x, y, z};
}

std::vector<RigidShape> random_shapes(std::mt19937& random) {
  return {RigidPlane{array(random_vector(random)), array(random_vector(random).normalized())},
          RigidSphere{array(random_vector(random)), 0.7},
          RigidCylinder{array(random_vector(random)), array(random_vector(random).normalized()), 0.4},
          rounded_corner(array(random_vector(random)),
                         {array(random_vector(random).normalized()), array(random_vector(random).normalized())}, 0.3)};
}

RigidShape rotated(const RigidShape& shape, const Eigen::Matrix3d& R) {
  const auto turn = [&](const std::array<double, 3>& v) { return array(R * Eigen::Vector3d(v.data())); };
  if (const auto* plane = std::get_if<RigidPlane>(&shape)) return RigidPlane{turn(plane->point), turn(plane->normal)};
  if (const auto* ball = std::get_if<RigidSphere>(&shape)) return RigidSphere{turn(ball->centre), ball->radius};
  if (const auto* corner = std::get_if<RigidCorner>(&shape))
    return RigidCorner{turn(corner->centre), {turn(corner->normals[0]), turn(corner->normals[1])}, corner->radius};
  const auto& cylinder = std::get<RigidCylinder>(shape);
  return RigidCylinder{turn(cylinder.centre), turn(cylinder.axis), cylinder.radius};
}

} // namespace

TEST_CASE("signed_distance: the gradient is the unit normal") {
  std::mt19937 random(10);
  for (int repeat = 0; repeat < 50; ++repeat)
    for (const RigidShape& shape : random_shapes(random)) {
      const Eigen::Vector3d x = 2.0 * random_vector(random), shift = random_vector(random);
      const auto here = signed_distance(shape, std::span(shift.data(), 3), std::span(x.data(), 3));
      CHECK(Eigen::Vector3d(here.normal.data()).norm() == doctest::Approx(1.0));
      for (int i = 0; i < 3; ++i) {
        Eigen::Vector3d ahead = x, behind = x;
        ahead[i] += 1e-5;
        behind[i] -= 1e-5;
        const double slope = (signed_distance(shape, std::span(shift.data(), 3), std::span(ahead.data(), 3)).gap -
                              signed_distance(shape, std::span(shift.data(), 3), std::span(behind.data(), 3)).gap) /
                             2e-5;
        CHECK(std::abs(slope - here.normal[i]) < 1e-6);
      }
    }
}

TEST_CASE("signed_distance: moves and turns with the shape") {
  std::mt19937 random(11);
  for (int repeat = 0; repeat < 50; ++repeat)
    for (const RigidShape& shape : random_shapes(random)) {
      const Eigen::Matrix3d R =
          Eigen::AngleAxisd(3.0 * random_vector(random)[0], random_vector(random).normalized()).toRotationMatrix();
      const Eigen::Vector3d x = random_vector(random), shift = random_vector(random);
      const Eigen::Vector3d moved = R * (x + shift), turned_shift = R * shift, none(0, 0, 0);
      const auto here = signed_distance(shape, std::span(none.data(), 3), std::span(x.data(), 3));
      const auto there =
          signed_distance(rotated(shape, R), std::span(turned_shift.data(), 3), std::span(moved.data(), 3));
      CHECK(there.gap == doctest::Approx(here.gap).epsilon(1e-12));
      CHECK((Eigen::Vector3d(there.normal.data()) - R * Eigen::Vector3d(here.normal.data())).norm() < 1e-12);
    }
}

TEST_CASE("signed_distance: closed forms, two coordinates, and points where the normal does not exist") {
  const std::array<double, 2> shift{0.0, -1.0}, x{3.0, 3.0};
  const auto disc = signed_distance(RigidSphere{{0, 0, 0}, 2.0}, shift, x);
  CHECK(disc.gap == doctest::Approx(3.0));
  CHECK(disc.normal[0] == doctest::Approx(0.6));
  CHECK(disc.normal[1] == doctest::Approx(0.8));
  CHECK(disc.normal[2] == 0.0);
  CHECK(signed_distance(RigidPlane{{0, 1, 0}, {0, 1, 0}}, shift, x).gap == doctest::Approx(3.0));
  const std::array<double, 3> axis_point{0, 0, 5}, none{};
  CHECK(signed_distance(RigidSphere{{0, 0, 5}, 2.0}, none, axis_point).gap == doctest::Approx(-2.0));
  const auto inside = signed_distance(RigidCylinder{{0, 0, 0}, {0, 0, 1}, 2.0}, none, axis_point);
  CHECK(inside.gap == doctest::Approx(-2.0));
  CHECK(inside.normal[2] == 0.0);
  CHECK(Eigen::Vector3d(inside.normal.data()).norm() == doctest::Approx(1.0));
}

TEST_CASE("signed_distance: a rounded corner is its faces, and a circle between them") {
  // The quadrant x < 2, y < 1 with its corner rounded by 0.5: the circle around (1.5, 0.5).
  const RigidShape die = rounded_corner({2, 1, 0}, {{{1, 0, 0}, {0, 1, 0}}}, 0.5);
  const std::array<double, 2> none{};
  const auto at = [&](double x, double y) { return signed_distance(die, none, std::array<double, 2>{x, y}); };
  CHECK(at(0.0, 3.0).gap == doctest::Approx(2.0));
  CHECK(at(0.0, 3.0).normal[1] == 1.0);
  CHECK(at(2.25, -4.0).gap == doctest::Approx(0.25));
  CHECK(at(2.25, -4.0).normal[0] == 1.0);
  CHECK(at(1.5 + 0.6, 0.5 + 0.8).gap == doctest::Approx(0.5));
  CHECK(at(1.5 + 0.6, 0.5 + 0.8).normal[0] == doctest::Approx(0.6));
  CHECK(at(2.0, 1.0).gap == doctest::Approx(0.5 * (std::sqrt(2.0) - 1.0)));
  CHECK(at(1.9, -1.0).gap == doctest::Approx(-0.1));
  // An obtuse corner: faces y = 0 and that through the origin with the normal (sin 30, cos 30).
  const RigidShape bend = rounded_corner({0, 0, 0}, {{{0, 1, 0}, {0.5, std::sqrt(0.75), 0}}}, 3.0);
  const double cut = 3.0 * std::tan(std::acos(-1.0) / 12.0); // from the apex to where the rounding begins
  CHECK(signed_distance(bend, none, std::array<double, 2>{-cut, 0.0}).gap == doctest::Approx(0.0));
  CHECK(signed_distance(bend, none, std::array<double, 2>{0.0, 0.0}).gap ==
        doctest::Approx(3.0 / std::cos(std::acos(-1.0) / 12.0) - 3.0));
}

TEST_CASE("normal_gradient: the normal's derivative") {
  std::mt19937 random(12);
  double largest = 0.0;
  for (int repeat = 0; repeat < 50; ++repeat)
    for (const RigidShape& shape : random_shapes(random)) {
      const Eigen::Vector3d x = 2.0 * random_vector(random), none(0, 0, 0);
      const auto gradient = normal_gradient(shape, std::span(none.data(), 3), std::span(x.data(), 3));
      for (int j = 0; j < 3; ++j) {
        Eigen::Vector3d ahead = x, behind = x;
        ahead[j] += 1e-5;
        behind[j] -= 1e-5;
        const auto after = signed_distance(shape, std::span(none.data(), 3), std::span(ahead.data(), 3)).normal;
        const auto before = signed_distance(shape, std::span(none.data(), 3), std::span(behind.data(), 3)).normal;
        for (int i = 0; i < 3; ++i) {
          CHECK(std::abs((after[i] - before[i]) / 2e-5 - gradient[i][j]) < 1e-6 * (1.0 + std::abs(gradient[i][j])));
          largest = std::max(largest, std::abs(gradient[i][j]));
        }
      }
    }
  CHECK(largest > 1.0);
}
