#include "solve/whole_preconditioner.hpp"

#include "solve/shell_preconditioner.hpp"

namespace amontons {

WholePreconditioner::WholePreconditioner(SNES snes) : snes_(snes) {
  KSP ksp = nullptr;
  AMT_PETSC(SNESGetKSP(snes, &ksp));
  type_ = take_place_of_preconditioner(ksp, "whole_", this, set_up, apply);
}

PetscErrorCode WholePreconditioner::set_up(PC pc) {
  return with_context<WholePreconditioner>(pc, [](WholePreconditioner& self) { self.rebuild(); });
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
  return with_context<WholePreconditioner>(pc, [&](WholePreconditioner& self) {
    AMT_PETSC(VecSet(self.in_, 0.0));
    AMT_PETSC(VecScatterBegin(self.scatter_, in, self.in_, INSERT_VALUES, SCATTER_REVERSE));
    AMT_PETSC(VecScatterEnd(self.scatter_, in, self.in_, INSERT_VALUES, SCATTER_REVERSE));
    AMT_PETSC(PCApply(self.inner_, self.in_, self.out_));
    AMT_PETSC(VecScatterBegin(self.scatter_, self.out_, out, INSERT_VALUES, SCATTER_FORWARD));
    AMT_PETSC(VecScatterEnd(self.scatter_, self.out_, out, INSERT_VALUES, SCATTER_FORWARD));
  });
}

} // namespace amontons
