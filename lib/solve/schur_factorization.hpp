// Linear systems of Newton's method by one sparse factorization for a whole run. Where the solid is linear, tangents
// differ in the equations that contact couples only, B (Problem::changing_equations). MUMPS eliminates all others once
// and leaves a dense matrix on B, in which each tangent is a change (ChangingBlock). Knows matrices and SNES, nothing
// of contact.
#pragma once

#include "solve/changing_block.hpp"
#include "solve/mumps_factor.hpp"
#include "solve/tangent_solver.hpp"

#include <optional>
#include <vector>

namespace amontons {

/// Can tangents of this problem be condensed: on one rank (PETSc 3.18 has no Schur complement of MUMPS on more), with
/// some, but not all equations changing? Collective.
bool can_condense(const Problem& problem);

class SchurFactorization : public TangentSolver {
 public:
  /// See TangentSolver. Collective.
  SchurFactorization(const Problem& problem, SNES snes);

 private:
  enum class Way { None, Condensed, Plain };
  static PetscErrorCode solve_block(Mat schur, Mat right, Mat solution);
  bool solve(Vec right, Vec solution) override;
  bool factorize();
  bool factorize_whole();
  bool eliminate_constant();
  void fill_reference(Mat schur, Mat eliminated);
  bool condense();
  std::vector<ChangingBlock::Change> find_changes() const;
  std::vector<int> widened(std::span<const ChangingBlock::Change> changes) const;

  MumpsFactor constant_; // of the equations outside B
  MumpsFactor whole_;    // of a tangent that could not be condensed
  std::optional<ChangingBlock> block_;
  std::vector<PetscInt> equations_; // B
  std::vector<int> position_;       // in B, of every equation, or −1
  std::vector<double> reference_;   // values of the rows B of the tangent that block_ knows, one after the other
  VecHandle correction_;
  int pattern_number_ = none, factorized_tangent_ = none;
  Way way_ = Way::None; // of the tangent factorized last
};

} // namespace amontons
