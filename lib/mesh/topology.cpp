#include "mesh/topology.hpp"

#include "math/reference_element.hpp"

#include <algorithm>
#include <array>
#include <memory>

namespace amontons {
namespace {

using Cycles = std::vector<std::vector<int>>;

/// Corners of the facets, round the outward normal.
Cycles facet_cycles(ElementType type) {
  switch (linear_element(type)) {
  case ElementType::Segment2:
    return {};
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

/// A node is the middle of those corners whose linear shape functions do not vanish at it.
std::vector<std::vector<int>> node_supports(ElementType type) {
  const int dim = element_dim(type);
  std::vector<double> values(num_vertices(type));
  std::vector<std::vector<int>> supports(num_nodes(type));
  for (int a = 0; a < num_nodes(type); ++a) {
    shape_values(linear_element(type), reference_nodes(type).subspan(std::size_t(a) * dim, dim), values);
    for (int corner = 0; corner < num_vertices(type); ++corner)
      if (values[corner] > 0.01) supports[a].push_back(corner);
  }
  return supports;
}

int node_on(const std::vector<std::vector<int>>& supports, std::vector<int> corners) {
  std::sort(corners.begin(), corners.end());
  return static_cast<int>(std::find(supports.begin(), supports.end(), corners) - supports.begin());
}

std::vector<LocalFacet> local_facets(ElementType type, const std::vector<std::vector<int>>& supports) {
  std::vector<LocalFacet> facets;
  for (const auto& cycle : facet_cycles(type)) {
    LocalFacet facet{element_type(element_dim(type) - 1, static_cast<int>(cycle.size()), element_order(type)), {}};
    for (const auto& support : node_supports(facet.type)) {
      std::vector<int> corners;
      for (const int corner : support)
        corners.push_back(cycle[corner]);
      facet.nodes.push_back(node_on(supports, corners));
    }
    facets.push_back(std::move(facet));
  }
  return facets;
}

/// Exchanging the first two reference coordinates (on a segment: its sign) turns the orientation round.
std::vector<int> mirrored_nodes(ElementType type, const std::vector<std::vector<int>>& supports) {
  const int dim = element_dim(type);
  const auto nodes = reference_nodes(type);
  std::vector<int> images;
  for (int corner = 0; corner < num_vertices(type); ++corner) {
    std::vector<double> image(nodes.begin() + corner * dim, nodes.begin() + (corner + 1) * dim);
    if (dim == 1)
      image[0] = -image[0];
    else
      std::swap(image[0], image[1]);
    for (int other = 0; other < num_vertices(type); ++other)
      if (std::equal(image.begin(), image.end(), nodes.begin() + other * dim)) images.push_back(other);
  }
  std::vector<int> mirror;
  for (const auto& support : supports) {
    std::vector<int> corners;
    for (const int corner : support)
      corners.push_back(images[corner]);
    mirror.push_back(node_on(supports, corners));
  }
  return mirror;
}

ElementTopology new_topology(ElementType type) {
  const auto supports = node_supports(type);
  return {supports, local_facets(type, supports), mirrored_nodes(type, supports)};
}

} // namespace

ElementType element_type(int dim, int corners, int order) {
  const bool linear = order == 1;
  if (dim == 1) return linear ? ElementType::Segment2 : ElementType::Segment3;
  if (dim == 2 && corners == 3) return linear ? ElementType::Triangle3 : ElementType::Triangle6;
  if (dim == 2) return linear ? ElementType::Quadrilateral4 : ElementType::Quadrilateral9;
  if (corners == 4) return linear ? ElementType::Tetrahedron4 : ElementType::Tetrahedron10;
  return linear ? ElementType::Hexahedron8 : ElementType::Hexahedron27;
}

const ElementTopology& topology(ElementType type) {
  static std::array<std::unique_ptr<const ElementTopology>, 10> made;
  auto& kept = made[static_cast<std::size_t>(type)];
  if (!kept) kept = std::make_unique<const ElementTopology>(new_topology(type));
  return *kept;
}

} // namespace amontons
