// The distributed mesh as the rest of the program sees it: plain arrays of this rank's nodes, cells and named groups.
// Built by the functions of mesh/build.hpp from a DMPlex (topology, partition and refinement), which is gone
// afterwards. It knows nothing of unknowns, bodies' materials or contact.
#pragma once

#include "base/petsc.hpp"
#include "math/element_type.hpp"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace amontons {

/// Cells of one type and one body. Every cell is on exactly one rank (no overlap).
struct CellBlock {
  ElementType type;
  std::int32_t body;               // index into Mesh::bodies
  std::vector<std::int32_t> nodes; // local node numbers, num_nodes(type) a cell, gmsh order
  std::int32_t size() const { return static_cast<std::int32_t>(nodes.size()) / num_nodes(type); }
  std::span<const std::int32_t> cell(std::int32_t c) const {
    return std::span(nodes).subspan(std::size_t(c) * num_nodes(type), num_nodes(type));
  }
};

/// Boundary facets (edges in 2D, faces in 3D), each on exactly one rank: that of its one cell. Nodes in gmsh order,
/// oriented so that the normal points out of the cell: in 2D the outward normal is (t_y, -t_x) with t from the first
/// to the second node, in 3D it is the right-hand normal of the vertex cycle.
struct FacetSet {
  std::vector<ElementType> types;
  std::vector<std::int32_t> offsets = {0}; // nodes of facet f are nodes[offsets[f]] .. nodes[offsets[f + 1]]
  std::vector<std::int32_t> nodes;
  std::vector<std::int32_t> bodies;
  std::int32_t size() const { return static_cast<std::int32_t>(types.size()); }
  std::span<const std::int32_t> facet(std::int32_t f) const {
    return std::span(nodes).subspan(offsets[f], offsets[f + 1] - offsets[f]);
  }
};

/// This rank's part of the mesh. Nodes are numbered locally with the owned ones first, then ghosts (nodes of local
/// cells that another rank owns); globally rank by rank in the order of ownership.
struct Mesh {
  MPI_Comm comm = MPI_COMM_NULL;
  int dim = 0;   // 2 or 3
  int order = 1; // 1 or 2: of the cells, of their geometry and of the displacement field alike

  std::int32_t num_owned = 0;
  std::int64_t first_global = 0; // global number of local node 0
  std::int64_t num_global = 0;
  std::vector<double> coordinates;         // num_local() x dim, reference position X
  std::vector<std::int64_t> ghost_globals; // global number of local node num_owned + i
  std::vector<std::int32_t> ghost_owners;  // and the rank that owns it
  std::vector<std::uint64_t> keys;         // per local node: a name that does not depend on the number of ranks
  std::vector<std::uint8_t> is_vertex;     // per local node: a corner of cells (not on an edge, face or cell middle)

  std::vector<std::string> bodies; // physical groups of dimension dim, sorted by name
  std::vector<CellBlock> blocks;
  std::map<std::string, FacetSet> surfaces; // physical groups of dimension dim - 1; every name on every rank
  FacetSet exterior;                        // all boundary facets of all bodies
  std::vector<std::int32_t> exterior_nodes; // local nodes (owned and ghost) of boundary facets of any rank
  /// Nodes (owned and ghost) of every physical group of any dimension; every name on every rank.
  std::map<std::string, std::vector<std::int32_t>> node_groups;

  std::int32_t num_local() const { return num_owned + static_cast<std::int32_t>(ghost_globals.size()); }
  std::int64_t global_node(std::int32_t node) const {
    return node < num_owned ? first_global + node : ghost_globals[node - num_owned];
  }
  std::span<const double> position(std::int32_t node) const {
    return std::span(coordinates).subspan(std::size_t(node) * dim, dim);
  }
};

/// The name that exterior and exterior_nodes get among the surfaces and groups of a mesh where a scene wants them
/// there.
inline const char* const exterior_name = "all exterior surfaces";
void name_exterior(Mesh& mesh);

} // namespace amontons
