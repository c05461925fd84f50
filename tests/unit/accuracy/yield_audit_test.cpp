// Von Mises over yield of a uniform state, and the volumes of bodies.
#include "../form/dense_system.hpp"
#include "accuracy/absent_effects.hpp"
#include "form/bulk.hpp"
#include "material/elastic.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::testing;

TEST_CASE("yield audit: shear γ has the von Mises stress √3 G γ, on every rank") {
  const Elastic material{100.0, 0.25}; // G = 40
  for (const auto& [type, space] : {std::pair{ElementType::Triangle6, Space::PlaneStrain},
                                    std::pair{ElementType::Quadrilateral4, Space::PlaneStress},
                                    std::pair{ElementType::Hexahedron8, Space::Solid}}) {
    const Mesh mesh = box_mesh(PETSC_COMM_WORLD, type, {3, 2, 2}, [](auto p) -> std::array<double, 3> {
      return {2.0 * p[0], p[1], p[2]};
    });
    const DofLayout layout(mesh, {}, {});
    BulkForm solid(layout, space, {material});
    const Eigen::VectorXd u = nodal_values(mesh, [](auto x) -> std::array<double, 3> {
      return {0.01 * x[1], 0.0, 0.0};
    });
    const auto audit = audit_yield(solid, mesh, state_of(u), std::vector{0.5});
    CHECK(audit.ratio == doctest::Approx(std::sqrt(3.0) * 40.0 * 0.01 / 0.5));
    CHECK(audit.body == 0);
    CHECK(audit_yield(solid, mesh, state_of(u), std::vector{0.0}).ratio == 0.0); // no yield stress known
    CHECK(body_volumes(solid, mesh, state_of(u)).at(0) == doctest::Approx(2.0));
  }
}
