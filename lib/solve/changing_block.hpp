// Dense systems with matrices S + Δ that differ from a reference S in some rows and columns only, the changing ones c:
//   S = [S_ss S_sc; S_cs S_cc], s the steady ones.
// S_ss is factorized once, and the rest condensed onto the changing equations,
//   (S_cc − S_cs S_ss⁻¹ S_sc + Δ) x_c = b_c − S_cs S_ss⁻¹ b_s,   x_s = S_ss⁻¹ b_s − (S_ss⁻¹ S_sc) x_c,
// so that each Δ costs a factorization of the size of c. One rank; knows nothing of what the equations mean.
#pragma once

#include "base/petsc.hpp"

#include <span>
#include <vector>

namespace amontons {

class ChangingBlock {
 public:
  struct Change {
    int row, column;
    double value; // to be added to the reference
  };

  /// `reference`: column by column, square, and not copied.
  ChangingBlock(std::span<const double> reference, int size);

  /// Is there a factorization of S_ss, and do all changes lie in changing rows and columns?
  bool covers(std::span<const Change> changes) const;
  /// These rows and columns, ascending, are the changing ones from now on. False if S_ss is singular.
  bool set_changing(std::vector<int> changing);
  /// The matrix is the reference with these changes, which must be covered. False if it is singular.
  bool factorize(std::span<const Change> changes);
  /// In place.
  void solve(std::span<double> vector) const;
  /// S times a vector: the reference, without changes.
  std::vector<double> times_reference(std::span<const double> vector) const;

  int size() const { return size_; }
  const std::vector<int>& changing() const { return changing_; }

 private:
  MatHandle part(const std::vector<int>& rows, const std::vector<int>& columns) const;

  std::span<const double> reference_;
  int size_;
  bool is_ready_ = false; // S_ss is factorized
  std::vector<int> changing_, steady_;
  std::vector<int> place_;       // of each equation among the changing ones, or −1
  MatHandle steady_factor_;      // S_ss
  MatHandle from_steady_;        // S_cs
  MatHandle to_steady_;          // S_ss⁻¹ S_sc
  MatHandle condensed_, factor_; // S_cc − S_cs S_ss⁻¹ S_sc, and the same with the changes
  VecHandle right_steady_, steady_part_, right_changing_, changing_part_;
};

} // namespace amontons
