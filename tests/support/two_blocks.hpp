// Two unit blocks (squares or cubes) one above the other, meshed by n_lower and n_upper equal quadrilaterals or
// hexahedra of order 1 or 2 a side, with a gap between them: the smallest scene with a non-matching interface, made
// without gmsh.
#pragma once

#include "math/reference_element.hpp"
#include "mesh/build.hpp"

#include <array>
#include <cmath>
#include <vector>

namespace amontons::test {

inline void add_block(RawMesh& raw, int n, double floor, std::int32_t body, std::int32_t bottom, std::int32_t top) {
  const int d = raw.dim, order = raw.order, m = n * order; // m: steps of the lattice of nodes
  const auto first = static_cast<std::int64_t>(raw.coordinates.size() / 3);
  // Vertical is the last coordinate of the dimension: y in 2D, z in 3D.
  for (int k = 0; k <= (d == 3 ? m : 0); ++k)
    for (int j = 0; j <= m; ++j)
      for (int i = 0; i <= m; ++i) {
        const double x = double(i) / m, y = double(j) / m, z = double(k) / m;
        if (d == 2)
          raw.coordinates.insert(raw.coordinates.end(), {x, floor + y, 0.0});
        else
          raw.coordinates.insert(raw.coordinates.end(), {x, y, floor + z});
      }
  using Lattice = std::array<int, 3>;
  const auto node = [&](const Lattice& at) {
    return first + (std::int64_t(at[2]) * (m + 1) + at[1]) * (m + 1) + at[0];
  };
  /// Nodes of an element that begins at `origin` and whose reference directions run along `ways`.
  const auto nodes_of = [&](ElementType type, const Lattice& origin, const std::vector<Lattice>& ways) {
    std::vector<std::int64_t> nodes;
    const auto reference = reference_nodes(type);
    for (std::size_t a = 0; a < std::size_t(num_nodes(type)); ++a) {
      Lattice at = origin;
      for (std::size_t w = 0; w < ways.size(); ++w)
        for (std::size_t c = 0; c < 3; ++c)
          at[c] += ways[w][c] * int(std::lround(0.5 * order * (reference[a * ways.size() + w] + 1.0)));
      nodes.push_back(node(at));
    }
    return nodes;
  };
  const auto cell = d == 2 ? (order == 1 ? ElementType::Quadrilateral4 : ElementType::Quadrilateral9)
                           : (order == 1 ? ElementType::Hexahedron8 : ElementType::Hexahedron27);
  const auto face = d == 2 ? (order == 1 ? ElementType::Segment2 : ElementType::Segment3)
                           : (order == 1 ? ElementType::Quadrilateral4 : ElementType::Quadrilateral9);
  const Lattice x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1};
  const auto sub = [&](const Lattice& origin, const std::vector<Lattice>& ways, std::int32_t group) {
    raw.subs.push_back({nodes_of(face, origin, ways), face, group});
    ++raw.groups[group].num_elements;
  };
  for (int k = 0; k < (d == 3 ? m : 1); k += order)
    for (int j = 0; j < m; j += order)
      for (int i = 0; i < m; i += order) {
        raw.cell_types.push_back(cell);
        const auto nodes = nodes_of(cell, {i, j, k}, d == 2 ? std::vector{x, y} : std::vector{x, y, z});
        raw.cell_nodes.insert(raw.cell_nodes.end(), nodes.begin(), nodes.end());
        raw.cell_offsets.push_back(static_cast<std::int64_t>(raw.cell_nodes.size()));
        raw.cell_bodies.push_back(body);
        ++raw.groups[body].num_elements;
      }
  for (int i = 0; i < m; i += order) {
    if (d == 2) {
      sub({i, 0, 0}, {x}, bottom);
      sub({i, m, 0}, {x}, top);
      continue;
    }
    for (int j = 0; j < m; j += order) {
      sub({i, j, 0}, {x, y}, bottom);
      sub({i, j, m}, {x, y}, top);
    }
  }
}

/// Groups: bodies lower, upper; surfaces bottom, lower_top, upper_bottom, top. Complete on rank 0, empty elsewhere.
inline RawMesh two_blocks(MPI_Comm comm, int dim, int n_lower, int n_upper, double gap, int order = 1) {
  RawMesh raw;
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  if (rank != 0) return raw;
  raw.dim = dim;
  raw.order = order;
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

inline Mesh two_blocks_mesh(MPI_Comm comm, int dim, int n_lower, int n_upper, double gap, int order = 1) {
  return distribute_mesh(comm, two_blocks(comm, dim, n_lower, n_upper, gap, order), {{"upper_bottom", "lower_top"}}, 0);
}

/// The upper block's bottom is round (or its middle, in 3D, along both directions).
inline Mesh round_on_flat(int dim, int n) {
  auto raw = two_blocks(PETSC_COMM_WORLD, dim, n, n + n / 2, 0.0);
  for (std::size_t i = 0; i + 2 < raw.coordinates.size(); i += 3) {
    double* x = &raw.coordinates[i];
    const double height = x[dim - 1] - 1.0;
    const bool is_upper = i / 3 >= raw.coordinates.size() / 3 - std::size_t(std::pow(n + n / 2 + 1, dim));
    if (!is_upper) continue;
    const double r2 = std::pow(x[0] - 0.45, 2) + (dim == 3 ? std::pow(x[1] - 0.5, 2) : 0.0);
    x[dim - 1] += 0.3 * r2 * (1.0 - height);
  }
  return distribute_mesh(PETSC_COMM_WORLD, raw, {{"upper_bottom", "lower_top"}}, 0);
}

} // namespace amontons::test
