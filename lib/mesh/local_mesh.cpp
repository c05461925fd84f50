#include "mesh/plex.hpp"

#include <algorithm>
#include <map>

namespace amontons {
namespace {

/// Points that other ranks own: rank of the owner, or -1 for own points.
std::vector<std::int32_t> owners_of_points(PetscSF shared, PetscInt num_points) {
  std::vector<std::int32_t> owners(num_points, -1);
  PetscInt num_roots = -1, num_leaves = 0;
  const PetscInt* leaves = nullptr;
  const PetscSFNode* remote = nullptr;
  AMT_PETSC(PetscSFGetGraph(shared, &num_roots, &num_leaves, &leaves, &remote));
  for (PetscInt i = 0; i < num_leaves; ++i)
    owners[leaves ? leaves[i] : i] = static_cast<std::int32_t>(remote[i].rank);
  return owners;
}

/// Fills one Mesh; members are what the steps share.
class Filler {
 public:
  Filler(MPI_Comm comm, PlexMesh&& plex, const MeshFacts& facts);
  Mesh filled();

 private:
  void name_groups();
  void number_nodes();
  void number_ghosts(const std::vector<PetscInt>& ghosts, const std::vector<std::int32_t>& owners);
  void fill_nodes(const std::vector<PetscInt>& points);
  void fill_cells();
  void fill_facets(const PlexCell& cell, std::int32_t body);
  void append(FacetSet& set, const PlexCell& cell, const LocalFacet& facet, std::int32_t body) const;

