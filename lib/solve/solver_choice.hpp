// Which linear solver Newton's method uses where the user has not said so: by size, dimension and formulation.
#pragma once

#include "form/problem.hpp"

#include <string>

namespace amontons {

/// Unknowns above which displacement-only problems in 3D go to a Krylov method with multigrid.
inline constexpr PetscInt krylov_from_3d = 50'000;

/// Sets the defaults of choose_linear_solver() and, for problems where they would be slow, those of KeptFactorization
/// (`-pc_type shell`) or, for displacements only, of multigrid. What the user has asked for stays. Returns in words
/// what was chosen.
std::string choose_newton_solver(const Problem& problem);

} // namespace amontons
