#include "solve/shell_preconditioner.hpp"

namespace amontons {

std::string take_place_of_preconditioner(KSP solver, const char* prefix, void* self, PetscErrorCode (*set_up)(PC),
                                         PetscErrorCode (*apply)(PC, Vec, Vec)) {
  PC pc = nullptr;
  PCType type = nullptr;
  AMT_PETSC(KSPGetPC(solver, &pc));
  AMT_PETSC(PCGetType(pc, &type));
  const std::string had = type;
  AMT_PETSC(PCSetType(pc, PCSHELL));
  AMT_PETSC(PCSetOptionsPrefix(pc, prefix));
  AMT_PETSC(PCShellSetContext(pc, self));
  AMT_PETSC(PCShellSetSetUp(pc, set_up));
  AMT_PETSC(PCShellSetApply(pc, apply));
  return had;
}

} // namespace amontons
