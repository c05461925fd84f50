// METIS as a PetscPartitioner ("metis"), which Debian's PETSc does not have. It works on the graph of a mesh that is
// whole on one rank, which is where meshes come from here, and can be told of cells that belong together.
#pragma once

#include "base/petsc.hpp"

#include <array>
#include <petscpartitioner.h>
#include <vector>

namespace amontons {

/// Makes "metis" known to PETSc; further calls do nothing.
void register_metis_partitioner();

/// What the partitioner should know beyond the graph of neighbours. Cells are numbered as in the graph.
struct PartitionHints {
  std::vector<std::int32_t> cell_weights;                // work per cell; empty: all equal
  std::vector<std::array<std::int64_t, 2>> strong_pairs; // cells that should stay on one rank
};

/// Does nothing when the partitioner is of another type.
void set_partition_hints(PetscPartitioner partitioner, PartitionHints hints);

} // namespace amontons
