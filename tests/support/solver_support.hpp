// What tests of whole solves share.
#pragma once

#include <petscvec.h>

namespace amontons::test {

/// Takes away what solvers have put among PETSc's options: the next test starts without.
struct OptionScope {
  OptionScope() { PetscOptionsPush(options()); }
  ~OptionScope() { PetscOptionsPop(); }
  OptionScope(const OptionScope&) = delete;
  OptionScope& operator=(const OptionScope&) = delete;

 private:
  static PetscOptions options() {
    PetscOptions fresh = nullptr;
    PetscOptionsCreate(&fresh);
    return fresh;
  }
};

/// Largest absolute value of a vector. Collective.
inline double largest(Vec vec) {
  double value = 0.0;
  VecNorm(vec, NORM_INFINITY, &value);
  return value;
}

} // namespace amontons::test
