// Which linear solver Newton's method uses where the user has not said so: by size, dimension and formulation.
#pragma once

#include "form/problem.hpp"

#include <string>

namespace amontons {

/// Sets the defaults of choose_linear_solver() and, for problems where they would be slow, those of KeptFactorization
/// (`-pc_type shell`) or, for displacements only, of multigrid. What the user has asked for stays. Returns in words
/// what was chosen.
std::string choose_newton_solver(const Problem& problem);

} // namespace amontons
