// summary.json: what a run was and how it ended. The application decides what it says.
#pragma once

#include <mpi.h>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace amontons {

/// Writes `summary` (rank 0's counts) with its keys in their order, replacing an older file in one move. JSON knows no
/// infinity and no NaN: they become null. Throws UserError when the file cannot be written. Collective.
void write_summary(MPI_Comm comm, const std::string& path, const nlohmann::ordered_json& summary);

} // namespace amontons
