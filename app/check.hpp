// `amontons check`: what a deck would do, without doing it.
#pragma once

#include <mpi.h>
#include <string>

namespace amontons {

/// Reads and checks deck and mesh, and describes in words the mesh, its groups, which effects are on and off, the
/// number of unknowns and the memory that a run would take. The text is complete on rank 0. Throws UserError with every
/// fault. Collective.
std::string check_report(MPI_Comm comm, const std::string& deck_path);

} // namespace amontons
