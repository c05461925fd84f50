// Two unit blocks (squares or cubes) one above the other, meshed by n_lower and n_upper equal quadrilaterals or
// hexahedra a side, with a gap between them: the smallest scene with a non-matching interface, made without gmsh.
#pragma once

#include "mesh/build.hpp"

#include <cmath>

namespace amontons::test {

inline void add_block(RawMesh& raw, int n, double floor, std::int32_t body, std::int32_t bottom, std::int32_t top) {
  const int d = raw.dim;
  const auto first = static_cast<std::int64_t>(raw.coordinates.size() / 3);
  const int layers = d == 3 ? n + 1 : 1;
  // Vertical is the last coordinate of the dimension: y in 2D, z in 3D.
  for (int k = 0; k < layers; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const double x = double(i) / n, y = double(j) / n, z = double(k) / n;
        if (d == 2)
          raw.coordinates.insert(raw.coordinates.end(), {x, floor + y, 0.0});
        else
          raw.coordinates.insert(raw.coordinates.end(), {x, y, floor + z});
      }
  const auto node = [&](int i, int j, int k) { return first + (std::int64_t(k) * (n + 1) + j) * (n + 1) + i; };
  const auto sub = [&](std::vector<std::int64_t> nodes, std::int32_t group) {
    raw.subs.push_back({std::move(nodes), d == 2 ? ElementType::Segment2 : ElementType::Quadrilateral4, group});
    ++raw.groups[group].num_elements;
  };
  for (int k = 0; k < (d == 3 ? n : 1); ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        raw.cell_types.push_back(d == 2 ? ElementType::Quadrilateral4 : ElementType::Hexahedron8);
        for (int up = 0; up <= (d == 3 ? 1 : 0); ++up)
          raw.cell_nodes.insert(raw.cell_nodes.end(), {node(i, j, k + up), node(i + 1, j, k + up),
                                                       node(i + 1, j + 1, k + up), node(i, j + 1, k + up)});
        raw.cell_offsets.push_back(static_cast<std::int64_t>(raw.cell_nodes.size()));
        raw.cell_bodies.push_back(body);
        ++raw.groups[body].num_elements;
      }
  for (int i = 0; i < n; ++i) {
    if (d == 2) {
      sub({node(i, 0, 0), node(i + 1, 0, 0)}, bottom);
      sub({node(i + 1, n, 0), node(i, n, 0)}, top);
      continue;
    }
    for (int j = 0; j < n; ++j) {
      sub({node(i, j, 0), node(i, j + 1, 0), node(i + 1, j + 1, 0), node(i + 1, j, 0)}, bottom);
      sub({node(i, j, n), node(i + 1, j, n), node(i + 1, j + 1, n), node(i, j + 1, n)}, top);
    }
  }
}

/// Groups: bodies lower, upper; surfaces bottom, lower_top, upper_bottom, top. Complete on rank 0, empty elsewhere.
inline RawMesh two_blocks(MPI_Comm comm, int dim, int n_lower, int n_upper, double gap) {
  RawMesh raw;
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  if (rank != 0) return raw;
  raw.dim = dim;
  raw.order = 1;
  raw.groups = {{"lower", dim, 0},
                {"upper", dim, 0},
                {"bottom", dim - 1, 0},
                {"lower_top", dim - 1, 0},
                {"upper_bottom", dim - 1, 0},
                {"top", dim - 1, 0}};
  add_block(raw, n_lower, 0.0, 0, 2, 3);
  add_block(raw, n_upper, 1.0 + gap, 1, 4, 5);
  return raw;
}

inline Mesh two_blocks_mesh(MPI_Comm comm, int dim, int n_lower, int n_upper, double gap) {
  return distribute_mesh(comm, two_blocks(comm, dim, n_lower, n_upper, gap), {{"upper_bottom", "lower_top"}}, 0);
}

} // namespace amontons::test
