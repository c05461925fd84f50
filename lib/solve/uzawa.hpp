// The augmented-Lagrangian outer loop: equilibrium at fixed multipliers by Newton, then new multipliers, accelerated by
// Anderson mixing (PETSc's SNESANDERSON on the multipliers; tuned by -uzawa_snes_*). Equilibria on the way are found as
// well as the next update can use; the one at the end, with the final multipliers, to the tolerance of Newton's method.
#pragma once

#include "form/multiplier_set.hpp"
#include "solve/newton.hpp"

namespace amontons {

class UzawaLoop {
 public:
  /// Stops when an update changes the multipliers by less than `tolerance` of their norm. Collective.
  UzawaLoop(Problem& problem, Newton& newton, MultiplierSet& multipliers, double tolerance, int max_iterations);

  /// From the state in `unknowns` and the multipliers held now. Collective.
  SolveOutcome solve(Vec unknowns);
  /// Has the last solve left the state in equilibrium with the multipliers held, settled or not?
  bool is_balanced() const { return inner_.converged; }

 private:
  static PetscErrorCode evaluate(SNES, Vec multipliers, Vec change, void* self);
  static PetscErrorCode test_convergence(SNES snes, PetscInt iteration, PetscReal, PetscReal, PetscReal norm,
                                         SNESConvergedReason* reason, void* self);
  /// At the multipliers held now; adds to `inner_`.
  void find_equilibrium();

  Problem& problem_;
  Newton& newton_;
  MultiplierSet& multipliers_;
  double tolerance_;
  SnesHandle snes_;
  VecHandle current_, change_, updated_;
  Vec unknowns_ = nullptr; // of the increment being solved
  SolveOutcome inner_;     // sums over the inner solves
  double norm_ = 0.0;      // of the multipliers
  std::exception_ptr kept_;
};

} // namespace amontons
