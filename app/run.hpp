// Running a deck from its file to certified results.
#pragma once

#include <mpi.h>
#include <optional>
#include <string>

namespace amontons {

struct RunArguments {
  std::string deck;
  std::optional<std::string> out;     // where results go; absent: where the deck says
  std::optional<std::string> restart; // checkpoint to go on from
};

/// Runs the deck and returns the exit status: 0 solved and certified, 3 not converged, 4 not certified, 5 interrupted.
/// Throws UserError on every rank when deck or mesh are wrong; until then nothing is written. Collective.
int run(MPI_Comm comm, const RunArguments& arguments);

} // namespace amontons
