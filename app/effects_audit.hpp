// The audit of effects that a run leaves out, beyond kinematics (error_budget): was the scene elastic, frictionless,
// slow and cool enough? What the deck does not tell is named as such.
#pragma once

#include "ledger.hpp"
#include "scene.hpp"

#include <nlohmann/json_fwd.hpp>
#include <span>

namespace amontons {

/// How fast bodies have moved, over all increments of a run. For decks that give densities.
class MotionRecord {
 public:
  /// Does any material have a density?
  static bool wanted(const Deck& deck);
  /// The increment between two states, before it is committed. Collective.
  void add(Scene& scene, Vec accepted, Vec unknowns);
  double largest_kinetic() const { return kinetic_; }
  double largest_speed() const { return speed_; }

 private:
  double kinetic_ = 0.0, speed_ = 0.0;
};

struct AuditInput {
  Scene& scene;
  Vec unknowns;
  std::span<const ContactSamples> samples;
  const Ledger& ledger;
  const MotionRecord* motion; // null: no density is given
};

/// Entries for `effects` of the summary, each with indicator, threshold and where the figure comes from; indicator null
/// and a reason where data are absent. Collective.
nlohmann::ordered_json audit_absent_effects(const AuditInput& input);

} // namespace amontons
