// Multigrid that smooths with numbers of single precision: the products of its finest level, and incomplete Cholesky
// factors as a PC that PETSc's options can choose. Hierarchy, cycle and Chebyshev's method are PETSc's, whose numbers
// have one precision a build. What is solved stays double: this is a preconditioner. Knows no problem of ours.
#pragma once

#include "base/petsc.hpp"
#include "solve/single_precision.hpp"

#include <optional>
#include <string>

namespace amontons {

/// Name of the PC of incomplete Cholesky factors, each rank's of its own block: `-mg_levels_pc_type icc_single`.
inline constexpr const char* pc_icc_single = "icc_single";
/// Makes it known to PETSc.
void register_icc_single();

/// Products with an AIJ matrix of any number of ranks, as a matrix of PETSc with numbers of single precision.
class SinglePrecisionProduct {
 public:
  /// Collective.
  explicit SinglePrecisionProduct(Mat matrix);
  SinglePrecisionProduct(const SinglePrecisionProduct&) = delete;
  SinglePrecisionProduct& operator=(const SinglePrecisionProduct&) = delete;
  /// Has the matrix another pattern now? The same on every rank.
  bool is_outdated() const;
  /// Takes the matrix's numbers if they have changed since; true if so. Collective.
  bool update();
  operator Mat() const { return shell_; }

 private:
  static PetscErrorCode multiply(Mat, Vec x, Vec y);
  Mat matrix_; // not owned
  PetscObjectState state_ = 0, pattern_ = 0;
  MatHandle shell_;
  std::optional<SinglePrecisionMatrix> own_, beside_; // columns of this rank, and of others
  VecHandle ghosts_;
  ScatterHandle scatter_;
};

class LightMultigrid {
 public:
  /// Was PETSc's aggregation chosen for this solver, and has it matrices of AIJ?
  static bool applies_to(KSP solver);
  /// Takes the place of the solver's preconditioner, whose type and options it keeps. Must outlive the solves.
  /// Collective.
  explicit LightMultigrid(KSP solver);
  LightMultigrid(const LightMultigrid&) = delete;
  LightMultigrid& operator=(const LightMultigrid&) = delete;

 private:
  static PetscErrorCode set_up(PC);
  static PetscErrorCode apply(PC, Vec in, Vec out);
  void rebuild(PC outer);
  void lighten();
  void follow_tangent();
  KSP smoother(); // of the finest level; null where there is but one

  std::string type_;
  Handle<PC, PCDestroy> inner_;
  Mat matrix_ = nullptr; // of the finest level; not owned
  std::optional<SinglePrecisionProduct> product_;
};

} // namespace amontons
