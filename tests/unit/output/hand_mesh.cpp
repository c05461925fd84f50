#include "hand_mesh.hpp"

#include "math/reference_element.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace amontons {

namespace {

using Lattice = std::array<int, 3>; // half-cell steps

struct Element {
  ElementType type;
  int body;
  int rank;
  std::vector<int> nodes; // global, in order of the lattice
};

struct Whole {
  std::vector<Element> cells, top;
};

ElementType with_order(ElementType linear, int order) {
  return order == 1 ? linear : static_cast<ElementType>(static_cast<int>(linear) + 1);
}

class Builder {
 public:
  explicit Builder(const HandMesh& mesh) : mesh_(mesh) {}

  int number(const Lattice& p) const {
    const int nx = 2 * mesh_.cells[0] + 1, ny = 2 * mesh_.cells[1] + 1;
    return p[0] + nx * (p[1] + ny * p[2]);
  }
  std::array<double, 3> place(int number) const {
    const int nx = 2 * mesh_.cells[0] + 1, ny = 2 * mesh_.cells[1] + 1;
    return {0.5 * (number % nx), 0.5 * (number / nx % ny), 0.5 * (number / nx / ny)};
  }

  /// The element with these corners: its further nodes are where the reference element has them.
  std::vector<int> nodes(ElementType type, const std::vector<Lattice>& corners) const {
    const int d = element_dim(type), n = num_vertices(type);
    std::vector<int> result;
    for (int a = 0; a < num_nodes(type); ++a) {
      std::vector<double> shape(n);
      shape_values(linear_element(type), reference_nodes(type).subspan(std::size_t(a) * d, d), shape);
      std::array<double, 3> p{};
      for (int b = 0; b < n; ++b)
        for (int i = 0; i < 3; ++i)
          p[i] += shape[b] * corners[b][i];
      result.push_back(number({int(p[0] + 0.5), int(p[1] + 0.5), int(p[2] + 0.5)}));
    }
    return result;
  }

  void add_cell(Whole& whole, Lattice c, int rank) const {
    const auto at = [&](int x, int y, int z) { return Lattice{2 * (c[0] + x), 2 * (c[1] + y), 2 * (c[2] + z)}; };
    const auto add = [&](ElementType linear, int body, const std::vector<Lattice>& corners) {
      const auto type = with_order(linear, mesh_.order);
      whole.cells.push_back({type, body, rank, nodes(type, corners)});
    };
    const auto add_top = [&](ElementType linear, const std::vector<Lattice>& corners) {
      const auto type = with_order(linear, mesh_.order);
      whole.top.push_back({type, 0, rank, nodes(type, corners)});
    };
    const bool tensor = c[0] < mesh_.num_tensor_columns;
    if (mesh_.dim == 2 && tensor) {
      add(ElementType::Quadrilateral4, 0, {at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0)});
      if (c[1] == mesh_.cells[1] - 1) add_top(ElementType::Segment2, {at(1, 1, 0), at(0, 1, 0)});
    } else if (mesh_.dim == 2) {
      add(ElementType::Triangle3, 1, {at(0, 0, 0), at(1, 0, 0), at(1, 1, 0)});
      add(ElementType::Triangle3, 1, {at(0, 0, 0), at(1, 1, 0), at(0, 1, 0)});
    } else if (tensor) {
      add(ElementType::Hexahedron8, 0,
          {at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0), at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)});
      if (c[2] == mesh_.cells[2] - 1)
        add_top(ElementType::Quadrilateral4, {at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)});
    } else {
      // Kuhn: a tetrahedron for each order in which the three directions can be walked; odd orders are mirrored.
      std::array<int, 3> walk = {0, 1, 2};
      for (int odd : {0, 1, 1, 0, 0, 1}) {
        std::vector<Lattice> corners = {at(0, 0, 0)};
        for (const int i : walk) {
          corners.push_back(corners.back());
          corners.back()[i] += 2;
        }
        if (odd) std::swap(corners[1], corners[2]);
        add(ElementType::Tetrahedron4, 1, corners);
        std::next_permutation(walk.begin(), walk.end());
      }
    }
  }

 private:
  const HandMesh& mesh_;
};

/// Nodes of this rank in their local order, owned first, and who owns which.
void number_nodes(Mesh& mesh, const Builder& builder, const Whole& whole, int rank) {
  std::map<int, int> owner;
  std::set<int> mine;
  for (const auto& cell : whole.cells)
    for (const int node : cell.nodes) {
      const auto [entry, fresh] = owner.emplace(node, cell.rank);
      if (!fresh) entry->second = std::max(entry->second, cell.rank);
      if (cell.rank == rank) mine.insert(node);
    }
  std::map<int, std::int64_t> global; // rank by rank
  for (int r = 0, ranks = 64; r < ranks; ++r) {
    if (r == rank) mesh.first_global = std::int64_t(global.size());
    for (const auto& [node, o] : owner)
      if (o == r) global.emplace(node, std::int64_t(global.size()));
  }
  mesh.num_global = std::int64_t(global.size());
  std::map<int, std::int32_t> local;
  const auto take = [&](int node) {
    local.emplace(node, std::int32_t(local.size()));
    const auto place = builder.place(node);
    mesh.coordinates.insert(mesh.coordinates.end(), place.begin(), place.begin() + mesh.dim);
    mesh.keys.push_back((std::uint64_t(node) + 1) * 0xD1342543DE82EF95ull);
  };
  for (const auto& [node, o] : owner)
    if (o == rank) take(node);
  mesh.num_owned = std::int32_t(local.size());
  for (const int node : mine)
    if (owner[node] != rank) {
      take(node);
      mesh.ghost_globals.push_back(global[node]);
      mesh.ghost_owners.push_back(owner[node]);
    }
  mesh.is_vertex.assign(local.size(), 0);
  std::map<std::pair<ElementType, int>, CellBlock> blocks;
  for (const auto& cell : whole.cells) {
    if (cell.rank != rank) continue;
    auto& block = blocks.try_emplace({cell.type, cell.body}, CellBlock{cell.type, cell.body, {}}).first->second;
    for (const int node : cell.nodes)
      block.nodes.push_back(local[node]);
    for (int a = 0; a < num_vertices(cell.type); ++a)
      mesh.is_vertex[local[cell.nodes[a]]] = 1;
  }
  for (auto& [key, block] : blocks)
    mesh.blocks.push_back(std::move(block));
  FacetSet& top = mesh.surfaces["top"];
  for (const auto& facet : whole.top) {
    if (facet.rank != rank) continue;
    top.types.push_back(facet.type);
    top.bodies.push_back(facet.body);
    for (const int node : facet.nodes)
      top.nodes.push_back(local[node]);
    top.offsets.push_back(std::int32_t(top.nodes.size()));
  }
}

} // namespace

Mesh HandMesh::distribute(MPI_Comm comm, const std::function<int(int)>& rank_of) const {
  const Builder builder(*this);
  Whole whole;
  const int layers = dim == 3 ? cells[2] : 1;
  for (int z = 0, c = 0; z < layers; ++z)
    for (int y = 0; y < cells[1]; ++y)
      for (int x = 0; x < cells[0]; ++x)
        builder.add_cell(whole, {x, y, z}, rank_of(c++));
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  Mesh mesh;
  mesh.comm = comm;
  mesh.dim = dim;
  mesh.order = order;
  mesh.bodies = {"left", "right"};
  number_nodes(mesh, builder, whole, rank);
  return mesh;
}

} // namespace amontons
