// Checks and repairs of a RawMesh that need no gmsh: orientation and shape of cells, which facets belong to which
// cells. Serial.
#pragma once

#include "mesh/build.hpp"
#include "mesh/topology.hpp"

#include <unordered_map>

namespace amontons {

/// Where faults are collected, so that a user sees all of them in one go.
using Faults = std::vector<std::string>;

/// Which cells have a facet: how many (more than two: cells overlap), and the first two of them.
struct FacetUse {
  int count = 0;
  std::array<std::int64_t, 2> cells = {-1, -1};
};
using FacetUses = std::unordered_map<FacetCorners, FacetUse, CornerSetHash>;

/// The use of every element of dimension dim - 1 in raw.subs.
FacetUses group_facet_uses(const RawMesh& raw);

/// "nodes 4, 7 and 9 near (0.5, 1, 0)": how a user finds an element in gmsh; empty when no cell has its nodes.
/// `node_tags`: gmsh's number of each node, 0 for nodes that gmsh does not know.
std::string element_place(const RawMesh& raw, std::span<const std::int64_t> nodes,
                          const std::vector<std::size_t>& node_tags);

/// Turns cells with negative Jacobian round (raw's nodes of these cells are permuted); adds faults for cells where the
/// Jacobian changes sign or vanishes, for cells that are there twice or overlap at a facet, and for nodes off the plane
/// z = 0 in 2D.
void orient_and_check_cells(RawMesh& raw, const std::vector<std::size_t>& node_tags, Faults& faults);

/// Adds a fault for each group of dimension dim - 1 with elements that are not facets of a cell, and for each group of
/// lower dimension with nodes that no cell has (which are absent from raw: marked -1).
void check_lower_groups(const RawMesh& raw, const std::vector<std::size_t>& node_tags, Faults& faults);

} // namespace amontons
