// Which cells face each other across surfaces that are expected to touch: a rough, serial guess for the partition, not
// the contact search.
#pragma once

#include "mesh/build.hpp"

namespace amontons {

/// For each facet of either surface of a hint the nearest facet of the other (by centroids) no farther away than the
/// sum of their sizes: the two cells. Names that the mesh lacks are skipped.
std::vector<std::array<std::int64_t, 2>> facing_cells(const RawMesh& raw, const ContactHints& hints);

} // namespace amontons
