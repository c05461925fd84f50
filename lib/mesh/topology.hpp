// What lies where in a cell: on which corners the other nodes depend, and which nodes make up each facet. Pure tables
// for the element types of math/element_type.hpp; knows neither gmsh's files nor DMPlex.
#pragma once

#include "math/element_type.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace amontons {

/// A facet of a cell: cell-local node numbers in gmsh's order for `type`, so oriented that its normal points out of a
/// cell with positive Jacobian.
struct LocalFacet {
  ElementType type;
  std::vector<int> nodes;
  std::span<const int> corners() const { return std::span(nodes).first(num_vertices(type)); }
};

struct ElementTopology {
  /// Per node: the corners (ascending) of the smallest vertex, edge, face or cell that it is the middle of.
  std::vector<std::vector<int>> supports;
  /// Edges of a surface element, faces of a volume element.
  std::vector<LocalFacet> facets;
  /// mirror[a]: the node to put at place a to turn the element's orientation round.
  std::vector<int> mirror;
};

/// Made once for each type and kept.
const ElementTopology& topology(ElementType type);

/// The element with the given number of corners in `dim` dimensions (1: segment, 2: triangle or quadrilateral,
/// 3: tetrahedron or hexahedron) and the order.
ElementType element_type(int dim, int corners, int order);

/// Corners of a facet or cell without their order: sorted, filled up with -1 behind.
template <std::size_t size>
using CornerSet = std::array<std::int64_t, size>;
using FacetCorners = CornerSet<4>;

/// A bijection of 64-bit numbers that scatters neighbours (the finalizer of SplitMix64).
constexpr std::uint64_t scattered(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

struct CornerSetHash {
  template <std::size_t size>
  std::size_t operator()(const CornerSet<size>& corners) const {
    std::uint64_t hash = 0;
    for (const auto corner : corners)
      hash = scattered(hash ^ static_cast<std::uint64_t>(corner));
    return static_cast<std::size_t>(hash);
  }
};

template <std::size_t size, class Corners>
CornerSet<size> corner_set(const Corners& corners) {
  CornerSet<size> set;
  set.fill(-1);
  std::size_t count = 0;
  for (const auto corner : corners) { // insertion sort: at most eight of them
    std::size_t place = count++;
    for (; place > 0 && set[place - 1] > corner; --place)
      set[place] = set[place - 1];
    set[place] = corner;
  }
  return set;
}

} // namespace amontons
