// Frictionless contact as bounds on unknowns: what a solver for variational inequalities sees. The unknowns u of the
// problem are written with others, u = T û, of which some are the normal motion of a slave node against its master and
// have a lower bound; the force on such a bound is the contact force.
#pragma once

#include "form/form.hpp"

#include <array>
#include <string>
#include <vector>

namespace amontons {

class BoundedUnknowns {
 public:
  BoundedUnknowns() = default;
  BoundedUnknowns(const BoundedUnknowns&) = delete;
  BoundedUnknowns& operator=(const BoundedUnknowns&) = delete;
  virtual ~BoundedUnknowns() = default;

  /// Moves rigid masters to where they are at `time`; returns whether the transformation or a bound is another than
  /// before. Collective.
  virtual bool update(double time) = 0;
  /// T and its inverse, as of the last update. A prescribed displacement is the same unknown in u and û.
  virtual Mat transform() const = 0;
  virtual Mat inverse() const = 0;
  /// The nodes of this rank that may have bounds, pair by pair, in an order that does not change.
  struct Set {
    std::string name;                          // of the contact pair
    std::vector<std::array<double, 3>> places; // in the reference configuration
    std::vector<PetscInt> unknowns;            // numbers of this rank as of the last update; -1: no bound now
  };
  virtual std::vector<Set> sets() const = 0;
  /// û >= lower: length; PETSC_NINFINITY where there is no bound.
  virtual Vec lower() const = 0;
  /// Gives the contact forms the force on each bound (a vector like û, >= 0, zero where there is no bound or where it
  /// is not touched) to hold from now on; then the residual at u is that of equilibrium, contact included. Collective.
  virtual void hold_forces(Vec forces) = 0;
  /// Takes all held forces away: then the residual's part on a bounded unknown is the force on its bound.
  virtual void release() = 0;
};

} // namespace amontons
