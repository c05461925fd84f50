// What to say when a factorization has run out of memory: neither another iterate nor a smaller increment helps then,
// so it is an error of the user's and not an outcome of the solve.
#pragma once

#include "base/petsc.hpp"

namespace amontons {

/// Throws UserError, the same on every rank, if the factorization was given up for want of memory: how much it needs by
/// MUMPS's own estimate, and what to change. Nothing for a sound factor, a singular matrix or another package. The
/// codes are those of MUMPS 5.5, User's guide, section 8. Collective.
void refuse_lack_of_memory(Mat factor);

/// The same for the factorization that the linear solver of a SNES uses, if it uses one. Collective.
void refuse_lack_of_memory(SNES snes);

} // namespace amontons
