// Finding nodes again by their keys after the mesh has been distributed in another way.
#pragma once

#include <cstdint>
#include <mpi.h>
#include <span>
#include <vector>

namespace amontons {

/// The row of each of the `wanted` keys in a table of keys that is spread over the ranks: this rank has those of rows
/// first_row, first_row + 1, ... in `table`. -1 for a key that is nowhere. Both parties send to the rank that the key
/// itself names, so no rank sees the whole table. Collective.
std::vector<std::int64_t> rows_of_keys(MPI_Comm comm, std::span<const std::uint64_t> table, std::int64_t first_row,
                                       std::span<const std::uint64_t> wanted);

} // namespace amontons
