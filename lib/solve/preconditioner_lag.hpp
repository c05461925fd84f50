// When to set up the preconditioner of a Krylov method anew. Tangents of a contact problem in small strains differ on
// the contact surface only, and a multigrid hierarchy of an earlier one serves, at a slower rate than its first one. A
// new one is made when the iterations that this has cost since the last are worth one: never more than twice what the
// best choice of set-ups would have cost, and no set-up for a few slow solves. The first tangent of an increment takes
// all points for sticking and is symmetric, which suits multigrid best.
#pragma once

#include "base/petsc.hpp"

namespace amontons {

class PreconditionerLag {
 public:
  /// Does this SNES use a Krylov method with a preconditioner that is not a factorization?
  static bool applies_to(SNES snes);
  /// To be called when the matrix holds a new tangent, before it is solved with: tells the SNES whether to keep its
  /// preconditioner. `norm`: of the right side that the solve before this one began with. Collective.
  void decide(SNES snes, double norm);
  /// What decide() has decided.
  bool rebuilds() const { return rebuilds_; }

 private:
  double first_rate_ = 0.0; // iterations per digit of the first solve after the last set-up; 0: not known yet
  double spent_ = 0.0;      // iterations above that rate since then
  bool is_set_up_ = false, rebuilds_ = false;
};

} // namespace amontons
