// Multipliers that are not unknowns of the system but are updated by a loop around it: what the Uzawa loop sees.
#pragma once

#include "form/form.hpp"

namespace amontons {

class MultiplierSet {
 public:
  MultiplierSet() = default;
  MultiplierSet(const MultiplierSet&) = delete;
  MultiplierSet& operator=(const MultiplierSet&) = delete;
  virtual ~MultiplierSet() = default;

  /// A vector for all multipliers of the set, zero. Collective.
  virtual VecHandle new_vector() const = 0;
  /// The multipliers that the forms hold now. Collective.
  virtual void get(Vec multipliers) const = 0;
  /// Gives the forms other multipliers. Collective.
  virtual void set(Vec multipliers) = 0;
  /// The lumped L2 projection of σ(λ, u) at the state, which is in equilibrium with the multipliers held now: the next
  /// multipliers of Uzawa's iteration. Its fixed point is the solution of the `semismooth` formulation. Collective.
  virtual void updated(const State& state, Vec multipliers) = 0;
};

} // namespace amontons
