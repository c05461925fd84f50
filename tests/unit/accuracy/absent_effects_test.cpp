// Sliding and motion of blocks that are known.
#include "accuracy/absent_effects.hpp"
#include "blocks.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::testing;

TEST_CASE("sliding work: pressure times the way over the master, that of a stretched block") {
  // p = 1 and |u_t| = 0.02 |x - 1/2| over a unit side: 0.02 / 4. The common approach is no sliding.
  for (const int dim : {2, 3}) {
    const Case scene = stretched_block(PETSC_COMM_WORLD, dim);
    const double work = sliding_work(scene.mesh, scene.displacement, scene.pairs[0], scene.samples[0]);
    CHECK(work == doctest::Approx(0.02 / 4).epsilon(0.05)); // a facet of the slave may reach across the middle
    const Case still = compressed_blocks(PETSC_COMM_WORLD, dim);
    CHECK(sliding_work(still.mesh, still.displacement, still.pairs[0], still.samples[0]) < 1e-14);
    // Over a rigid plane that has moved along: the motion relative to it.
    Case rigid = compressed_blocks(PETSC_COMM_WORLD, dim);
    displace(rigid, [](const auto&) -> std::array<double, 3> { return {0.03, 0.0, 0.0}; });
    std::array<double, 3> normal{};
    normal[dim - 1] = 1.0;
    rigid.pairs[0].master = MovedShape{RigidPlane{{0.0, 0.0, 0.0}, normal}, {0.01, 0.0, 0.0}, {}};
    CHECK(sliding_work(rigid.mesh, rigid.displacement, rigid.pairs[0], rigid.samples[0]) == doctest::Approx(0.02));
  }
}

TEST_CASE("motion: ½ m v² and the speed over that of waves of a block in translation") {
  const std::vector<Block> blocks = {{"lower", {0, 0, 0}, {2, 1, 1}, {3, 2, 2}},
                                     {"upper", {0, 2, 2}, {2, 3, 3}, {2, 3, 2}}};
  for (const int dim : {2, 3}) {
    const Mesh mesh = block_mesh(PETSC_COMM_WORLD, dim, blocks);
    std::vector<double> increment(std::size_t(mesh.num_local()) * dim, 0.0);
    for (std::int32_t node = 0; node < mesh.num_local(); ++node) {
      increment[std::size_t(node) * dim] = 0.3;
      increment[std::size_t(node) * dim + 1] = 0.4;
    }
    // |v| = 0.5 / 0.1 = 5; the upper body has no density and does not count.
    const Space space = dim == 2 ? Space::PlaneStrain : Space::Solid;
    const std::vector<double> density = {7.0, 0.0}, wave = {50.0, 0.0};
    const auto audit = audit_motion(mesh, space, increment, 0.1, density, wave);
    CHECK(audit.kinetic == doctest::Approx(0.5 * 7.0 * 2.0 * 25.0));
    CHECK(audit.largest_speed == doctest::Approx(0.1));
  }
  // A ring of the full turn: volume π (2² - 0²) 1.
  const Mesh ring = block_mesh(PETSC_COMM_WORLD, 2, {blocks[0]});
  std::vector<double> along(std::size_t(ring.num_local()) * 2, 0.0);
  for (std::int32_t node = 0; node < ring.num_local(); ++node)
    along[std::size_t(node) * 2 + 1] = 1.0;
  const auto audit = audit_motion(ring, Space::Axisymmetric, along, 1.0, std::vector{2.0}, std::vector{1.0});
  CHECK(audit.kinetic == doctest::Approx(4.0 * std::acos(-1.0)));
}
