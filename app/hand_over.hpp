// Commands that are scripts: they run this program many times, each time as its own processes.
#pragma once

#include <string>
#include <vector>

namespace amontons {

/// Becomes `scripts/NAME WORDS... --program PROGRAM` of the checkout that this program was built from. To be called
/// before MPI begins. Returns only if that fails, with the exit status, after an error on stderr; also under mpirun,
/// where every rank would start runs of its own.
int hand_over_to_script(const std::string& name, std::vector<std::string> words);

} // namespace amontons
