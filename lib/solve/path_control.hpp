// How large the error is that the answer of a path-dependent problem owes to the size of its increments, and which
// size keeps it within a tolerance. Pure logic, the same on every rank: what is measured, and on what, is for others.
//
// An increment is solved once whole and once as two halves. Implicit Euler, as which friction's return mapping
// integrates, has a local error C Δt²: the whole is off by C Δt², the halves together by C Δt² / 2, so their difference
// is the error of the halves and half of that of the whole. Errors of increments are added up: a bound as long as later
// increments do not amplify earlier errors.
#pragma once

namespace amontons {

/// Spends the tolerance of one step. Half of it is dealt out in proportion to time; the other half is a reserve, of
/// which an increment may take a quarter of what is left: for a first contact or a load that turns, where the
/// difference does not fall with the increment as it should. So all differences together never exceed the tolerance,
/// unless an increment is at its smallest.
class PathControl {
 public:
  /// `tolerance`: of the sum over the step, relative like the differences; `duration`: of the step.
  PathControl(double tolerance, double duration) : tolerance_(tolerance), duration_(duration) {}

  struct Verdict {
    bool accepted;
    double factor; // next increment / this one: 0.25 to 2, below 0.5 after a rejection
  };
  /// Judges an increment of length `dt` whose halves differ from the whole by `difference`, and in status on the part
  /// `status` of the contact area. The next increment is chosen for the proportional half alone: the sum that is
  /// allowed goes with Δt, the difference with Δt², so Δt_next = 0.8 Δt allowed / difference. Status is held to the
  /// tolerance in each increment by itself: it is not an error that adds up.
  Verdict judge(double difference, double status, double dt) const;
  /// Takes the difference of an accepted increment off the reserve as far as it exceeds the proportional part.
  void spend(double difference, double dt);

  /// What has been taken off the reserve (a restart goes on with it).
  double taken() const { return taken_; }
  void set_taken(double taken) { taken_ = taken; }

 private:
  double proportional(double dt) const { return 0.5 * tolerance_ * dt / duration_; }
  double reserve() const;
  double tolerance_, duration_;
  double taken_ = 0.0;
};

} // namespace amontons
