#include "base/petsc.hpp"

#include <string>

namespace amontons {

PetscFailure::PetscFailure(PetscErrorCode code, const char* call, const char* file, int line)
    : std::runtime_error(std::string("PETSc error ") + std::to_string(code) + " from " + call + " (" + file + ":" +
                         std::to_string(line) + ")"),
      code_(code) {}

} // namespace amontons
