// Size fields against the definition, and gmsh's obedience to them.
#include "mesh_support.hpp"

#include "base/error.hpp"
#include "mesh/size_field.hpp"

#include <algorithm>
#include <cmath>
#include <random>

using namespace amontons;
using namespace amontons::test;

namespace {

std::vector<SizeSample> random_samples(std::size_t count, int dim) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<SizeSample> samples(count);
  for (auto& sample : samples) {
    for (int c = 0; c < dim; ++c)
      sample.place[c] = uniform(generator);
    sample.radius = 0.02 * uniform(generator);
    sample.size = 0.01 * std::exp(3.0 * uniform(generator));
  }
  return samples;
}

/// The blocks of hertz_2d: partly transfinite quadrilaterals, with a background field of the script's own.
MeshSource hertz_2d(double h) {
  return {.file = AMONTONS_SOURCE_DIR "/inputs/hertz_2d/hertz_2d.geo",
          .parameters = {{"h", h}},
          .order = {},
          .free = FreeMeshing{}};
}

bool only(const RawMesh& raw, ElementType type) {
  return std::all_of(raw.cell_types.begin(), raw.cell_types.end(), [type](ElementType other) { return other == type; });
}

} // namespace

TEST_CASE("size field: the least of all samples with their slopes, also far outside") {
  for (const int dim : {2, 3}) {
    const auto samples = random_samples(500, dim);
    const double growth = 0.3;
    const SizeField field(samples, growth);
    std::mt19937 generator(11);
    std::uniform_real_distribution<double> uniform(-1.0, 2.0);
    for (int i = 0; i < 200; ++i) {
      const std::array<double, 3> x = {uniform(generator), uniform(generator), dim == 3 ? uniform(generator) : 0.0};
      double least = 1e300;
      for (const auto& s : samples)
        least = std::min(
            least, s.size + growth * std::max(0.0, std::hypot(x[0] - s.place[0], x[1] - s.place[1], x[2] - s.place[2]) -
                                                       s.radius));
      CHECK(field(x) == doctest::Approx(least).epsilon(1e-14));
    }
  }
}

TEST_CASE("free meshing: the script's groups and sizes, without its quadrilaterals") {
  auto source = hertz_2d(0.5);
  source.free.reset();
  const auto scripted = read_mesh(source);
  CHECK_FALSE(only(scripted, ElementType::Triangle3));
  const auto free = read_mesh(hertz_2d(0.5));
  CHECK(only(free, ElementType::Triangle3));
  CHECK(free.group_names(-1) == scripted.group_names(-1));
  // A quadrilateral of edge h counts as much area as 4 / √3 triangles of edge h; the sizes of both meshes are alike.
  CHECK(double(free.num_cells()) > 0.6 * double(scripted.num_cells()));
  CHECK(double(free.num_cells()) < 2.4 * double(scripted.num_cells()));
  const auto second = hertz_2d(0.5);
  CHECK(read_mesh(second).cell_nodes == free.cell_nodes); // no chance in it
}

TEST_CASE("free meshing: cells have the size asked for, in two and three dimensions") {
  // Everywhere 2.5: as many triangles as equilateral ones fill the area, a quarter disc and a square of side 50.
  auto source = hertz_2d(0.5);
  const auto constant = [](double size) {
    return std::make_shared<const SizeField>(std::vector<SizeSample>{{.place = {}, .radius = 1e6, .size = size}}, 0.3);
  };
  source.free->sizes = constant(2.5);
  const double area = (1.0 + std::acos(-1.0) / 4.0) * 2500.0;
  const double expected = area / (std::sqrt(3.0) / 4.0 * 2.5 * 2.5);
  const auto plane = read_mesh(source);
  CHECK(only(plane, ElementType::Triangle3));
  CHECK(std::abs(double(plane.num_cells()) / expected - 1.0) < 0.2);
  // Fine at one place: there cells are small, far away they are not.
  source.free->sizes =
      std::make_shared<const SizeField>(std::vector<SizeSample>{{.place = {}, .radius = 0.2, .size = 0.1}}, 0.4);
  const auto graded = read_mesh(source);
  double shortest = 1e300, longest = 0.0;
  for (std::size_t c = 0; c < graded.cell_types.size(); ++c) {
    const auto* nodes = &graded.cell_nodes[3 * c];
    const auto place = [&](int a) { return &graded.coordinates[3 * nodes[a]]; };
    const double edge = std::hypot(place(0)[0] - place(1)[0], place(0)[1] - place(1)[1]);
    shortest = std::min(shortest, edge);
    longest = std::max(longest, edge);
  }
  CHECK(shortest > 0.04);
  CHECK(shortest < 0.12);
  CHECK(longest > 5.0);
  // Extruded pieces of hexahedra become tetrahedra.
  MeshSource solid{.file = AMONTONS_SOURCE_DIR "/inputs/mindlin_sphere_cycling/mindlin_sphere_cycling.geo",
                   .parameters = {},
                   .order = {},
                   .free = FreeMeshing{constant(0.6)}};
  const auto cells = read_mesh(solid);
  CHECK(only(cells, ElementType::Tetrahedron4));
  CHECK(double(cells.num_cells()) > 0.5 * 5.0 * 2.5 * 2.5 / (std::pow(0.6, 3) / (6.0 * std::sqrt(2.0))));
}

TEST_CASE("free meshing: a .msh file is refused") {
  std::string message;
  try {
    read_mesh({.file = AMONTONS_SOURCE_DIR "/tests/refused/meshes/blocks.msh",
               .parameters = {},
               .order = {},
               .free = FreeMeshing{}});
  } catch (const UserError& error) {
    message = error.what();
  }
  CHECK(message.find("has no geometry. Give the .geo file") != std::string::npos);
}
