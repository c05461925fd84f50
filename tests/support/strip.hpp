// A straight strip of equal quadrilaterals or hexahedra of order 1 or 2, to be bent onto itself: length along x,
// thickness along the last coordinate, in 3D with a width along y. Made without gmsh.
#pragma once

#include "math/reference_element.hpp"
#include "mesh/build.hpp"

#include <array>
#include <cmath>

namespace amontons::test {

struct Strip {
  int dim = 2, order = 1;
  std::array<int, 3> cells = {24, 1, 1}; // along length, width (1 in 2D) and thickness
  std::array<double, 3> size = {4.0, 0.3, 0.1};
};

/// One body and no surface group: the skin is Mesh::exterior. Complete on rank 0, empty elsewhere.
inline RawMesh strip(MPI_Comm comm, const Strip& s) {
  RawMesh raw;
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  if (rank != 0) return raw;
  raw.dim = s.dim;
  raw.order = s.order;
  raw.groups = {{"strip", s.dim, 0}};
  using Lattice = std::array<int, 3>;
  Lattice steps; // of the lattice of nodes
  for (int c = 0; c < 3; ++c)
    steps[c] = s.dim == 2 && c == 1 ? 0 : s.cells[c] * s.order;
  const auto place = [&](int c, int step) { return steps[c] == 0 ? 0.0 : s.size[c] * step / steps[c]; };
  for (int k = 0; k <= steps[2]; ++k)
    for (int j = 0; j <= steps[1]; ++j)
      for (int i = 0; i <= steps[0]; ++i) {
        const double x = place(0, i), y = place(1, j), z = place(2, k);
        if (s.dim == 2)
          raw.coordinates.insert(raw.coordinates.end(), {x, z, 0.0});
        else
          raw.coordinates.insert(raw.coordinates.end(), {x, y, z});
      }
  const auto cell = s.dim == 2 ? (s.order == 1 ? ElementType::Quadrilateral4 : ElementType::Quadrilateral9)
                               : (s.order == 1 ? ElementType::Hexahedron8 : ElementType::Hexahedron27);
  const auto reference = reference_nodes(cell);
  for (int k = 0; k < steps[2]; k += s.order)
    for (int j = 0; j < (s.dim == 2 ? 1 : steps[1]); j += s.order)
      for (int i = 0; i < steps[0]; i += s.order) {
        raw.cell_types.push_back(cell);
        for (int a = 0; a < num_nodes(cell); ++a) {
          Lattice at = {i, j, k};
          for (int c = 0; c < s.dim; ++c)
            at[s.dim == 2 ? 2 * c : c] += int(std::lround(0.5 * s.order * (reference[a * s.dim + c] + 1.0)));
          raw.cell_nodes.push_back((std::int64_t(at[2]) * (steps[1] + 1) + at[1]) * (steps[0] + 1) + at[0]);
        }
        raw.cell_offsets.push_back(static_cast<std::int64_t>(raw.cell_nodes.size()));
        raw.cell_bodies.push_back(0);
        ++raw.groups[0].num_elements;
      }
  return raw;
}

} // namespace amontons::test
