#include "mesh/build.hpp"

#include "mesh/contact_pairs.hpp"
#include "mesh/partitioner.hpp"
#include "mesh/plex.hpp"

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
  auto facts = shared_facts(comm, raw);
  auto plex = plex_of(comm, raw, facts);
  plex = distributed(std::move(plex), partition_hints(raw, hints));
  for (int level = 0; level < refine; ++level)
    plex = refined(plex, facts.order);
  return local_mesh(comm, std::move(plex), facts);
}

} // namespace amontons
