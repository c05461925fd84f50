#include "solve/preconditioner_lag.hpp"

#include <cmath>

namespace amontons {

namespace {

/// What a set-up of multigrid costs in large runs, in iterations (README.md).
constexpr double price = 50.0;

/// Powers of ten by which the last solve has made the residual smaller.
double digits_gained(KSP ksp, double norm) {
  KSPNormType kind = KSP_NORM_DEFAULT;
  PetscReal rtol = 0.0, left = 0.0;
  AMT_PETSC(KSPGetNormType(ksp, &kind));
  AMT_PETSC(KSPGetTolerances(ksp, &rtol, nullptr, nullptr, nullptr));
  AMT_PETSC(KSPGetResidualNorm(ksp, &left));
  // Of preconditioned residuals only the tolerance is known, as Eisenstat and Walker's rule had set it.
  return kind == KSP_NORM_UNPRECONDITIONED && left > 0.0 ? std::log10(norm / left) : -std::log10(rtol);
}

} // namespace

bool PreconditionerLag::applies_to(SNES snes) {
  KSP ksp = nullptr;
  PC pc = nullptr;
  PetscBool is_preonly = PETSC_FALSE, is_factorization = PETSC_FALSE;
  AMT_PETSC(SNESGetKSP(snes, &ksp));
  AMT_PETSC(KSPGetPC(ksp, &pc));
  AMT_PETSC(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(ksp), KSPPREONLY, &is_preonly));
  AMT_PETSC(PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(pc), &is_factorization, PCLU, PCCHOLESKY, PCREDUNDANT, ""));
  return !is_preonly && !is_factorization;
}

void PreconditionerLag::decide(SNES snes, double norm) {
  KSP ksp = nullptr;
  PetscInt iterations = 0;
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  AMT_PETSC(SNESGetKSP(snes, &ksp));
  AMT_PETSC(KSPGetIterationNumber(ksp, &iterations));
  AMT_PETSC(KSPGetConvergedReason(ksp, &reason));
  const double digits = std::max(0.5, digits_gained(ksp, norm));
  if (first_rate_ > 0.0)
    spent_ += std::max(0.0, iterations - digits * first_rate_);
  else
    first_rate_ = iterations / digits;
  rebuilds_ = !is_set_up_ || reason < 0 || spent_ > price;
  if (rebuilds_) first_rate_ = spent_ = 0.0;
  is_set_up_ = true;
  AMT_PETSC(SNESSetLagPreconditioner(snes, rebuilds_ ? -2 : -1));
}

} // namespace amontons
