#include "mesh/build.hpp"

#include "mesh/contact_pairs.hpp"
#include "mesh/partitioner.hpp"
#include "mesh/plex.hpp"

#include <algorithm>
#include <numeric>
#include <optional>

namespace amontons {
namespace {

void broadcast(MPI_Comm comm, std::string& text) {
  std::int64_t size = static_cast<std::int64_t>(text.size());
  MPI_Bcast(&size, 1, MPI_INT64_T, 0, comm);
  text.resize(static_cast<std::size_t>(size));
  MPI_Bcast(text.data(), static_cast<int>(size), MPI_CHAR, 0, comm);
}

/// Dimension, order and groups of the mesh on rank 0, on every rank. Collective.
MeshFacts shared_facts(MPI_Comm comm, const RawMesh& raw) {
  std::int32_t sizes[3] = {raw.dim, raw.order, static_cast<std::int32_t>(raw.groups.size())};
  MPI_Bcast(sizes, 3, MPI_INT32_T, 0, comm);
  MeshFacts facts;
  facts.dim = sizes[0];
  facts.order = sizes[1];
  facts.group_names.resize(sizes[2]);
  facts.group_dims.resize(sizes[2]);
  for (std::size_t g = 0; g < raw.groups.size(); ++g) {
    facts.group_names[g] = raw.groups[g].name;
    facts.group_dims[g] = raw.groups[g].dim;
  }
  for (auto& name : facts.group_names)
    broadcast(comm, name);
  MPI_Bcast(facts.group_dims.data(), sizes[2], MPI_INT32_T, 0, comm);
  return facts;
}

/// The same mesh with its cells in the order of their types. DMPlex refines only meshes whose points of one type are
/// numbered together in this order, and orders them so itself only when it distributes to several ranks.
RawMesh sorted_by_type(const RawMesh& raw) {
  std::vector<std::int64_t> order(raw.cell_types.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int64_t a, std::int64_t b) { return raw.cell_types[a] < raw.cell_types[b]; });
  RawMesh sorted = raw;
  sorted.cell_nodes.clear();
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto cell = order[i];
    sorted.cell_types[i] = raw.cell_types[cell];
    sorted.cell_bodies[i] = raw.cell_bodies[cell];
    sorted.cell_nodes.insert(sorted.cell_nodes.end(), raw.cell_nodes.begin() + raw.cell_offsets[cell],
                             raw.cell_nodes.begin() + raw.cell_offsets[cell + 1]);
    sorted.cell_offsets[i + 1] = static_cast<std::int64_t>(sorted.cell_nodes.size());
  }
  return sorted;
}

PartitionHints partition_hints(const RawMesh& raw, const ContactHints& contact) {
  PartitionHints hints;
  for (const auto type : raw.cell_types)
    hints.cell_weights.push_back(num_nodes(type));
  hints.strong_pairs = facing_cells(raw, contact);
  return hints;
}

/// The same mesh, its cells and records moved to the ranks that the partitioner chose. Collective.
PlexMesh distributed(PlexMesh&& whole, PartitionHints hints) {
  register_metis_partitioner();
  PetscPartitioner partitioner = nullptr;
  AMT_PETSC(DMPlexGetPartitioner(whole.dm, &partitioner));
  AMT_PETSC(PetscPartitionerSetType(partitioner, "metis"));
  AMT_PETSC(PetscPartitionerSetFromOptions(partitioner));
  set_partition_hints(partitioner, std::move(hints));
  PlexMesh parts;
  SfHandle migration;
  AMT_PETSC(DMPlexDistribute(whole.dm, 0, migration.put(), parts.dm.put()));
  if (!parts.dm) return std::move(whole); // one rank
  PetscInt begin = 0, end = 0;
  AMT_PETSC(DMPlexGetChart(parts.dm, &begin, &end));
  parts.records.resize(end);
  const RecordType type;
  AMT_PETSC(PetscSFBcastBegin(migration, type, whole.records.data(), parts.records.data(), MPI_REPLACE));
  AMT_PETSC(PetscSFBcastEnd(migration, type, whole.records.data(), parts.records.data(), MPI_REPLACE));
  return parts;
}

} // namespace

Mesh distribute_mesh(MPI_Comm comm, const RawMesh& raw, const ContactHints& hints, int refine) {
  std::optional<RawMesh> sorted;
  if (!std::is_sorted(raw.cell_types.begin(), raw.cell_types.end())) sorted = sorted_by_type(raw);
  const RawMesh& whole = sorted ? *sorted : raw;
  auto facts = shared_facts(comm, whole);
  auto plex = plex_of(comm, whole, facts);
  plex = distributed(std::move(plex), partition_hints(whole, hints));
  for (int level = 0; level < refine; ++level)
    plex = refined(plex, facts.order);
  return local_mesh(comm, std::move(plex), facts);
}

} // namespace amontons
