// Friction of a pair whose multipliers are nodal forces on relative motions (dual basis): the law is asked once a slave
// node. Owned by its MortarForm, and only by one with friction; it knows no integration points and no unknowns.
#pragma once

#include "contact/contact_history.hpp"
#include "contact/contact_pair.hpp"
#include "contact/contact_samples.hpp"
#include "contact/pair_report.hpp"
#include "fe/dof_layout.hpp"

#include <span>
#include <vector>

namespace amontons {

class NodalFriction {
 public:
  /// `nodes`: slave nodes of the pair, `shift`: where its rigid master is at the start. Views outlive this object.
  NodalFriction(const DofLayout& layout, const ContactPair& pair, const NodeField& nodes,
                const std::array<double, 3>& shift);

  /// Prepares for evaluations at this time. Throws UserError where the friction factor is negative. Collective.
  void move_to(double time);
  /// What the law makes of a trial traction q (stress, tangential) at pressure p >= 0.
  FrictionResponse respond(std::size_t node, const TangentVector& q, double p, double epsilon) const;
  /// The same as guessed for the first tangent of an increment (guess_response).
  FrictionResponse guess(std::size_t node, const TangentVector& q, double p, double epsilon) const;
  /// Motion of a node over the master since the last accepted state; `jump`: u_slave − u_master − rigid shift.
  std::array<double, 3> motion(std::size_t node, const std::array<double, 3>& jump) const;

  /// What all nodes carry from now on: trial tractions, jumps, and multipliers λ_n (<= 0, zero where open).
  struct Claim {
    std::vector<TangentVector> trial;
    std::vector<std::array<double, 3>> jump;
  };
  void hold(const Claim& claim, std::span<const double> normal, std::span<const double> epsilon);
  /// No traction anywhere.
  void release();
  /// Traction that the slave exerts, conjugate to its displacement.
  const TangentVector& traction(std::size_t node) const { return responses_[node].traction; }
  ContactStatus status(std::size_t node) const;

  void commit(double time);
  void roll_back();
  /// The next increment's first guess is that all nodes stick.
  void forget_course();
  void save(ContactHistory& history) const;
  void restore(const ContactHistory& history);

  /// Adds what an area around a node contributes; `shift`: where the rigid master is.
  void add_to(std::size_t node, double area, const std::array<double, 3>& shift, TangentialSums& sums) const;
  /// Adds what friction says of a sample at a node.
  void sample(std::size_t node, ContactSamples& samples) const;

 private:
  FrictionContext context(std::size_t node) const;
  void resume();

  const DofLayout& layout_;
  const ContactPair& pair_;
  const NodeField& nodes_;
  double time_ = 0.0, accepted_time_ = 0.0, factor_time_ = -1.0;
  std::vector<double> factor_;
  std::vector<PointHistory> history_;
  // As held:
  std::vector<FrictionResponse> responses_;
  std::vector<std::array<double, 3>> jump_;
  std::vector<std::uint8_t> closed_;
};

} // namespace amontons
