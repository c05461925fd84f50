// What a .geo script offers to its user, found by reading its text: gmsh itself silently ignores values for names that
// a script does not have.
#pragma once

#include <string>
#include <vector>

namespace amontons {

/// The names that the script and the files that it includes declare in `DefineConstant[...]` or ask for by
/// `Exists(...)`, each once, in order of appearance. An unreadable file has none.
std::vector<std::string> geo_parameters(const std::string& file);

} // namespace amontons
