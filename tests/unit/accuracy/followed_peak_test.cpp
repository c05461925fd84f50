// A parabolic pressure on the flat side of a block of equal cells, given at the nodes as its projection in L2 onto
// functions that are linear on facets: λ(x_i) = p(x_i) + h² |p''| / 12, so that is what the peak is off.
#include "accuracy/followed_peak.hpp"
#include "blocks.hpp"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <mpi.h>

using namespace amontons;
using namespace amontons::testing;

namespace {

constexpr int cells = 12;
constexpr double h = 1.0 / cells;

/// The estimate for p = height − ½ bend (x − middle)² on the top of a unit square, projected.
double deviation(double height, double bend, double slope, double middle) {
  const Mesh mesh = block_mesh(PETSC_COMM_WORLD, 2, {{"block", {0, 0, 0}, {1, 1, 0}, {cells, 2, 1}}});
  const FacetSet& slave = mesh.surfaces.at("block_top");
  const ContactSamples samples = uniform_samples(mesh, "block_top", 1.0, {0, 1, 0});
  std::vector<double> nodal(mesh.num_local(), 0.0);
  for (const auto node : slave.nodes) {
    const double x = mesh.position(node)[0] - middle;
    nodal[node] = height + slope * x - 0.5 * bend * x * x + bend * h * h / 12.0;
  }
  return peak_deviation(mesh, slave, samples, nodal);
}

} // namespace

TEST_CASE("followed peak: what the projection of a parabola is off at its top") {
  const double exact = 2.0 * h * h / 12.0, peak = 1.0 + exact;
  const double found = deviation(1.0, 2.0, 0.0, 0.5);
  // The quadratic is fitted through kinks: good to a fifth, as the bound on the term need be.
  CHECK(found == doctest::Approx(exact / peak).epsilon(0.2));
  // A peak on the rim of the surface, as on a plane of symmetry, is seen from one side.
  CHECK(deviation(1.0, 2.0, 0.0, 0.0) == doctest::Approx(exact / peak).epsilon(0.2));
  // Linear in the curvature, and no matter in which unit the pressure is.
  CHECK(deviation(1e6, 2e6, 0.0, 0.5) == doctest::Approx(found));
  CHECK(deviation(1.0, 4.0, 0.0, 0.5) * (1.0 + 2.0 * exact) == doctest::Approx(2.0 * found * peak));
}

TEST_CASE("followed peak: nothing where the pressure is linear, or where nothing presses") {
  CHECK(deviation(1.0, 0.0, 0.0, 0.5) < 1e-12);
  CHECK(deviation(1.0, 0.0, 0.3, 0.5) < 1e-12);
  CHECK(deviation(0.0, 0.0, 0.0, 0.5) == 0.0);
}
