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

RigidRoundedBox random_box(std::mt19937& random, BoxPart part) {
  const Eigen::Vector3d normal = random_vector(random).normalized(),
                        side = normal.cross(random_vector(random)).normalized();
  return {part, array(random_vector(random)), array(normal), array(side), {0.9, 0.6}, 0.4, 0.3};
}

std::vector<RigidShape> random_shapes(std::mt19937& random) {
  return {RigidPlane{array(random_vector(random)), array(random_vector(random).normalized())},
          RigidSphere{array(random_vector(random)), 0.7},
          RigidCylinder{array(random_vector(random)), array(random_vector(random).normalized()), 0.4},
          rounded_corner(array(random_vector(random)),
                         {array(random_vector(random).normalized()), array(random_vector(random).normalized())}, 0.3),
          random_box(random, BoxPart::Punch),
          random_box(random, BoxPart::Die)};
}

RigidShape rotated(const RigidShape& shape, const Eigen::Matrix3d& R) {
  const auto turn = [&](const std::array<double, 3>& v) { return array(R * Eigen::Vector3d(v.data())); };
  if (const auto* plane = std::get_if<RigidPlane>(&shape)) return RigidPlane{turn(plane->point), turn(plane->normal)};
  if (const auto* ball = std::get_if<RigidSphere>(&shape)) return RigidSphere{turn(ball->centre), ball->radius};
  if (const auto* corner = std::get_if<RigidCorner>(&shape))
    return RigidCorner{turn(corner->centre), {turn(corner->normals[0]), turn(corner->normals[1])}, corner->radius};
  if (const auto* box = std::get_if<RigidRoundedBox>(&shape)) {
    RigidRoundedBox moved = *box;
    moved.point = turn(box->point);
    moved.normal = turn(box->normal);
    moved.side = turn(box->side);
    return moved;
  }
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

TEST_CASE("signed_distance: a rounded box is its face, its walls, and rings around its corners") {
  RigidRoundedBox box{BoxPart::Punch, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {2.0, 1.0}, 0.5, 0.25};
  const auto gap = [&](double x, double y, double z) {
    return signed_distance(RigidShape(box), std::span<const double>(), std::array<double, 3>{x, y, z}).gap;
  };
  CHECK(gap(0.0, 0.0, 3.0) == doctest::Approx(3.0));
  CHECK(gap(-2.5, 0.0, -4.0) == doctest::Approx(0.5));
  CHECK(gap(0.2, 1.5, -4.0) == doctest::Approx(0.5));
  CHECK(gap(0.2, -0.9, -4.0) == doctest::Approx(-0.1));
  CHECK(gap(1.5 + 0.6, 0.5 + 0.8, -4.0) == doctest::Approx(0.5));    // around (1.5, 0.5)
  CHECK(gap(1.75 + 0.3, 0.0, -0.25 + 0.4) == doctest::Approx(0.25)); // the edge of a wall
  // The edge of a corner: a ring of radius 0.5 - 0.25 for a punch, 0.5 + 0.25 for a die.
  CHECK(gap(1.5 + 0.6 * 0.55, -0.5 - 0.8 * 0.55, -0.25 + 0.4) == doctest::Approx(0.25));
  box.part = BoxPart::Die;
  CHECK(gap(5.0, 0.0, 1.0) == doctest::Approx(1.0));
  CHECK(gap(1.5, 0.0, -4.0) == doctest::Approx(0.5));
  CHECK(gap(2.1, 0.0, -4.0) == doctest::Approx(-0.1));
  CHECK(gap(-2.25 + 0.3, 0.0, -0.25 + 0.4) == doctest::Approx(0.25));
  CHECK(gap(1.5 + 0.6 * 0.45, 0.5 + 0.8 * 0.45, -0.25 + 0.4) == doctest::Approx(0.25));
}

TEST_CASE("a rounded box whose corners fill it is round: the corner that is its section, turned") {
  std::mt19937 random(13);
  const std::span<const double> none;
  for (const auto part : {BoxPart::Punch, BoxPart::Die}) {
    const double s = part == BoxPart::Punch ? 1.0 : -1.0, radius = 1.2;
    const RigidShape box = RigidRoundedBox{part, {0, 0, 0.3}, {0, 0, 1}, {0.6, 0.8, 0}, {1.2, 1.2}, radius, 0.4};
    const RigidShape section = rounded_corner({radius, 0.3, 0}, {{{s, 0, 0}, {0, 1, 0}}}, 0.4);
    for (int repeat = 0; repeat < 200; ++repeat) {
      auto x = array(2.0 * random_vector(random));
      if (repeat % 4 == 1) x = {0.6 * x[0], 0.8 * x[0], x[2]}; // along `side`, where a corner begins
      const double r = std::hypot(x[0], x[1]);
      const std::array<double, 2> turned{r, x[2]};
      const auto there = signed_distance(section, none, turned);
      const auto here = signed_distance(box, none, x);
      CHECK(here.gap == doctest::Approx(there.gap).epsilon(1e-12));
      const Eigen::Vector3d radial(x[0] / r, x[1] / r, 0.0), hoop(-x[1] / r, x[0] / r, 0.0), axis(0, 0, 1);
      const Eigen::Vector3d normal = there.normal[0] * radial + there.normal[1] * axis;
      CHECK((Eigen::Vector3d(here.normal.data()) - normal).norm() < 1e-12);
      // Turned, the normal of the section also turns along the hoop, by its radial part over r.
      const auto plane = normal_gradient(section, none, turned);
      const auto gradient = normal_gradient(box, none, x);
      const Eigen::Matrix3d expected = plane[0][0] * radial * radial.transpose() +
                                       plane[0][1] * (radial * axis.transpose() + axis * radial.transpose()) +
                                       plane[1][1] * axis * axis.transpose() +
                                       there.normal[0] / r * hoop * hoop.transpose();
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          CHECK(std::abs(gradient[i][j] - expected(i, j)) < 1e-10 * (1.0 + expected.norm()));
    }
  }
  // On the axis, where the distance from the walls has no gradient.
  const RigidShape punch = RigidRoundedBox{BoxPart::Punch, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1}, 1.0, 0.4};
  const std::array<double, 3> middle{0, 0, 0.5}, deep{0, 0, -3};
  CHECK(signed_distance(punch, none, middle).gap == doctest::Approx(0.5));
  CHECK(signed_distance(punch, none, middle).normal[2] == 1.0);
  const auto inside = signed_distance(punch, none, deep);
  CHECK(inside.gap == doctest::Approx(-1.0));
  CHECK(Eigen::Vector3d(inside.normal.data()).norm() == doctest::Approx(1.0));
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
