// Contact conditions as equations of relative motions: what a semismooth Newton solver without multipliers sees. The
// unknowns u of the problem are written with others, u = T û, of which some are the motion of a slave node against its
// master; what such an unknown is out of balance by is the contact force, and a condition takes the place of its
// equation.
#pragma once

#include "form/form.hpp"
#include "form/switching.hpp"

#include <array>
#include <span>

namespace amontons {

/// Derivative of the conditions of one node: row r of the system is Σ_c forces[r][c] (row c of Tᵀ K T) + motion[r][c]
/// on unknown c, all of them at `equations` (the first `size`, of this rank).
struct ConditionRows {
  int size = 0;
  std::array<PetscInt, 3> equations{};
  std::array<std::array<double, 3>, 3> forces{}, motion{}; // 1; stiffness
  bool operator==(const ConditionRows&) const = default;
};

/// For the first step of an increment contact may be guessed where nothing touches, and all that is closed is taken to
/// stick.
enum class Evaluation : std::uint8_t { FirstGuess, True };

class CondensedUnknowns {
 public:
  CondensedUnknowns() = default;
  CondensedUnknowns(const CondensedUnknowns&) = delete;
  CondensedUnknowns& operator=(const CondensedUnknowns&) = delete;
  virtual ~CondensedUnknowns() = default;

  /// Moves rigid masters to where they are at `time`; returns whether the transformation is another than before.
  /// Collective.
  virtual bool update(double time) = 0;
  /// T and its inverse, as of the last update. A prescribed displacement is the same unknown in u and û.
  virtual Mat transform() const = 0;
  virtual Mat inverse() const = 0;
  /// Takes all held tractions away: then Tᵀ r is what every unknown is out of balance by without contact.
  virtual void release() = 0;
  /// Puts conditions in place of equilibrium where a slave node is closed: `residual`, given as a copy of `forces` =
  /// Tᵀ r(T û) without contact, in which the out-of-balance forces with contact come back. Collective.
  virtual void evaluate(Vec changed, Vec forces, Evaluation evaluation, Vec residual) = 0;
  /// The derivative of the last evaluation, of closed nodes; of all others it is that of the forces.
  virtual std::span<const ConditionRows> rows() const = 0;
  /// Gives the contact forms the tractions of the last evaluation to hold from now on; then the residual at u is that
  /// of equilibrium, contact included. Collective.
  virtual void hold() = 0;
  /// The conditions, pair by pair, as points with branches: what the last evaluation made of them, and to be held in
  /// the next. They live as long as this object.
  virtual std::vector<Switching*> switching() = 0;
};

} // namespace amontons
