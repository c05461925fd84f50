#include "mesh/plex.hpp"

#include "math/reference_element.hpp"

#include <algorithm>
#include <petscdmplextransform.h>

namespace amontons {
namespace {

using TransformHandle = Handle<DMPlexTransform, DMPlexTransformDestroy>;

/// The point of the coarse mesh in whose interior a point of the fine mesh lies.
PetscInt source_of(DMPlexTransform transform, PetscInt fine_point) {
  DMPolytopeType coarse_shape, fine_shape;
  PetscInt source = -1, replica = -1;
  AMT_PETSC(DMPlexTransformGetSourcePoint(transform, fine_point, &coarse_shape, &fine_shape, &source, &replica));
  return source;
}

/// Where the vertex that refinement puts on a point lies: on the point's node, or without one on the mean of its
/// vertices.
std::array<double, 3> middle(PlexReader& reader, const std::vector<PointRecord>& records, PetscInt point, int order) {
  if (order == 2 || reader.is_vertex(point)) return records[point].place;
  const auto vertices = reader.vertices(point);
  std::array<double, 3> place{};
  for (const auto vertex : vertices)
    for (int i = 0; i < 3; ++i)
      place[i] += records[vertex].place[i] / vertices.count;
  return place;
}

/// Reference coordinates, in the parent, of all nodes of a child whose vertices come from nodes of the parent. The
/// division is straight in reference coordinates.
std::vector<double> child_nodes_in_parent(const PlexCell& child, std::span<const PetscInt> vertex_sources,
                                          const PlexCell& parent) {
  const int dim = element_dim(child.type), corners = num_vertices(child.type);
  const auto parent_nodes = reference_nodes(parent.type), child_nodes = reference_nodes(child.type);
  std::vector<double> xi(std::size_t(child.num_nodes) * dim, 0.0), linear(corners);
  std::vector<std::size_t> places;
  for (const auto source : vertex_sources)
    places.push_back(std::find(parent.nodes.begin(), parent.nodes.begin() + parent.num_nodes, source) -
                     parent.nodes.begin());
  for (int a = 0; a < child.num_nodes; ++a) {
    shape_values(linear_element(child.type), child_nodes.subspan(std::size_t(a) * dim, dim), linear);
    for (int b = 0; b < corners; ++b)
      for (int i = 0; i < dim; ++i)
        xi[a * dim + i] += linear[b] * parent_nodes[places[b] * dim + i];
  }
  return xi;
}

/// Order 2: puts the children's nodes on the parent's quadratic map.
void place_nodes(DMPlexTransform transform, PlexReader& coarse_reader, const std::vector<PointRecord>& coarse,
                 PlexReader& fine_reader, std::vector<PointRecord>& fine) {
  std::vector<double> values;
  for (PetscInt c = fine_reader.cells_begin(); c < fine_reader.cells_end(); ++c) {
    const auto& child = fine_reader.cell(c);
    const auto& parent = coarse_reader.cell(source_of(transform, c));
    std::array<PetscInt, 8> sources{};
    const int corners = num_vertices(child.type), dim = element_dim(child.type);
    for (int a = 0; a < corners; ++a)
      sources[a] = source_of(transform, child.nodes[a]);
    const auto xi = child_nodes_in_parent(child, std::span(sources).first(corners), parent);
    values.resize(parent.num_nodes);
    for (int a = corners; a < child.num_nodes; ++a) {
      shape_values(parent.type, std::span(xi).subspan(std::size_t(a) * dim, dim), values);
      auto& place = fine[child.nodes[a]].place;
      place = {};
      for (int b = 0; b < parent.num_nodes; ++b)
        for (int i = 0; i < 3; ++i)
          place[i] += values[b] * coarse[parent.nodes[b]].place[i];
    }
  }
}

/// Neighbouring ranks compute shared nodes from different cells; all take the owner's figures, to the last bit.
void take_owners_records(DM dm, std::vector<PointRecord>& records) {
  PetscSF shared = nullptr;
  AMT_PETSC(DMGetPointSF(dm, &shared));
  PetscInt num_roots = -1;
  AMT_PETSC(PetscSFGetGraph(shared, &num_roots, nullptr, nullptr, nullptr));
  if (num_roots < 0) return; // one rank
  const RecordType type;
  AMT_PETSC(PetscSFBcastBegin(shared, type, records.data(), records.data(), MPI_REPLACE));
  AMT_PETSC(PetscSFBcastEnd(shared, type, records.data(), records.data(), MPI_REPLACE));
}

} // namespace

PlexMesh refined(const PlexMesh& coarse, int order) {
  TransformHandle transform;
  AMT_PETSC(DMPlexTransformCreate(PetscObjectComm(reinterpret_cast<PetscObject>(coarse.dm.get())), transform.put()));
  AMT_PETSC(DMPlexTransformSetDM(transform, coarse.dm));
  AMT_PETSC(DMPlexTransformSetType(transform, DMPLEXREFINEREGULAR));
  AMT_PETSC(DMPlexTransformSetUp(transform));
  PlexMesh fine;
  AMT_PETSC(DMPlexTransformApply(transform, coarse.dm, fine.dm.put()));

  PlexReader coarse_reader(coarse.dm, order), reader(fine.dm, order);
  fine.records.resize(reader.num_points());
  for (PetscInt point = 0; point < reader.num_points(); ++point) {
    const PetscInt source = source_of(transform, point);
    auto& record = fine.records[point];
    record.region = coarse.records[source].region;
    if (!reader.is_vertex(point)) continue;
    record.place = middle(coarse_reader, coarse.records, source, order);
    record.key = point_key(coarse_reader, coarse.records, source);
  }
  if (order == 2) place_nodes(transform, coarse_reader, coarse.records, reader, fine.records);
  take_owners_records(fine.dm, fine.records);
  return fine;
}

} // namespace amontons