  PlexMesh plex_;
  const MeshFacts& facts_;
  PlexReader reader_;
  Mesh mesh_;
  PetscSF shared_ = nullptr;
  std::vector<std::int32_t> node_of_point_; // -1 where a point carries no node
  std::vector<std::int32_t> body_of_group_; // -1 for groups that are no bodies
};

Filler::Filler(MPI_Comm comm, PlexMesh&& plex, const MeshFacts& facts)
    : plex_(std::move(plex)), facts_(facts), reader_(plex_.dm, facts.order) {
  mesh_.comm = comm;
  mesh_.dim = facts.dim;
  mesh_.order = facts.order;
  AMT_PETSC(DMGetPointSF(plex_.dm, &shared_));
}

void Filler::name_groups() {
  const auto& names = facts_.group_names;
  for (std::size_t g = 0; g < names.size(); ++g) {
    mesh_.node_groups[names[g]];
    if (facts_.group_dims[g] == facts_.dim - 1) mesh_.surfaces[names[g]];
    if (facts_.group_dims[g] == facts_.dim) mesh_.bodies.push_back(names[g]);
  }
  std::sort(mesh_.bodies.begin(), mesh_.bodies.end());
  for (const auto& name : names) {
    const auto body = std::find(mesh_.bodies.begin(), mesh_.bodies.end(), name);
    body_of_group_.push_back(body == mesh_.bodies.end() ? -1 : static_cast<std::int32_t>(body - mesh_.bodies.begin()));
  }
}

/// In the order in which the cells meet them, so that nodes of a cell are near each other in memory; ghosts behind.
void Filler::number_nodes() {
  const auto owners = owners_of_points(shared_, reader_.num_points());
  std::vector<PetscInt> own, ghosts;
  std::vector<bool> met(reader_.num_points(), false);
  for (PetscInt c = reader_.cells_begin(); c < reader_.cells_end(); ++c) {
    const auto& cell = reader_.cell(c);
    for (int a = 0; a < cell.num_nodes; ++a) {
      const PetscInt point = cell.nodes[a];
      if (met[point]) continue;
      met[point] = true;
      (owners[point] < 0 ? own : ghosts).push_back(point);
    }
  }
  mesh_.num_owned = static_cast<std::int32_t>(own.size());
  std::int64_t owned = mesh_.num_owned, end = 0;
  MPI_Scan(&owned, &end, 1, MPI_INT64_T, MPI_SUM, mesh_.comm);
  MPI_Allreduce(&owned, &mesh_.num_global, 1, MPI_INT64_T, MPI_SUM, mesh_.comm);
  mesh_.first_global = end - owned;
  node_of_point_.assign(reader_.num_points(), -1);
  own.insert(own.end(), ghosts.begin(), ghosts.end());
  for (std::size_t node = 0; node < own.size(); ++node)
    node_of_point_[own[node]] = static_cast<std::int32_t>(node);
  number_ghosts(ghosts, owners);
  fill_nodes(own);
}

/// Owners tell the others the global numbers of shared nodes.
void Filler::number_ghosts(const std::vector<PetscInt>& ghosts, const std::vector<std::int32_t>& owners) {
  PetscInt num_roots = -1;
  AMT_PETSC(PetscSFGetGraph(shared_, &num_roots, nullptr, nullptr, nullptr));
  if (num_roots < 0) return; // one rank
  std::vector<std::int64_t> globals(reader_.num_points(), -1);
  for (std::size_t point = 0; point < globals.size(); ++point)
    if (owners[point] < 0 && node_of_point_[point] >= 0) globals[point] = mesh_.first_global + node_of_point_[point];
  AMT_PETSC(PetscSFBcastBegin(shared_, MPI_INT64_T, globals.data(), globals.data(), MPI_REPLACE));
  AMT_PETSC(PetscSFBcastEnd(shared_, MPI_INT64_T, globals.data(), globals.data(), MPI_REPLACE));
  for (const auto point : ghosts) {
    mesh_.ghost_globals.push_back(globals[point]);
    mesh_.ghost_owners.push_back(owners[point]);
  }
}

void Filler::fill_nodes(const std::vector<PetscInt>& points) {
  for (std::size_t node = 0; node < points.size(); ++node) {
    const auto& record = plex_.records[points[node]];
    mesh_.coordinates.insert(mesh_.coordinates.end(), record.place.begin(), record.place.begin() + mesh_.dim);
    mesh_.keys.push_back(point_key(reader_, plex_.records, points[node]));
    mesh_.is_vertex.push_back(reader_.is_vertex(points[node]));
    for (const auto group : facts_.regions.groups(record.region)) {
      auto& nodes =
          group == facts_.regions.exterior() ? mesh_.exterior_nodes : mesh_.node_groups.at(facts_.group_names[group]);
      nodes.push_back(static_cast<std::int32_t>(node));
    }
  }
}

void Filler::fill_cells() {
  std::map<std::pair<std::int32_t, ElementType>, CellBlock> blocks;
  for (PetscInt c = reader_.cells_begin(); c < reader_.cells_end(); ++c) {
    std::int32_t body = -1;
    for (const auto group : facts_.regions.groups(plex_.records[c].region))
      if (group != facts_.regions.exterior()) body = std::max(body, body_of_group_[group]);
    const auto& cell = reader_.cell(c);
    auto& block = blocks.try_emplace({body, cell.type}, CellBlock{cell.type, body, {}}).first->second;
    for (int a = 0; a < cell.num_nodes; ++a)
      block.nodes.push_back(node_of_point_[cell.nodes[a]]);
    fill_facets(cell, body);
  }
  for (auto& [key, block] : blocks)
    mesh_.blocks.push_back(std::move(block));
}

void Filler::fill_facets(const PlexCell& cell, std::int32_t body) {
  for (const PetscInt point : cell.closure) {
    const auto region = plex_.records[point].region;
    if (!reader_.is_facet(point) || !facts_.regions.has(region, facts_.regions.exterior())) continue;
    const auto vertices = corner_set<4>(reader_.vertices(point));
    for (const auto& facet : topology(cell.type).facets) {
      std::array<PetscInt, 4> corners{};
      int count = 0;
      for (const int corner : facet.corners())
        corners[count++] = cell.nodes[corner];
      if (corner_set<4>(std::span(corners).first(count)) != vertices) continue;
      append(mesh_.exterior, cell, facet, body);
      for (const auto group : facts_.regions.groups(region))
        if (group != facts_.regions.exterior() && facts_.group_dims[group] == facts_.dim - 1)
          append(mesh_.surfaces.at(facts_.group_names[group]), cell, facet, body);
    }
  }
}

void Filler::append(FacetSet& set, const PlexCell& cell, const LocalFacet& facet, std::int32_t body) const {
  set.types.push_back(facet.type);
  for (const int node : facet.nodes)
    set.nodes.push_back(node_of_point_[cell.nodes[node]]);
  set.offsets.push_back(static_cast<std::int32_t>(set.nodes.size()));
  set.bodies.push_back(body);
}

Mesh Filler::filled() {
  name_groups();
  number_nodes();
  fill_cells();
  return std::move(mesh_);
}

} // namespace

void name_exterior(Mesh& mesh) {
  mesh.surfaces[exterior_name] = mesh.exterior;
  mesh.node_groups[exterior_name] = mesh.exterior_nodes;
}

Mesh local_mesh(MPI_Comm comm, PlexMesh&& plex, const MeshFacts& facts) {
  return Filler(comm, std::move(plex), facts).filled();
}

} // namespace amontons
