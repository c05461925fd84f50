#include "mesh/plex.hpp"

#include <algorithm>

namespace amontons {

Regions::Regions(std::int32_t num_groups) : num_groups_(num_groups), sets_(1), next_(num_groups + 1, -1) {}

std::int32_t Regions::with(std::int32_t region, std::int32_t group) {
  const std::size_t memory = std::size_t(region) * (num_groups_ + 1) + group;
  if (next_[memory] >= 0) return next_[memory];
  auto set = sets_[region];
  if (!has(region, group)) set.insert(std::lower_bound(set.begin(), set.end(), group), group);
  const auto known = std::find(sets_.begin(), sets_.end(), set);
  const auto result = static_cast<std::int32_t>(known - sets_.begin());
  if (known == sets_.end()) {
    sets_.push_back(std::move(set));
    next_.resize(sets_.size() * (num_groups_ + 1), -1);
  }
  return next_[memory] = result;
}

bool Regions::has(std::int32_t region, std::int32_t group) const {
  return std::binary_search(sets_[region].begin(), sets_[region].end(), group);
}

void Regions::broadcast(MPI_Comm comm) {
  std::vector<std::int32_t> packed;
  for (const auto& set : sets_) {
    packed.push_back(static_cast<std::int32_t>(set.size()));
    packed.insert(packed.end(), set.begin(), set.end());
  }
  std::int32_t sizes[2] = {num_groups_, static_cast<std::int32_t>(packed.size())};
  MPI_Bcast(sizes, 2, MPI_INT32_T, 0, comm);
  num_groups_ = sizes[0];
  packed.resize(sizes[1]);
  MPI_Bcast(packed.data(), sizes[1], MPI_INT32_T, 0, comm);
  sets_.clear();
  for (std::size_t i = 0; i < packed.size(); i += 1 + packed[i])
    sets_.emplace_back(packed.begin() + i + 1, packed.begin() + i + 1 + packed[i]);
  next_.assign(sets_.size() * (num_groups_ + 1), -1);
}

namespace {

DMPolytopeType polytope(ElementType type) {
  switch (num_vertices(type)) {
  case 3:
    return DM_POLYTOPE_TRIANGLE;
  case 4:
    return element_dim(type) == 2 ? DM_POLYTOPE_QUADRILATERAL : DM_POLYTOPE_TETRAHEDRON;
  default:
    return DM_POLYTOPE_HEXAHEDRON;
  }
}

/// DMPlex vertex (a point) of each node that is a corner, -1 for the others. Cells come before vertices in the chart.
std::vector<PetscInt> vertices_of_nodes(const RawMesh& raw) {
  std::vector<PetscInt> vertices(raw.coordinates.size() / 3, -1);
  for (std::int64_t cell = 0; cell < raw.num_cells(); ++cell)
    for (int a = 0; a < num_vertices(raw.cell_types[cell]); ++a)
      vertices[raw.cell_nodes[raw.cell_offsets[cell] + a]] = 0;
  PetscInt next = static_cast<PetscInt>(raw.num_cells());
  for (auto& vertex : vertices)
    if (vertex == 0) vertex = next++;
  return vertices;
}

/// The corners of a cell as DMPlex vertices, in gmsh's order.
void cell_corners(const RawMesh& raw, std::int64_t cell, const std::vector<PetscInt>& vertices,
                  std::vector<PetscInt>& corners) {
  corners.clear();
  for (int a = 0; a < num_vertices(raw.cell_types[cell]); ++a)
    corners.push_back(vertices[raw.cell_nodes[raw.cell_offsets[cell] + a]]);
}

/// Cells and vertices, without edges and faces yet. Local.
void set_cells(DM dm, const RawMesh& raw, const std::vector<PetscInt>& vertices) {
  const auto num_cells = static_cast<PetscInt>(raw.num_cells());
  const auto num_corners =
      static_cast<PetscInt>(std::count_if(vertices.begin(), vertices.end(), [](PetscInt v) { return v >= 0; }));
  AMT_PETSC(DMPlexSetChart(dm, 0, num_cells + num_corners));
  for (PetscInt cell = 0; cell < num_cells; ++cell)
    AMT_PETSC(DMPlexSetConeSize(dm, cell, num_vertices(raw.cell_types[cell])));
  AMT_PETSC(DMSetUp(dm));
  std::vector<PetscInt> corners;
  for (PetscInt cell = 0; cell < num_cells; ++cell) {
    const auto shape = polytope(raw.cell_types[cell]);
    cell_corners(raw, cell, vertices, corners);
    if (raw.dim == 3) AMT_PETSC(DMPlexInvertCell(shape, corners.data()));
    AMT_PETSC(DMPlexSetCone(dm, cell, corners.data()));
    AMT_PETSC(DMPlexSetCellType(dm, cell, shape));
  }
  for (PetscInt vertex = num_cells; vertex < num_cells + num_corners; ++vertex)
    AMT_PETSC(DMPlexSetCellType(dm, vertex, DM_POLYTOPE_POINT));
}

/// Collective.
DmHandle interpolated_plex(MPI_Comm comm, const RawMesh& raw, int dim, const std::vector<PetscInt>& vertices) {
  DmHandle flat, full;
  AMT_PETSC(DMCreate(comm, flat.put()));
  AMT_PETSC(DMSetType(flat, DMPLEX));
  AMT_PETSC(DMSetDimension(flat, dim));
  AMT_PETSC(DMCreateLabel(flat, "celltype"));
  set_cells(flat, raw, vertices);
  AMT_PETSC(DMPlexSymmetrize(flat));
  AMT_PETSC(DMPlexStratify(flat));
  AMT_PETSC(DMPlexInterpolate(flat, full.put()));
  return full;
}

/// Node places, vertex keys, and the bodies' regions on their closures.
void record_cells(const RawMesh& raw, const std::vector<PetscInt>& vertices, PlexReader& reader, Regions& regions,
                  std::vector<PointRecord>& records) {
  std::vector<PetscInt> corners;
  for (std::int64_t c = 0; c < raw.num_cells(); ++c) {
    cell_corners(raw, c, vertices, corners);
    const auto& cell = reader.cell(static_cast<PetscInt>(c), corners);
    for (int a = 0; a < cell.num_nodes; ++a) {
      const auto node = raw.cell_nodes[raw.cell_offsets[c] + a];
      std::copy_n(&raw.coordinates[3 * node], 3, records[cell.nodes[a]].place.begin());
    }
    for (const auto point : cell.closure)
      records[point].region = regions.with(records[point].region, raw.cell_bodies[c]);
  }
  for (std::size_t node = 0; node < vertices.size(); ++node)
    if (vertices[node] >= 0) records[vertices[node]].key = scattered(node + 1);
}

/// The edge or face with these corners, or -1.
PetscInt joined_point(DM dm, const std::vector<PetscInt>& corners) {
  PetscInt size = 0;
  const PetscInt* points = nullptr;
  AMT_PETSC(DMPlexGetFullJoin(dm, static_cast<PetscInt>(corners.size()), corners.data(), &size, &points));
  const PetscInt point = size == 1 ? points[0] : -1;
  AMT_PETSC(DMPlexRestoreJoin(dm, static_cast<PetscInt>(corners.size()), corners.data(), &size, &points));
  return point;
}

void add_closure(DM dm, PetscInt point, std::int32_t group, Regions& regions, std::vector<PointRecord>& records) {
  PetscInt size = 0, *points = nullptr;
  AMT_PETSC(DMPlexGetTransitiveClosure(dm, point, PETSC_TRUE, &size, &points));
  for (PetscInt i = 0; i < size; ++i) {
    auto& region = records[points[2 * i]].region;
    region = regions.with(region, group);
  }
  AMT_PETSC(DMPlexRestoreTransitiveClosure(dm, point, PETSC_TRUE, &size, &points));
}

/// Groups of lower dimension, on the closures of their elements.
void record_groups(DM dm, const RawMesh& raw, const std::vector<PetscInt>& vertices, Regions& regions,
                   std::vector<PointRecord>& records) {
  std::vector<PetscInt> corners;
  for (const auto& sub : raw.subs) {
    corners.clear();
    for (const auto node : sub.nodes)
      if (vertices[node] >= 0) corners.push_back(vertices[node]);
    const PetscInt point = corners.size() > 1 ? joined_point(dm, corners) : -1;
    if (point >= 0) {
      add_closure(dm, point, sub.group, regions, records);
      continue;
    }
    for (const auto vertex : corners)
      records[vertex].region = regions.with(records[vertex].region, sub.group);
  }
}

/// Marks the facets with one cell.
void record_exterior(DM dm, const PlexReader& reader, Regions& regions, std::vector<PointRecord>& records) {
  for (PetscInt facet = reader.facets_begin(); facet < reader.facets_end(); ++facet) {
    PetscInt cells = 0;
    AMT_PETSC(DMPlexGetSupportSize(dm, facet, &cells));
    if (cells == 1) add_closure(dm, facet, regions.exterior(), regions, records);
  }
}

} // namespace

PlexMesh plex_of(MPI_Comm comm, const RawMesh& raw, MeshFacts& facts) {
  facts.regions = Regions(static_cast<std::int32_t>(raw.groups.size()));
  const auto vertices = vertices_of_nodes(raw);
  PlexMesh plex;
  plex.dm = interpolated_plex(comm, raw, facts.dim, vertices);
  PlexReader reader(plex.dm, facts.order);
  plex.records.resize(reader.num_points());
  record_cells(raw, vertices, reader, facts.regions, plex.records);
  record_groups(plex.dm, raw, vertices, facts.regions, plex.records);
  record_exterior(plex.dm, reader, facts.regions, plex.records);
  facts.regions.broadcast(comm);
  set_vertex_coordinates(plex.dm, reader, plex.records);
  return plex;
}

} // namespace amontons
