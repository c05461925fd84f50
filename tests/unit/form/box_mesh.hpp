// Meshes of a unit box made by hand: any element type, mapped to any shape, spread over the ranks of a communicator in
// slabs. What distribute_mesh makes of a file, without gmsh and DMPlex, for tests of forms.
#pragma once

#include "math/reference_element.hpp"
#include "math/space.hpp"
#include "mesh/mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <vector>

namespace amontons::testing {

using Lattice = std::array<int, 3>;
using Corners = std::vector<Lattice>;
/// Moves a point of the unit box, (x, y, z) with z = 0 in 2D, to where it shall be.
using Shape = std::function<std::array<double, 3>(std::array<double, 3>)>;

struct ElementCase {
  ElementType type;
  Space space;
};

/// Every element type in every space that it can be in.
inline const std::vector<ElementCase> element_cases = {
    {ElementType::Triangle3, Space::PlaneStrain},       {ElementType::Triangle6, Space::PlaneStrain},
    {ElementType::Quadrilateral4, Space::PlaneStrain},  {ElementType::Quadrilateral9, Space::PlaneStrain},
    {ElementType::Triangle3, Space::PlaneStress},       {ElementType::Triangle6, Space::PlaneStress},
    {ElementType::Quadrilateral4, Space::PlaneStress},  {ElementType::Quadrilateral9, Space::PlaneStress},
    {ElementType::Triangle3, Space::Axisymmetric},      {ElementType::Triangle6, Space::Axisymmetric},
    {ElementType::Quadrilateral4, Space::Axisymmetric}, {ElementType::Quadrilateral9, Space::Axisymmetric},
    {ElementType::Tetrahedron4, Space::Solid},          {ElementType::Tetrahedron10, Space::Solid},
    {ElementType::Hexahedron8, Space::Solid},           {ElementType::Hexahedron27, Space::Solid}};

/// Those of them that finite kinematics has: plane stress is not among them.
inline std::vector<ElementCase> finite_cases() {
  auto cases = element_cases;
  std::erase_if(cases, [](const ElementCase& one) { return one.space == Space::PlaneStress; });
  return cases;
}

/// Lattice places of all nodes of an element from those of its corners (corner functions of order 1 at the reference
/// nodes; corners are apart by multiples of the order, so middles fall on the lattice).
inline std::vector<Lattice> all_nodes(ElementType type, const Corners& corners) {
  const int dim = element_dim(type);
  std::vector<double> values(corners.size());
  std::vector<Lattice> nodes;
  for (int m = 0; m < num_nodes(type); ++m) {
    shape_values(linear_element(type), reference_nodes(type).subspan(std::size_t(m) * dim, dim), values);
    std::array<double, 3> place{};
    for (std::size_t a = 0; a < corners.size(); ++a)
      for (int i = 0; i < 3; ++i)
        place[i] += values[a] * corners[a][i];
    nodes.push_back({int(std::lround(place[0])), int(std::lround(place[1])), int(std::lround(place[2]))});
  }
  return nodes;
}

/// Corners of the cells that fill one lattice cube (square) with lower corner `low` and side `step`.
inline std::vector<Corners> cube_cells(ElementType type, Lattice low, int step) {
  const auto at = [&](int x, int y, int z) { return Lattice{low[0] + step * x, low[1] + step * y, low[2] + step * z}; };
  const Corners square = {at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0)};
  switch (linear_element(type)) {
  case ElementType::Quadrilateral4:
    return {square};
  case ElementType::Triangle3:
    return {{square[0], square[1], square[2]}, {square[0], square[2], square[3]}};
  case ElementType::Hexahedron8: {
    Corners cube = square;
    for (Lattice corner : square)
      cube.push_back({corner[0], corner[1], corner[2] + step});
    return {cube};
  }
  default:
    break;
  }
  // Kuhn's six tetrahedra: one for each order in which a path along the axes goes from corner (0,0,0) to (1,1,1).
  std::vector<Corners> cells;
  std::array<int, 3> axes = {0, 1, 2};
  do {
    Corners tetrahedron = {low};
    for (const int axis : axes) {
      tetrahedron.push_back(tetrahedron.back());
      tetrahedron.back()[axis] += step;
    }
    const bool even = (axes[1] - axes[0] + 3) % 3 == 1; // cyclic orders give positive volume
    if (!even) std::swap(tetrahedron[1], tetrahedron[2]);
    cells.push_back(tetrahedron);
  } while (std::next_permutation(axes.begin(), axes.end()));
  return cells;
}

