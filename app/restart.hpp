// The state of a run as a checkpoint and back: unknowns, multipliers, the history of friction, books.
#pragma once

#include "ledger.hpp"
#include "output/checkpoint.hpp"
#include "scene.hpp"

#include <string>

namespace amontons {

/// All that must be the same for a restart to make sense, besides the mesh.
std::string run_identity(const Scene& scene);

/// Unknowns, the pairs' histories and the books, all as of the last accepted state. Collective.
Checkpoint make_checkpoint(const Scene& scene, const Ledger& ledger, Vec accepted);

/// Makes the checkpoint's state the last accepted one, on any number of ranks: unknowns, pairs, problem and books.
/// Throws UserError when a pair's points are not those of the checkpoint. Collective.
void restore_state(Scene& scene, Ledger& ledger, const Checkpoint& checkpoint, Vec unknowns);

} // namespace amontons
