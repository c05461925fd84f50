#include "solve/solver_choice.hpp"

#include "base/log.hpp"
#include "solve/light_multigrid.hpp"
#include "solve/newton.hpp"
#include "solve/schur_factorization.hpp"

#include <array>
#include <cmath>
#include <unistd.h>

namespace amontons {

namespace {

/// Unknowns above which factorizations cost more than about 15 back-substitutions.
constexpr PetscInt kept_from_2d = 400'000;
constexpr PetscInt kept_from_3d = 20'000;
/// Bytes an unknown that a run with multigrid on several ranks takes in 3D (measured: 3.9 kB at 682,000 unknowns), and
/// the part of the memory up to which that is no matter. Coarse matrices made "all at once" save 1.2 kB of them, and a
/// set-up takes five times as long.
constexpr double bytes_with_multigrid = 4000.0, memory_at_ease = 0.85;

/// Operations of a symmetric factorization by MUMPS with SCOTCH over the power of the unknowns with which they grow:
/// 71 to 81 in 2D (17,000 to 69,000 unknowns), 12 to 16 in 3D (3,000 to 25,000).
constexpr double operations_2d = 75.0, operations_3d = 15.0;

/// Does a dense factorization of the equations that change cost less than a sparse one of all? The first of them is
/// dense in all of these, later ones in those that have really changed (SchurFactorization).
bool condensing_pays(const Problem& problem) {
  const auto& layout = problem.layout();
  const auto size = static_cast<double>(layout.num_global());
  const double sparse = (problem.tangent_is_symmetric() ? 1.0 : 2.0) *
                        (layout.dim() == 2 ? operations_2d * std::pow(size, 1.5) : operations_3d * std::pow(size, 2.0));
  const double dense = 2.0 / 3.0 * std::pow(static_cast<double>(problem.changing_equations().size()), 3.0);
  return dense <= sparse;
}

/// Bytes that the machines of these ranks have. Collective.
double memory_of_machines(MPI_Comm comm) {
  MPI_Comm neighbours = MPI_COMM_NULL;
  int ranks_here = 1;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &neighbours);
  MPI_Comm_size(neighbours, &ranks_here);
  MPI_Comm_free(&neighbours);
  double bytes =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE)) / ranks_here;
  MPI_Allreduce(MPI_IN_PLACE, &bytes, 1, MPI_DOUBLE, MPI_SUM, comm);
  return bytes;
}

std::string option(const char* name) {
  std::array<char, 64> value{};
  AMT_PETSC(PetscOptionsGetString(nullptr, nullptr, name, value.data(), value.size(), nullptr));
  return value.data();
}

} // namespace

std::string choose_newton_solver(const Problem& problem) {
  const auto& layout = problem.layout();
  const PetscInt size = layout.num_global();
  const bool is_free = option("-pc_type").empty() && option("-ksp_type").empty();
  // Multigrid's smoother; bounds have another (bounded_newton): README.md.
  register_icc_single();
  if (layout.num_extra() == 0 && problem.tangent_is_symmetric()) default_option("-mg_levels_pc_type", pc_icc_single);
  auto words = choose_linear_solver(problem);
  const bool is_direct = option("-pc_type") == PCCHOLESKY || option("-pc_type") == PCLU;
  const bool is_2d = layout.dim() == 2;
  const bool is_displacement_only = layout.num_extra() == 0;
  if (is_free && is_direct && is_displacement_only && !is_2d && size > krylov_from_3d) {
    AMT_PETSC(PetscOptionsSetValue(nullptr, "-pc_type", PCGAMG));
    AMT_PETSC(PetscOptionsSetValue(nullptr, "-ksp_type", problem.tangent_is_symmetric() ? KSPCG : KSPGMRES));
    default_option("-ksp_max_it", "2000");
    words = "smoothed-aggregation multigrid with conjugate gradients or GMRES";
  } else if (is_free && is_direct && can_condense(problem) && condensing_pays(problem)) {
    AMT_PETSC(PetscOptionsSetValue(nullptr, "-pc_type", PCSHELL));
    default_option("-shell_solver", "schur");
    words = formatted("MUMPS once, condensed onto %d equations of contact",
                      static_cast<int>(problem.changing_equations().size()));
  } else if (is_free && is_direct && size > (is_2d ? kept_from_2d : kept_from_3d)) {
    AMT_PETSC(PetscOptionsSetValue(nullptr, "-pc_type", PCSHELL));
    words = "MUMPS, symmetric factorizations kept over several tangents, with FGMRES";
  }
  if (is_free && option("-ksp_type") != KSPPREONLY) { // a solve goes as far as Newton's method can use
    default_option("-snes_ksp_ew", "true");
    default_option("-snes_ksp_ew_rtol0", "1e-2");
    default_option("-snes_ksp_ew_rtolmax", "1e-2");
    // Residuals as Newton's method measures them, so that a solve can be told where to stop
    // (Newton::limit_linear_solve).
    if (option("-ksp_type") == KSPCG) default_option("-ksp_norm_type", "unpreconditioned");
    if (option("-ksp_type") == KSPGMRES) {
      default_option("-ksp_gmres_restart", "40");
      default_option("-ksp_pc_side", "right");
    }
    int ranks = 1;
    MPI_Comm_size(problem.comm(), &ranks);
    // PETSc 3.18 has this for several ranks only.
    if (ranks > 1 && size * bytes_with_multigrid > memory_at_ease * memory_of_machines(problem.comm()))
      default_option("-matptap_via", "allatonce");
  }
  return words;
}

} // namespace amontons
