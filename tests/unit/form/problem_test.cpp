// What a Problem measures convergence against: the same numbers however the cells are divided among ranks.
#include "box_mesh.hpp"
#include "form/finite_bulk.hpp"
#include "form/problem.hpp"

#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::testing;

namespace {

struct Measures {
  double force_scale, raw_norm, rounding;
};

/// Of a bent rubber block whose cells, slabs in x over the ranks, differ in size by a factor of ten; `tied`: its upper
/// side moves as one.
Measures measures(MPI_Comm comm, ElementType type, bool tied) {
  const Mesh mesh = box_mesh(comm, type, {4, 2, 2}, [](std::array<double, 3> p) -> std::array<double, 3> {
    return {10.0 * p[0] * p[0] * p[0] + 0.5 * p[0], p[1], p[2]};
  });
  const DofLayout layout(mesh, tied ? std::vector<TiedGroup>{{"y+", 1}} : std::vector<TiedGroup>{}, {});
  std::vector<std::unique_ptr<Form>> forms;
  forms.push_back(std::make_unique<FiniteBulkForm>(layout, mesh.dim == 2 ? Space::PlaneStrain : Space::Solid,
                                                   std::vector{FiniteLaw{NeoHookean{{10.0, 0.3}}}}));
  Problem problem(layout, std::move(forms), {});
  const auto u = layout.new_vector();
  std::vector<double> moved(mesh.coordinates.size());
  for (std::int32_t node = 0; node < mesh.num_local(); ++node) {
    const auto X = mesh.position(node);
    moved[std::size_t(node) * mesh.dim] = 0.01 * X[0] * X[1];
    moved[std::size_t(node) * mesh.dim + 1] = tied ? 0.0 : 0.02 * std::sin(X[0]);
  }
  layout.put_displacement(moved, u);
  const auto matrix = problem.new_matrix();
  problem.tangent(u, matrix);
  REQUIRE(problem.residual(u, layout.new_vector()));
  Measures found{.force_scale = problem.force_scale(), .raw_norm = 0.0, .rounding = problem.rounding()};
  VecNorm(problem.raw_residual(), NORM_2, &found.raw_norm);
  return found;
}

} // namespace

TEST_CASE("the scale of forces and what is rounding do not depend on how cells are divided") {
  for (const auto type : {ElementType::Quadrilateral9, ElementType::Hexahedron8})
    for (const bool tied : {false, true}) {
      CAPTURE(int(type));
      CAPTURE(tied);
      const auto divided = measures(PETSC_COMM_WORLD, type, tied), whole = measures(PETSC_COMM_SELF, type, tied);
      REQUIRE(whole.rounding > 0.0);
      CHECK(divided.force_scale == doctest::Approx(whole.force_scale).epsilon(1e-12));
      CHECK(divided.rounding == doctest::Approx(whole.rounding).epsilon(1e-12));
      // One form: the forces in play are its own.
      if (!tied) CHECK(divided.force_scale == doctest::Approx(divided.raw_norm).epsilon(1e-12));
    }
}
