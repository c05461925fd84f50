// The mesh as a DMPlex with a record per point: what the stages between RawMesh and Mesh (build, distribute, refine)
// hand to each other. A node of a mesh of order 1 or 2 sits on a point of its own (vertex, edge, quadrilateral, cell),
// so that points name nodes and their order within edges and faces never matters.
#pragma once

#include "base/petsc.hpp"
#include "mesh/build.hpp"
#include "mesh/topology.hpp"

#include <array>
#include <petscdmplex.h>
#include <span>
#include <vector>

namespace amontons {

/// Sets of groups, numbered: region 0 is the empty set. A point belongs to the groups of its region. The number behind
/// the last group stands for "on the boundary of a body".
class Regions {
 public:
  explicit Regions(std::int32_t num_groups = 0);

  /// The region with `group` added.
  std::int32_t with(std::int32_t region, std::int32_t group);
  const std::vector<std::int32_t>& groups(std::int32_t region) const { return sets_[region]; }
  bool has(std::int32_t region, std::int32_t group) const;
  std::int32_t exterior() const { return num_groups_; }
  /// Gives every rank what rank 0 has. Collective.
  void broadcast(MPI_Comm comm);

 private:
  std::int32_t num_groups_;
  std::vector<std::vector<std::int32_t>> sets_;
  std::vector<std::int32_t> next_; // (num_groups + 1) per region: memory of with(), -1 unknown
};

/// What is known of a DMPlex point. Travels between ranks as bytes.
struct PointRecord {
  std::array<double, 3> place{}; // of the node on it, where there is one
  std::uint64_t key = 0;         // vertices only: the name of the vertex
  std::int32_t region = 0;
};

/// Points are 0 .. records.size() - 1: cells first, then (in this order of dimension in DMPlex) vertices and the rest.
struct PlexMesh {
  DmHandle dm;
  std::vector<PointRecord> records;
};

/// What rank 0 knows of the whole mesh and tells the others.
struct MeshFacts {
  int dim = 0;
  int order = 1;
  std::vector<std::string> group_names;
  std::vector<std::int32_t> group_dims;
  Regions regions;
};

/// A cell of a DMPlex in gmsh's terms.
struct PlexCell {
  ElementType type;
  int num_nodes;
  std::array<PetscInt, 27> nodes;    // points that carry the nodes, gmsh's order
  std::span<const PetscInt> closure; // all points of the closure, the cell first; valid until the next cell is read
};

struct PlexVertices {
  int count = 0;
  std::array<PetscInt, 8> points{};
  const PetscInt* begin() const { return points.data(); }
  const PetscInt* end() const { return points.data() + count; }
};

/// Reads cells and vertices of an interpolated DMPlex. Local.
class PlexReader {
 public:
  PlexReader(DM dm, int order);

  PetscInt num_points() const { return num_points_; }
  PetscInt cells_begin() const { return cells_[0]; }
  PetscInt cells_end() const { return cells_[1]; }
  bool is_vertex(PetscInt point) const { return point >= vertices_[0] && point < vertices_[1]; }
  bool is_facet(PetscInt point) const { return point >= facets_[0] && point < facets_[1]; }
  PetscInt first_vertex() const { return vertices_[0]; }
  PetscInt num_vertices() const { return vertices_[1] - vertices_[0]; }
  PetscInt facets_begin() const { return facets_[0]; }
  PetscInt facets_end() const { return facets_[1]; }

  /// The cell with its nodes in DMPlex's own arrangement of corners, which has a positive Jacobian.
  const PlexCell& cell(PetscInt point);
  /// The same cell with the corners in a given order.
  const PlexCell& cell(PetscInt point, std::span<const PetscInt> corners);
  /// Vertices of any point, in no particular order.
  PlexVertices vertices(PetscInt point);

 private:
  void read_flat_closure(PetscInt cell);
  void read_closure(PetscInt point);
  void read_carriers();
  PetscInt carrier(const FacetCorners& corners) const;

  DM dm_;
  int dim_ = 0, order_;
  PetscInt num_points_ = 0;
  std::array<PetscInt, 2> cells_{}, facets_{}, vertices_{}, edges_{}, faces_{};
  std::vector<PetscInt> closure_, corners_;
  std::vector<std::pair<FacetCorners, PetscInt>> carriers_;
  PlexCell cell_{};
};

/// The name of a point: of a vertex its record's key, of others a hash of the keys of its vertices
/// that does not depend on their order.
std::uint64_t point_key(PlexReader& reader, const std::vector<PointRecord>& records, PetscInt point);

/// Gives the DM the places of its vertices as its (linear) coordinates: PETSc wants some, we never read them.
/// Collective.
void set_vertex_coordinates(DM dm, const PlexReader& reader, const std::vector<PointRecord>& records);

/// The MPI type of a PointRecord for the life of the object.
class RecordType {
 public:
  RecordType() {
    MPI_Type_contiguous(sizeof(PointRecord), MPI_BYTE, &type_);
    MPI_Type_commit(&type_);
  }
  ~RecordType() { MPI_Type_free(&type_); }
  RecordType(const RecordType&) = delete;
  RecordType& operator=(const RecordType&) = delete;
  operator MPI_Datatype() const { return type_; }

 private:
  MPI_Datatype type_ = MPI_DATATYPE_NULL;
};

/// The whole mesh as an interpolated DMPlex on rank 0 (other ranks hold an empty part), and what everyone must know of
/// it. Collective.
PlexMesh plex_of(MPI_Comm comm, const RawMesh& raw, MeshFacts& facts);

/// The mesh with every cell divided into 2^dim. Collective.
PlexMesh refined(const PlexMesh& coarse, int order);

/// This rank's arrays; the DM ends here. Collective.
Mesh local_mesh(MPI_Comm comm, PlexMesh&& plex, const MeshFacts& facts);

} // namespace amontons
