// The directory that a run leaves its files in, and what happens to those of the run before.
#pragma once

#include <mpi.h>
#include <string>

namespace amontons {

/// Makes `path` ready for a run, creating it (and its parents) when it is missing. Call only when the deck has been
/// checked. The files that a run leaves behind (fields.h5, fields.xdmf, history.csv, summary.json, checkpoint.h5,
/// log.txt; failed.h5 and failed.xdmf of a run that gave up) move together into `path`/previous and replace the older
/// ones there; if one cannot move, those that did are moved back. Nothing else in the directory is touched. A restart
/// that goes on in the same directory passes `keep` and nothing is moved. A checkpoint that lies in `path` or
/// `path`/previous must have been read before. Throws UserError when the directory cannot be made or written.
/// Collective.
void prepare_results_directory(MPI_Comm comm, const std::string& path, bool keep);

} // namespace amontons
