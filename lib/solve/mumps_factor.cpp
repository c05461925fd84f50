#include "solve/mumps_factor.hpp"

#include "base/timer.hpp"
#include "solve/factor_memory.hpp"

#include <algorithm>

namespace amontons {

MatHandle symmetric_part(Mat matrix) {
  MatHandle part;
  AMT_PETSC(MatTranspose(matrix, MAT_INITIAL_MATRIX, part.put()));
  AMT_PETSC(MatAXPY(part, 1.0, matrix, UNKNOWN_NONZERO_PATTERN));
  AMT_PETSC(MatScale(part, 0.5));
  return part;
}

bool MumpsFactor::factorize(Mat source, PetscObjectState pattern, Kind kind, IS kept) {
  const Phase phase("factorization");
  const bool is_symmetric = kind == Kind::Symmetric;
  MatFactorInfo info;
  AMT_PETSC(MatFactorInfoInitialize(&info));
  if (!factor_ || pattern != pattern_ || kind != kind_ || kept) {
    AMT_PETSC(MatGetFactor(source, MATSOLVERMUMPS, is_symmetric ? MAT_FACTOR_CHOLESKY : MAT_FACTOR_LU, factor_.put()));
    if (kept) AMT_PETSC(MatFactorSetSchurIS(factor_, kept));
    if (is_symmetric)
      AMT_PETSC(MatCholeskyFactorSymbolic(factor_, source, nullptr, &info));
    else
      AMT_PETSC(MatLUFactorSymbolic(factor_, source, nullptr, nullptr, &info));
  }
  if (is_symmetric)
    AMT_PETSC(MatCholeskyFactorNumeric(factor_, source, &info));
  else
    AMT_PETSC(MatLUFactorNumeric(factor_, source, &info));
  pattern_ = pattern;
  kind_ = kind;
  MatFactorError error = MAT_FACTOR_NOERROR;
  AMT_PETSC(MatFactorGetError(factor_, &error));
  if (error == MAT_FACTOR_NOERROR) return true;
  refuse_lack_of_memory(factor_);
  factor_.reset();
  return false;
}

double MumpsFactor::operations() const {
  PetscReal operations = 0.0;
  AMT_PETSC(MatMumpsGetRinfog(factor_, 3, &operations));
  return operations;
}

double MumpsFactor::entries() const {
  PetscInt entries = 0;
  AMT_PETSC(MatMumpsGetInfog(factor_, 29, &entries));
  // MUMPS gives large counts as minus millions.
  return entries < 0 ? -1e6 * entries : std::max<PetscInt>(entries, 1);
}

} // namespace amontons
