// Bodies that share nodes are welded together: for balances and contact they are one.
#pragma once

#include "mesh/mesh.hpp"

#include <vector>

namespace amontons {

/// For each body the first body of the set that it forms with those it shares nodes with, directly or in a chain.
/// Collective.
std::vector<std::int32_t> welded_bodies(const Mesh& mesh);

} // namespace amontons
