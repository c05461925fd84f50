#include "solve/changed_problem.hpp"

#include "base/timer.hpp"
#include "solve/newton.hpp"

#include <vector>

namespace amontons {

ChangedProblem::ChangedProblem(Problem& problem)
    : problem_(problem), tangent_(problem.new_matrix()), unknowns_(problem.layout().new_vector()),
      residual_(problem.layout().new_vector()) {}

void ChangedProblem::take_transform(Mat transform, Mat inverse) {
  transform_ = transform;
  inverse_ = inverse;
  AMT_PETSC(MatDuplicate(transform, MAT_COPY_VALUES, variation_.put()));
  const auto varies = problem_.layout().new_vector(), diagonal = problem_.layout().new_vector();
  AMT_PETSC(MatGetDiagonal(variation_, diagonal));
  {
    VecArray flags(varies), kept(diagonal);
    const PetscInt first = problem_.layout().first_equation();
    for (PetscInt i = 0; i < flags.size(); ++i) {
      flags[i] = problem_.is_prescribed(first + i) ? 0.0 : 1.0;
      if (flags[i] == 0.0) kept[i] = 1.0;
    }
  }
  AMT_PETSC(MatDiagonalScale(variation_, nullptr, varies));
  AMT_PETSC(MatDiagonalSet(variation_, diagonal, INSERT_VALUES));
  changed_tangent_.reset();
}

bool ChangedProblem::tangent_at(Vec unknowns) {
  if (!problem_.tangent(unknowns, tangent_) && changed_tangent_) return false;
  const Phase phase("matrix");
  if (changed_tangent_) { // the pattern is that of the last one
    Mat matrix = changed_tangent_;
    AMT_PETSC(MatPtAP(tangent_, variation_, MAT_REUSE_MATRIX, PETSC_DEFAULT, &matrix));
  } else {
    AMT_PETSC(MatPtAP(tangent_, variation_, MAT_INITIAL_MATRIX, PETSC_DEFAULT, changed_tangent_.put()));
  }
  AMT_PETSC(MatSetOption(changed_tangent_, MAT_SYMMETRIC, PETSC_TRUE));
  return true;
}

bool ChangedProblem::tangent(Vec changed) {
  AMT_PETSC(MatMult(transform_, changed, unknowns_));
  return tangent_at(unknowns_);
}

bool ChangedProblem::residual(Vec changed, Vec result) {
  AMT_PETSC(MatMult(transform_, changed, unknowns_));
  const bool exists = problem_.residual(unknowns_, residual_);
  AMT_PETSC(MatMultTranspose(variation_, residual_, result));
  return exists;
}

void ChangedProblem::to_changed(Vec unknowns, Vec changed) const { AMT_PETSC(MatMult(inverse_, unknowns, changed)); }

/// K + T⁻ᵀ D T⁻¹, D the diagonal of Tᵀ K T where û is held: springs that are as stiff as the body there.
std::vector<FreeMotion> ChangedProblem::free_motions(Vec held) const {
  const auto springs = problem_.layout().new_vector();
  AMT_PETSC(MatGetDiagonal(changed_tangent_, springs));
  AMT_PETSC(VecPointwiseMult(springs, springs, held));
  AMT_PETSC(VecSqrtAbs(springs));
  MatHandle root, supported;
  AMT_PETSC(MatDuplicate(inverse_, MAT_COPY_VALUES, root.put()));
  AMT_PETSC(MatDiagonalScale(root, springs, nullptr));
  AMT_PETSC(MatTransposeMatMult(root, root, MAT_INITIAL_MATRIX, PETSC_DEFAULT, supported.put()));
  AMT_PETSC(MatAXPY(supported, 1.0, tangent_, DIFFERENT_NONZERO_PATTERN));
  return find_free_motions(problem_, supported);
}

NullSpaceHandle ChangedProblem::modes() const {
  const auto motions = rigid_body_modes(problem_.layout());
  PetscInt count = 0;
  const Vec* vectors = nullptr;
  AMT_PETSC(MatNullSpaceGetVecs(motions, nullptr, &count, &vectors));
  std::vector<VecHandle> changed;
  std::vector<Vec> basis;
  for (PetscInt i = 0; i < count; ++i) {
    changed.push_back(problem_.layout().new_vector());
    to_changed(vectors[i], changed.back());
    for (const Vec other : basis) { // Gram-Schmidt
      PetscScalar along = 0.0;
      AMT_PETSC(VecDot(changed.back(), other, &along));
      AMT_PETSC(VecAXPY(changed.back(), -along, other));
    }
    AMT_PETSC(VecNormalize(changed.back(), nullptr));
    basis.push_back(changed.back());
  }
  NullSpaceHandle space;
  AMT_PETSC(MatNullSpaceCreate(problem_.comm(), PETSC_FALSE, count, basis.data(), space.put()));
  return space;
}

} // namespace amontons
