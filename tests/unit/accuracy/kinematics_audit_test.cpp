// What small kinematics leave out, of motions whose strains are known.
#include "../form/dense_system.hpp"
#include "accuracy/kinematics_audit.hpp"

#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::testing;

namespace {

KinematicsAudit audit(ElementType type, Space space, const Field& field) {
  const Mesh mesh = box_mesh(PETSC_COMM_WORLD, type, {3, 3, 3}, [](auto p) -> std::array<double, 3> {
    return {1 + p[0], p[1], p[2]};
  });
  const Eigen::VectorXd u = nodal_values(mesh, field);
  return audit_kinematics(mesh, space, {u.data(), std::size_t(u.size())});
}

} // namespace

TEST_CASE("kinematics audit: small rotation w x X has no strain, and ½ Hᵀ H of norm w² / √2") {
  const double w = 0.1;
  const Field turn = [w](auto x) -> std::array<double, 3> { return {-w * x[1], w * x[0], 0}; };
  for (const auto& [type, space] :
       {std::pair{ElementType::Triangle6, Space::PlaneStrain},
        std::pair{ElementType::Quadrilateral4, Space::PlaneStress}, std::pair{ElementType::Tetrahedron4, Space::Solid},
        std::pair{ElementType::Hexahedron27, Space::Solid}}) {
    const auto found = audit(type, space, turn);
    CHECK(found.rotation == doctest::Approx(w));
    CHECK(found.strain < 1e-12);
    CHECK(found.neglected == doctest::Approx(0.5 * w * w * std::sqrt(2.0))); // Hᵀ H = w² in two directions
  }
}

TEST_CASE("kinematics audit: stretch by e leaves out ½ e², relative to the strain ½ e") {
  const double e = 0.02;
  const auto plane = audit(ElementType::Quadrilateral9, Space::PlaneStrain, [e](auto x) -> std::array<double, 3> {
    return {e * x[0], 0, 0};
  });
  CHECK(plane.rotation < 1e-12);
  CHECK(plane.strain == doctest::Approx(e));
  CHECK(plane.ratio() == doctest::Approx(0.5 * e));
  // Axisymmetric: radial and hoop strain e.
  const auto ring = audit(ElementType::Triangle3, Space::Axisymmetric, [e](auto x) -> std::array<double, 3> {
    return {e * x[0], 0, 0};
  });
  CHECK(ring.strain == doctest::Approx(e * std::sqrt(2.0)));
  CHECK(ring.neglected == doctest::Approx(0.5 * e * e * std::sqrt(2.0)));
}

TEST_CASE("kinematics audit: nothing moves") {
  CHECK(audit(ElementType::Hexahedron8, Space::Solid, [](auto) { return std::array<double, 3>{}; }).ratio() == 0.0);
}
