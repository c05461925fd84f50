#include "solve/tangent_solver.hpp"

#include "base/error.hpp"
#include "solve/kept_factorization.hpp"
#include "solve/schur_factorization.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace amontons {

namespace {

/// The last solve goes this far below the tolerance of Newton's method.
constexpr double overshoot = 1e-2;

} // namespace

TangentSolver::TangentSolver(const Problem& problem, SNES snes)
    : problem_(problem), snes_(snes), defect_(problem.layout().new_vector()) {
  KSP ksp = nullptr;
  PC pc = nullptr;
  AMT_PETSC(SNESGetKSP(snes, &ksp));
  AMT_PETSC(KSPGetPC(ksp, &pc));
  AMT_PETSC(PCShellSetContext(pc, this));
  AMT_PETSC(PCShellSetApply(pc, apply));
  AMT_PETSC(SNESGetJacobian(snes, &matrix_, nullptr, nullptr, nullptr));
}

void TangentSolver::begin() {
  factorizations_ = iterations_ = 0;
  caught_ = nullptr;
}

void TangentSolver::rethrow() const {
  if (caught_) std::rethrow_exception(caught_);
}

PetscErrorCode TangentSolver::apply(PC shell, Vec right, Vec solution) {
  void* self = nullptr;
  PetscCall(PCShellGetContext(shell, &self));
  auto& solver = *static_cast<TangentSolver*>(self);
  return guarded(solver.caught_, [&] {
    const bool is_solved = solver.solve(right, solution);
    AMT_PETSC(PCSetFailedReason(shell, is_solved ? PC_NOERROR : PC_SUBPC_ERROR));
  });
}

double TangentSolver::smallest_residual() const {
  PetscReal rtol = 0.0;
  AMT_PETSC(SNESGetTolerances(snes_, nullptr, &rtol, nullptr, nullptr, nullptr));
  return std::max(overshoot * rtol * problem_.force_scale(), problem_.rounding());
}

double TangentSolver::measure_defect(Vec right, Vec solution) {
  PetscReal norm = 0.0;
  AMT_PETSC(MatMult(matrix_, solution, defect_));
  AMT_PETSC(VecAYPX(defect_, -1.0, right));
  AMT_PETSC(VecNorm(defect_, NORM_2, &norm));
  return norm;
}

std::unique_ptr<TangentSolver> new_tangent_solver(const Problem& problem, SNES snes) {
  KSP ksp = nullptr;
  PC pc = nullptr;
  PetscBool is_shell = PETSC_FALSE;
  AMT_PETSC(SNESGetKSP(snes, &ksp));
  AMT_PETSC(KSPGetPC(ksp, &pc));
  AMT_PETSC(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCSHELL, &is_shell));
  if (!is_shell) return nullptr;
  std::array<char, 64> name{"kept"};
  AMT_PETSC(PetscOptionsGetString(nullptr, nullptr, "-shell_solver", name.data(), name.size(), nullptr));
  const std::string kind = name.data();
  if (kind == "kept") return std::make_unique<KeptFactorization>(problem, snes);
  if (kind == "schur") return std::make_unique<SchurFactorization>(problem, snes);
  throw UserError("-shell_solver " + kind + ": there is no such solver. Use kept or schur.");
}

} // namespace amontons
