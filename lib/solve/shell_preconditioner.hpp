// What preconditioners of ours that stand around one of PETSc's have in common: they take its place in a solver, keep
// its type and options, and are called back by PETSc. Knows no problem.
#pragma once

#include "base/petsc.hpp"

#include <string>

namespace amontons {

/// Makes the solver's preconditioner a shell with these callbacks and `self` as its context, and tells what type it
/// had. PETSc reads the options again later: those of the shell begin with `prefix`, so that -pc_type is the inner
/// one's. Collective.
std::string take_place_of_preconditioner(KSP solver, const char* prefix, void* self, PetscErrorCode (*set_up)(PC),
                                         PetscErrorCode (*apply)(PC, Vec, Vec));

/// Runs `work` with the shell's context, as a callback.
template <class Self, class Work>
PetscErrorCode with_context(PC shell, Work&& work) {
  void* self = nullptr;
  PCShellGetContext(shell, &self);
  std::exception_ptr known_by_its_code;
  return guarded(known_by_its_code, [&] { work(*static_cast<Self*>(self)); });
}

} // namespace amontons
