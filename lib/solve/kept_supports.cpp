#include "solve/kept_supports.hpp"

#include <vector>

namespace amontons {

namespace {

PetscErrorCode clear_step(SNESLineSearch, Vec, Vec step, PetscBool* changed, void* problem) {
  std::exception_ptr known_by_its_code;
  *changed = PETSC_TRUE;
  return guarded(known_by_its_code, [&] { clear_prescribed(*static_cast<const Problem*>(problem), step); });
}

} // namespace

void clear_prescribed(const Problem& problem, Vec step) {
  const PetscInt first = problem.layout().first_equation();
  VecArray values(step);
  for (PetscInt i = 0; i < values.size(); ++i)
    if (problem.is_prescribed(first + i)) values[i] = 0.0;
}

void keep_supports(SNES snes, const Problem& problem) {
  SNESLineSearch search = nullptr;
  AMT_PETSC(SNESGetLineSearch(snes, &search));
  AMT_PETSC(SNESLineSearchSetPreCheck(search, clear_step, const_cast<Problem*>(&problem)));
}

NullSpaceHandle modes_beside_supports(const Problem& problem, MatNullSpace modes) {
  constexpr double nothing_left = 1e-6; // of a mode of length one
  const Vec* given = nullptr;
  PetscInt size = 0;
  AMT_PETSC(MatNullSpaceGetVecs(modes, nullptr, &size, &given));
  std::vector<VecHandle> owned;
  std::vector<Vec> kept;
  for (PetscInt i = 0; i < size; ++i) {
    VecHandle mode = problem.layout().new_vector();
    AMT_PETSC(VecCopy(given[i], mode));
    clear_prescribed(problem, mode);
    for (int repeated = 0; repeated < 2; ++repeated) // once leaves rounding of what is taken off
      for (const Vec other : kept) {
        PetscScalar along = 0.0;
        AMT_PETSC(VecDot(mode, other, &along));
        AMT_PETSC(VecAXPY(mode, -along, other));
      }
    PetscReal length = 0.0;
    AMT_PETSC(VecNormalize(mode, &length));
    if (length < nothing_left) continue;
    kept.push_back(mode);
    owned.push_back(std::move(mode));
  }
  NullSpaceHandle found;
  AMT_PETSC(
      MatNullSpaceCreate(problem.comm(), PETSC_FALSE, static_cast<PetscInt>(kept.size()), kept.data(), found.put()));
  return found;
}

} // namespace amontons
