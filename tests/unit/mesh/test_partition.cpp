// The METIS partitioner and its knowledge of interfaces.
#include "mesh_support.hpp"

#include "base/error.hpp"
#include "mesh/contact_pairs.hpp"
#include "mesh/partitioner.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

using namespace amontons;
using namespace amontons::test;

namespace {

/// Two strips 1 high with a gap of 0.05, 40 and 41 long, of 2 x 80 cells each: a cut along the gap and one across
/// both give two ranks half of the cells.
const std::string strips =
    "For k In {0:1}\n"
    "  y = k * 1.05; p = 10 * k;\n"
    "  Point(p + 1) = {-k / 2, y, 0}; Point(p + 2) = {40 + k / 2, y, 0}; Line(p + 1) = {p + 1, p + 2};\n"
    "  Transfinite Curve{p + 1} = 81;\n"
    "  s~{k}[] = Extrude{0, 1, 0}{ Curve{p + 1}; Layers{2}; Recombine; };\n"
    "EndFor\n"
    "Physical Surface(\"lower\") = {s~{0}[1]}; Physical Surface(\"upper\") = {s~{1}[1]};\n"
    "Physical Curve(\"slave\") = {s~{0}[0]}; Physical Curve(\"master\") = {11};\n";

/// Where along x facets of a surface lie on this rank, rounded to `width`.
std::set<long> stations(const Mesh& mesh, const std::string& surface, double width) {
  std::set<long> found;
  const auto& facets = mesh.surfaces.at(surface);
  for (std::int32_t f = 0; f < facets.size(); ++f) {
    const auto nodes = facets.facet(f);
    found.insert(std::lround((mesh.position(nodes[0])[0] + mesh.position(nodes[1])[0]) / 2 / width));
  }
  return found;
}

} // namespace

TEST_CASE("metis is the default partitioner and balances the cells") {
  const auto mesh = mesh_from_geo(strips, 1);
  std::int64_t cells = 0;
  for (const auto& block : mesh.blocks)
    cells += block.size();
  const auto all = sum_over_ranks(cells);
  REQUIRE(all == 2 * 160);
  int ranks = 1;
  MPI_Comm_size(mesh.comm, &ranks);
  CHECK(std::abs(double(cells) * ranks / double(all) - 1.0) < 0.05);
}

TEST_CASE("both sides of an interface share a rank") {
  int ranks = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  const auto mesh = mesh_from_geo(strips, 1, 0, {}, {{"slave", "master"}});
  // Stations 2 wide (4 facets or so): this rank has both sides of all but those where it ends.
  const auto slave = stations(mesh, "slave", 2.0), master = stations(mesh, "master", 2.0);
  std::set<long> one_sided;
  std::set_symmetric_difference(slave.begin(), slave.end(), master.begin(), master.end(),
                                std::inserter(one_sided, one_sided.end()));
  CHECK(!slave.empty());
  CHECK(one_sided.size() <= 2);
  if (ranks == 2) { // what the hint is for: without it the gap is the cheapest cut
    const auto unaware = mesh_from_geo(strips, 1);
    const bool both = unaware.surfaces.at("slave").size() > 8 && unaware.surfaces.at("master").size() > 8;
    CHECK_FALSE(both);
  }
}

TEST_CASE("facing cells are found across a gap, and nowhere else") {
  RawMesh raw;
  on_root(PETSC_COMM_WORLD, [&] { raw = raw_from_geo(strips, 1); });
  if (raw.num_cells() == 0) return; // not the root
  const auto pairs = facing_cells(raw, {{"slave", "master"}});
  CHECK(pairs.size() == 80 + 80);
  for (const auto& [a, b] : pairs) {
    CHECK(raw.cell_bodies[a] != raw.cell_bodies[b]);
    const double x_a = raw.coordinates[3 * raw.cell_nodes[raw.cell_offsets[a]]];
    const double x_b = raw.coordinates[3 * raw.cell_nodes[raw.cell_offsets[b]]];
    CHECK(std::abs(x_a - x_b) <= 1.1);
  }
  CHECK(facing_cells(raw, {{"slave", "absent"}}).empty());
}

TEST_CASE("another partitioner can be chosen on the command line") {
  AMT_PETSC(PetscOptionsSetValue(nullptr, "-petscpartitioner_type", "simple"));
  const auto mesh = mesh_from_geo(strips, 1, 0, {}, {{"slave", "master"}});
  AMT_PETSC(PetscOptionsClearValue(nullptr, "-petscpartitioner_type"));
  CHECK(volume(mesh, -1) == doctest::Approx(81.0));
  CHECK(sum_over_ranks(std::int64_t(mesh.num_owned)) == mesh.num_global);
}
