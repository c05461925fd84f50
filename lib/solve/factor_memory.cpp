#include "solve/factor_memory.hpp"

#include "base/error.hpp"
#include "base/log.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace amontons {

namespace {

// INFOG(1): workspaces too small, allocations that failed, the limit ICNTL(23) too small, integers too small for sizes.
constexpr std::array lack_of_memory = {-5, -7, -8, -9, -11, -12, -13, -14, -15, -18, -19};
constexpr PetscInt workspace_too_small = -9;
// Where MUMPS keeps what is asked here: estimates of INFOG in MB, options of ICNTL.
constexpr PetscInt largest_estimate = 16, whole_estimate = 17, limit_option = 23, spare_option = 14;

} // namespace

void refuse_lack_of_memory(Mat factor) {
  MatSolverType type = nullptr;
  AMT_PETSC(MatFactorGetSolverType(factor, &type));
  if (!type || std::string(type) != MATSOLVERMUMPS) return;
  PetscInt code = 0, largest = 0, whole = 0, limit = 0, spare = 0;
  AMT_PETSC(MatMumpsGetInfog(factor, 1, &code));
  if (std::find(lack_of_memory.begin(), lack_of_memory.end(), code) == lack_of_memory.end()) return;
  AMT_PETSC(MatMumpsGetInfog(factor, largest_estimate, &largest));
  AMT_PETSC(MatMumpsGetInfog(factor, whole_estimate, &whole));
  AMT_PETSC(MatMumpsGetIcntl(factor, limit_option, &limit));
  AMT_PETSC(MatMumpsGetIcntl(factor, spare_option, &spare));
  std::string text =
      formatted("The factorization ran out of memory (MUMPS: INFOG(1) = %d). By its own estimate it needs "
                "%d MB on the largest rank and %d MB in all",
                static_cast<int>(code), static_cast<int>(largest), static_cast<int>(whole));
  if (limit > 0)
    text += formatted("; -mat_mumps_icntl_23 allows %d MB on each rank. Raise it.", static_cast<int>(limit));
  else if (code == workspace_too_small)
    text += formatted("; with %d %% to spare that was not enough. Give more with -mat_mumps_icntl_14.",
                      static_cast<int>(spare));
  else
    text += ", which the machine does not have.";
  throw UserError(text +
                  " Use more ranks on more machines, or a coarser mesh, or keep the factors on disk "
                  "(-mat_mumps_icntl_22 1), or do without a factorization (`enforce: {uzawa: {}}` and -pc_type gamg).");
}

void refuse_lack_of_memory(SNES snes) {
  KSP ksp = nullptr;
  PC pc = nullptr;
  PetscBool is_lu = PETSC_FALSE, is_cholesky = PETSC_FALSE;
  AMT_PETSC(SNESGetKSP(snes, &ksp));
  AMT_PETSC(KSPGetPC(ksp, &pc));
  AMT_PETSC(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCLU, &is_lu));
  AMT_PETSC(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCCHOLESKY, &is_cholesky));
  if (!is_lu && !is_cholesky) return;
  Mat factor = nullptr;
  AMT_PETSC(PCFactorGetMatrix(pc, &factor));
  if (factor) refuse_lack_of_memory(factor);
}

} // namespace amontons
