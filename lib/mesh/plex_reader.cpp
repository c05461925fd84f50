#include "mesh/plex.hpp"

#include <algorithm>
#include <stdexcept>

namespace amontons {

PlexReader::PlexReader(DM dm, int order) : dm_(dm), order_(order) {
  PetscInt begin = 0, dim = 0;
  AMT_PETSC(DMGetDimension(dm, &dim));
  dim_ = static_cast<int>(dim);
  AMT_PETSC(DMPlexGetChart(dm, &begin, &num_points_));
  AMT_PETSC(DMPlexGetHeightStratum(dm, 0, &cells_[0], &cells_[1]));
  AMT_PETSC(DMPlexGetHeightStratum(dm, 1, &facets_[0], &facets_[1]));
  AMT_PETSC(DMPlexGetDepthStratum(dm, 0, &vertices_[0], &vertices_[1]));
  AMT_PETSC(DMPlexGetDepthStratum(dm, 1, &edges_[0], &edges_[1]));
  if (dim_ == 3) faces_ = facets_;
}

/// Of a cell in the plane: itself, its edges, its corners. DMPlex finds the same in the same order by a search that
/// knows all kinds of cells and takes thirteen times as many instructions.
void PlexReader::read_flat_closure(PetscInt cell) {
  PetscInt size = 0;
  const PetscInt *edges = nullptr, *orientations = nullptr, *ends = nullptr;
  AMT_PETSC(DMPlexGetConeSize(dm_, cell, &size));
  AMT_PETSC(DMPlexGetCone(dm_, cell, &edges));
  AMT_PETSC(DMPlexGetConeOrientation(dm_, cell, &orientations));
  closure_.assign(1, cell);
  closure_.insert(closure_.end(), edges, edges + size);
  for (PetscInt i = 0; i < size; ++i) {
    AMT_PETSC(DMPlexGetCone(dm_, edges[i], &ends));
    closure_.push_back(ends[orientations[i] < 0 ? 1 : 0]);
  }
}

void PlexReader::read_closure(PetscInt point) {
  if (dim_ == 2 && point >= cells_[0] && point < cells_[1]) return read_flat_closure(point);
  PetscInt size = 0, *points = nullptr;
  AMT_PETSC(DMPlexGetTransitiveClosure(dm_, point, PETSC_TRUE, &size, &points));
  closure_.clear();
  for (PetscInt i = 0; i < size; ++i)
    closure_.push_back(points[2 * i]);
  AMT_PETSC(DMPlexRestoreTransitiveClosure(dm_, point, PETSC_TRUE, &size, &points));
}

const PlexCell& PlexReader::cell(PetscInt point) {
  read_closure(point);
  corners_.clear();
  for (const PetscInt p : closure_)
    if (is_vertex(p)) corners_.push_back(p);
  if (dim_ == 3) { // DMPlex numbers the corners of tetrahedra and hexahedra the other way round than gmsh
    DMPolytopeType shape;
    AMT_PETSC(DMPlexGetCellType(dm_, point, &shape));
    AMT_PETSC(DMPlexInvertCell(shape, corners_.data()));
  }
  return cell(point, corners_);
}

const PlexCell& PlexReader::cell(PetscInt point, std::span<const PetscInt> corners) {
  if (closure_.empty() || closure_.front() != point) read_closure(point);
  cell_.type = element_type(dim_, static_cast<int>(corners.size()), order_);
  cell_.num_nodes = num_nodes(cell_.type);
  cell_.closure = closure_;
  std::copy(corners.begin(), corners.end(), cell_.nodes.begin());
  if (order_ == 1) return cell_;
  read_carriers();
  const auto& supports = topology(cell_.type).supports;
  for (int a = static_cast<int>(corners.size()); a < cell_.num_nodes; ++a) {
    const auto& support = supports[a];
    if (support.size() == corners.size()) {
      cell_.nodes[a] = point;
      continue;
    }
    std::array<PetscInt, 4> on{};
    for (std::size_t i = 0; i < support.size(); ++i)
      on[i] = corners[support[i]];
    cell_.nodes[a] = carrier(corner_set<4>(std::span(on).first(support.size())));
  }
  return cell_;
}

/// Lists the edges and quadrilateral faces of the closure just read by their corners.
void PlexReader::read_carriers() {
  carriers_.clear();
  for (const PetscInt p : closure_)
    if ((p >= edges_[0] && p < edges_[1]) || (p >= faces_[0] && p < faces_[1]))
      carriers_.emplace_back(corner_set<4>(vertices(p)), p);
}

PetscInt PlexReader::carrier(const FacetCorners& corners) const {
  for (const auto& [others, point] : carriers_)
    if (others == corners) return point;
  throw std::logic_error("a node of a cell has no point in the cell's closure");
}

PlexVertices PlexReader::vertices(PetscInt point) {
  PlexVertices result;
  const auto add = [&](PetscInt vertex) {
    for (int i = 0; i < result.count; ++i)
      if (result.points[i] == vertex) return;
    result.points[result.count++] = vertex;
  };
  const auto add_cone = [&](PetscInt edge) {
    const PetscInt* ends = nullptr;
    AMT_PETSC(DMPlexGetCone(dm_, edge, &ends));
    add(ends[0]);
    add(ends[1]);
  };
  if (is_vertex(point)) {
    add(point);
  } else if (point >= edges_[0] && point < edges_[1]) {
    add_cone(point);
  } else if (point >= faces_[0] && point < faces_[1]) {
    PetscInt size = 0;
    const PetscInt* edges = nullptr;
    AMT_PETSC(DMPlexGetConeSize(dm_, point, &size));
    AMT_PETSC(DMPlexGetCone(dm_, point, &edges));
    for (PetscInt i = 0; i < size; ++i)
      add_cone(edges[i]);
  } else {
    const auto& corners = cell(point);
    for (int a = 0; a < amontons::num_vertices(corners.type); ++a)
      add(corners.nodes[a]);
  }
  return result;
}

std::uint64_t point_key(PlexReader& reader, const std::vector<PointRecord>& records, PetscInt point) {
  if (reader.is_vertex(point)) return records[point].key;
  const auto vertices = reader.vertices(point);
  std::uint64_t sum = static_cast<std::uint64_t>(vertices.count);
  for (const auto vertex : vertices)
    sum += scattered(records[vertex].key);
  return scattered(sum);
}

void set_vertex_coordinates(DM dm, const PlexReader& reader, const std::vector<PointRecord>& records) {
  PetscInt dim = 0;
  AMT_PETSC(DMGetDimension(dm, &dim));
  AMT_PETSC(DMSetCoordinateDim(dm, dim));
  const PetscInt begin = reader.first_vertex(), end = begin + reader.num_vertices();
  PetscSection section = nullptr;
  AMT_PETSC(DMGetCoordinateSection(dm, &section));
  AMT_PETSC(PetscSectionSetNumFields(section, 1));
  AMT_PETSC(PetscSectionSetFieldComponents(section, 0, dim));
  AMT_PETSC(PetscSectionSetChart(section, begin, end));
  for (PetscInt vertex = begin; vertex < end; ++vertex) {
    AMT_PETSC(PetscSectionSetDof(section, vertex, dim));
    AMT_PETSC(PetscSectionSetFieldDof(section, vertex, 0, dim));
  }
  AMT_PETSC(PetscSectionSetUp(section));
  VecHandle coordinates;
  AMT_PETSC(VecCreate(PETSC_COMM_SELF, coordinates.put()));
  AMT_PETSC(PetscObjectSetName(reinterpret_cast<PetscObject>(coordinates.get()), "coordinates"));
  AMT_PETSC(VecSetSizes(coordinates, (end - begin) * dim, PETSC_DETERMINE));
  AMT_PETSC(VecSetBlockSize(coordinates, dim));
  AMT_PETSC(VecSetType(coordinates, VECSTANDARD));
  {
    VecArray values(coordinates);
    for (PetscInt vertex = begin; vertex < end; ++vertex)
      std::copy_n(records[vertex].place.begin(), dim, values.data() + (vertex - begin) * dim);
  }
  AMT_PETSC(DMSetCoordinatesLocal(dm, coordinates));
}

} // namespace amontons
