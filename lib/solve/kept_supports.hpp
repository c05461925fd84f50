// Steps that leave prescribed displacements alone. Their equations are coupled with nothing in a tangent, so the steps
// of factorizations are zero there; but coarse corrections of multigrid reach them, and what a solve that is not exact
// leaves there no residual shows.
#pragma once

#include "form/problem.hpp"

#include <petscsnes.h>

namespace amontons {

/// Puts zeros into the equations of prescribed displacements.
void clear_prescribed(const Problem& problem, Vec step);

/// Has every line search of this SNES begin with that. One of one's own calls clear_prescribed or
/// SNESLineSearchPreCheck. The problem must outlive the SNES.
void keep_supports(SNES snes, const Problem& problem);

/// Modes from which multigrid makes its coarse corrections, zero in the equations of prescribed displacements and
/// orthonormal again; those with nothing left are left out. Corrections then move hardly anything that is prescribed,
/// and where supports are near they are of more use: on a quarter of `hertz_3d` 41 iterations instead of 54.
/// Collective.
NullSpaceHandle modes_beside_supports(const Problem& problem, MatNullSpace modes);

} // namespace amontons
