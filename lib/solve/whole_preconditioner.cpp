#include "solve/whole_preconditioner.hpp"

namespace amontons {

WholePreconditioner::WholePreconditioner(SNES snes) : snes_(snes) {
  KSP ksp = nullptr;
  PC pc = nullptr;
  PCType type = nullptr;
  AMT_PETSC(SNESGetKSP(snes, &ksp));
  AMT_PETSC(KSPGetPC(ksp, &pc));
  AMT_PETSC(PCGetType(pc, &type));
  type_ = type;
  AMT_PETSC(PCSetType(pc, PCSHELL));
  AMT_PETSC(PCSetOptionsPrefix(pc, "whole_")); // PETSc reads the options again later: -pc_type is the inner one's
  AMT_PETSC(PCShellSetContext(pc, this));
  AMT_PETSC(PCShellSetSetUp(pc, set_up));
  AMT_PETSC(PCShellSetApply(pc, apply));
}

PetscErrorCode WholePreconditioner::set_up(PC pc) {
  void* self = nullptr;
  PCShellGetContext(pc, &self);
  auto& preconditioner = *static_cast<WholePreconditioner*>(self);
  std::exception_ptr known_by_its_code;
  return guarded(known_by_its_code, [&] { preconditioner.rebuild(); });
}

void WholePreconditioner::rebuild() {
  IS inactive = nullptr;
  Mat whole = nullptr;
  AMT_PETSC(SNESVIGetInactiveSet(snes_, &inactive));
  AMT_PETSC(SNESGetJacobian(snes_, &whole, nullptr, nullptr, nullptr));
  AMT_PETSC(MatCreateVecs(whole, in_.put(), out_.put()));
  PetscInt begin = 0, end = 0, size = 0;
  AMT_PETSC(VecGetOwnershipRange(in_, &begin, &end));
  IsHandle active;
  AMT_PETSC(ISComplement(inactive, begin, end, active.put()));
  AMT_PETSC(MatDuplicate(whole, MAT_COPY_VALUES, matrix_.put()));
  PetscScalar trace = 0.0;
  AMT_PETSC(MatGetTrace(matrix_, &trace));
  AMT_PETSC(VecGetSize(in_, &size));
  AMT_PETSC(MatSetOption(matrix_, MAT_KEEP_NONZERO_PATTERN, PETSC_TRUE));
  AMT_PETSC(MatZeroRowsColumnsIS(matrix_, active, trace / static_cast<double>(size), nullptr, nullptr));
  AMT_PETSC(MatSetNearNullSpace(matrix_, modes_));
  AMT_PETSC(MatSetOption(matrix_, MAT_SPD, PETSC_TRUE));

  PetscInt reduced = 0;
  AMT_PETSC(ISGetLocalSize(inactive, &reduced));
  VecHandle small;
  AMT_PETSC(VecCreateMPI(PetscObjectComm(reinterpret_cast<PetscObject>(whole)), reduced, PETSC_DETERMINE, small.put()));
  AMT_PETSC(VecScatterCreate(in_, inactive, small, nullptr, scatter_.put()));

  AMT_PETSC(PCCreate(PetscObjectComm(reinterpret_cast<PetscObject>(whole)), inner_.put()));
  AMT_PETSC(PCSetOperators(inner_, matrix_, matrix_));
  AMT_PETSC(PCSetType(inner_, type_.c_str()));
  AMT_PETSC(PCSetFromOptions(inner_));
  AMT_PETSC(PCSetUp(inner_));
}

PetscErrorCode WholePreconditioner::apply(PC pc, Vec in, Vec out) {
  void* self = nullptr;
  PCShellGetContext(pc, &self);
  auto& preconditioner = *static_cast<WholePreconditioner*>(self);
  std::exception_ptr known_by_its_code;
  return guarded(known_by_its_code, [&] {
    AMT_PETSC(VecSet(preconditioner.in_, 0.0));
    AMT_PETSC(VecScatterBegin(preconditioner.scatter_, in, preconditioner.in_, INSERT_VALUES, SCATTER_REVERSE));
    AMT_PETSC(VecScatterEnd(preconditioner.scatter_, in, preconditioner.in_, INSERT_VALUES, SCATTER_REVERSE));
    AMT_PETSC(PCApply(preconditioner.inner_, preconditioner.in_, preconditioner.out_));
    AMT_PETSC(VecScatterBegin(preconditioner.scatter_, preconditioner.out_, out, INSERT_VALUES, SCATTER_FORWARD));
    AMT_PETSC(VecScatterEnd(preconditioner.scatter_, preconditioner.out_, out, INSERT_VALUES, SCATTER_FORWARD));
  });
}

} // namespace amontons
