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
  void allow_partial_steps() override;
  void add_left_out(Vec unknowns, Vec residual) override;
  bool complete(Vec unknowns) override;

 private:
  enum class Way { None, Condensed, Plain };
  static PetscErrorCode solve_block(Mat schur, Mat right, Mat solution);
  bool solve(Vec right, Vec solution) override;
  bool solve_whole(Vec right, Vec solution);
  bool solve_partly(Vec right, Vec solution);
  void put_right(Vec unknowns);
  void add_condensed(std::span<const double> block, Vec residual) const;
  std::vector<double> in_block(Vec vector) const;
  void put_in_block(std::span<const double> block, Vec vector) const;
  std::vector<double> distance_to_rest(Vec unknowns) const;
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
  MatHandle coupling_;              // columns B of that tangent, all rows
  VecHandle correction_;
  // Of a Newton solve, see solve_partly().
  enum class Steps { Whole, WholeAtFirst, Partial }; // those that are allowed
  Steps steps_ = Steps::Whole;
  std::vector<double> rest_; // B of the last state in which the others were in balance; empty: they are
  double negligible_ = 0.0;  // residual there
  bool holds_block_ = false; // solve_block() answers zero
  int pattern_number_ = none, factorized_tangent_ = none;
  Way way_ = Way::None; // of the tangent factorized last
};

} // namespace amontons
