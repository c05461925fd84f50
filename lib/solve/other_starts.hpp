// Starts of an increment that are far from the last accepted state. With friction, and in large deformations, an
// increment may have several solutions (A. Klarbring, Ing.-Arch. 60 (1990) 529-541); Newton's method finds the one that
// its start leads to.
#pragma once

#include "solve/newton.hpp"

#include <array>
#include <variant>

namespace amontons {

/// Equilibrium with every contact point held open.
struct AllOpen {};
/// Equilibrium without friction, reached from the one with all points open.
struct Frictionless {};
using OtherStart = std::variant<AllOpen, Frictionless>;

const std::array<OtherStart, std::variant_size_v<OtherStart>>& other_starts();

/// Takes the unknowns, at the start of an increment, to this start; every hold is let go again. The effort, and whether
/// there is such an equilibrium. Collective.
SolveOutcome go_to(const OtherStart& start, Problem& problem, Newton& newton, Vec unknowns);

} // namespace amontons