/// Corner numbers of the facets of a cell, outward.
inline std::vector<std::vector<int>> facet_corners(ElementType type) {
  switch (linear_element(type)) {
  case ElementType::Triangle3:
    return {{0, 1}, {1, 2}, {2, 0}};
  case ElementType::Quadrilateral4:
    return {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  case ElementType::Tetrahedron4:
    return {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  default:
    return {{0, 3, 2, 1}, {0, 1, 5, 4}, {0, 4, 7, 3}, {1, 2, 6, 5}, {2, 3, 7, 6}, {4, 5, 6, 7}};
  }
}

inline ElementType facet_type(std::size_t corners, int order) {
  if (corners == 2) return order == 1 ? ElementType::Segment2 : ElementType::Segment3;
  if (corners == 3) return order == 1 ? ElementType::Triangle3 : ElementType::Triangle6;
  return order == 1 ? ElementType::Quadrilateral4 : ElementType::Quadrilateral9;
}

/// Appends the facets of a cell that lie on sides of the box to the surfaces "x-", "x+", "y-" ...
template <class NodeNumber>
void add_facets(Mesh& mesh, ElementType type, const Corners& corners, const std::array<int, 3>& ends,
                NodeNumber&& number) {
  static const char* const names[3][2] = {{"x-", "x+"}, {"y-", "y+"}, {"z-", "z+"}};
  for (const auto& local : facet_corners(type)) {
    Corners facet;
    for (const int corner : local)
      facet.push_back(corners[corner]);
    for (int axis = 0; axis < mesh.dim; ++axis)
      for (int end = 0; end < 2; ++end) {
        const int plane = end ? ends[axis] : 0;
        if (!std::all_of(facet.begin(), facet.end(), [&](const Lattice& p) { return p[axis] == plane; })) continue;
        FacetSet& set = mesh.surfaces[names[axis][end]];
        set.types.push_back(facet_type(facet.size(), mesh.order));
        for (const Lattice& node : all_nodes(set.types.back(), facet))
          set.nodes.push_back(number(node));
        set.offsets.push_back(static_cast<std::int32_t>(set.nodes.size()));
        set.bodies.push_back(0);
      }
  }
}

/// `counts` cubes (squares) a direction, slabs in x over the ranks; one body "block".
inline Mesh box_mesh(MPI_Comm comm, ElementType type, std::array<int, 3> counts, const Shape& shape) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  Mesh mesh;
  mesh.comm = comm;
  mesh.dim = element_dim(type);
  mesh.order = element_order(type);
  mesh.bodies = {"block"};
  if (mesh.dim == 2) counts[2] = 1;
  const std::array<int, 3> ends = {counts[0] * mesh.order, counts[1] * mesh.order,
                                   mesh.dim == 2 ? 0 : counts[2] * mesh.order};
  struct Cell {
    Corners corners;
    int rank;
  };
  std::vector<Cell> cells;
  std::map<Lattice, int> owners; // the lowest rank with a cell at the node
  for (int i = 0; i < counts[0]; ++i)
    for (int j = 0; j < counts[1]; ++j)
      for (int k = 0; k < counts[2]; ++k)
        for (auto& corners : cube_cells(type, {i * mesh.order, j * mesh.order, k * mesh.order}, mesh.order)) {
          const int cell_rank = i * ranks / counts[0];
          for (const Lattice& node : all_nodes(type, corners))
            owners.try_emplace(node, cell_rank); // slabs come in the order of ranks
          cells.push_back({std::move(corners), cell_rank});
        }
  std::map<Lattice, std::int64_t> globals;
  for (int r = 0; r < ranks; ++r)
    for (const auto& [node, owner] : owners) {
      if (owner != r) continue;
      if (r == rank && mesh.num_owned++ == 0) mesh.first_global = static_cast<std::int64_t>(globals.size());
      globals.emplace(node, static_cast<std::int64_t>(globals.size()));
    }
  mesh.num_global = static_cast<std::int64_t>(globals.size());

  std::map<Lattice, std::int32_t> locals;
  std::vector<Lattice> lattice_places(mesh.num_owned);
  for (const auto& [node, owner] : owners)
    if (owner == rank) {
      const auto local = static_cast<std::int32_t>(globals[node] - mesh.first_global);
      locals[node] = local;
      lattice_places[local] = node;
    }
  const auto number = [&](const Lattice& node) {
    const auto [entry, is_new] = locals.try_emplace(node, mesh.num_local());
    if (is_new) {
      mesh.ghost_globals.push_back(globals[node]);
      mesh.ghost_owners.push_back(owners[node]);
      lattice_places.push_back(node);
    }
    return entry->second;
  };
  for (const char* name : {"x-", "x+", "y-", "y+", "z-", "z+"})
    if (mesh.dim == 3 || name[0] != 'z') mesh.surfaces[name];
  CellBlock block{type, 0, {}};
  for (const auto& cell : cells) {
    if (cell.rank != rank) continue;
    for (const Lattice& node : all_nodes(type, cell.corners))
      block.nodes.push_back(number(node));
    add_facets(mesh, type, cell.corners, ends, number);
  }
  if (block.size() > 0) mesh.blocks.push_back(block);
  for (const auto& [name, facets] : mesh.surfaces) {
    auto& group = mesh.node_groups[name] = facets.nodes;
    std::sort(group.begin(), group.end());
    group.erase(std::unique(group.begin(), group.end()), group.end());
  }
  for (std::size_t node = 0; node < lattice_places.size(); ++node) {
    const Lattice& p = lattice_places[node];
    const auto X =
        shape({double(p[0]) / ends[0], double(p[1]) / ends[1], mesh.dim == 3 ? double(p[2]) / ends[2] : 0.0});
    mesh.coordinates.insert(mesh.coordinates.end(), X.begin(), X.begin() + mesh.dim);
    mesh.keys.push_back((std::uint64_t(p[0]) * 1000 + p[1]) * 1000 + p[2]);
    mesh.is_vertex.push_back(p[0] % mesh.order == 0 && p[1] % mesh.order == 0 && p[2] % mesh.order == 0);
  }
  return mesh;
}

/// Puts the middles of the cells' edges and faces back on straight sides.
inline void straighten(Mesh& mesh) {
  for (const auto& block : mesh.blocks) {
    const ElementType corner_type = linear_element(block.type);
    std::vector<double> values(num_nodes(corner_type));
    const int dim = mesh.dim;
    for (int m = num_nodes(corner_type); m < num_nodes(block.type); ++m) {
      shape_values(corner_type, reference_nodes(block.type).subspan(std::size_t(m) * dim, dim), values);
      for (std::int32_t c = 0; c < block.size(); ++c)
        for (int i = 0; i < dim; ++i) {
          double place = 0;
          for (std::size_t a = 0; a < values.size(); ++a)
            place += values[a] * mesh.position(block.cell(c)[a])[i];
          mesh.coordinates[block.cell(c)[m] * dim + i] = place;
        }
    }
  }
}

/// Moves the corners inside the mesh by up to `reach` a direction, without a pattern (the fractions of multiples of
/// irrational numbers), and keeps the sides straight.
inline void roughen(Mesh& mesh, double reach) {
  std::vector<bool> outside(mesh.num_local());
  for (const auto& [name, nodes] : mesh.node_groups)
    for (const auto node : nodes)
      outside[node] = true;
  const double irrational[] = {std::sqrt(2.0), std::sqrt(3.0), std::sqrt(5.0)};
  for (std::int32_t node = 0; node < mesh.num_local(); ++node)
    for (int i = 0; i < mesh.dim && !outside[node]; ++i) {
      const double multiple = irrational[i] * double(mesh.keys[node] % 99991);
      mesh.coordinates[node * mesh.dim + i] += reach * (2 * (multiple - std::floor(multiple)) - 1);
    }
  straighten(mesh);
}

/// The mesh with its sides as the exterior of the one body.
inline Mesh enclosed(Mesh mesh) {
  for (const auto& [name, side] : mesh.surfaces)
    for (std::int32_t f = 0; f < side.size(); ++f) {
      mesh.exterior.types.push_back(side.types[f]);
      mesh.exterior.nodes.insert(mesh.exterior.nodes.end(), side.facet(f).begin(), side.facet(f).end());
      mesh.exterior.offsets.push_back(static_cast<std::int32_t>(mesh.exterior.nodes.size()));
      mesh.exterior.bodies.push_back(0);
    }
  return mesh;
}

} // namespace amontons::testing
