// Friction of one contact pair: owned by its ContactForm, and only by one with friction.
#pragma once

#include "contact/contact_history.hpp"
#include "contact/contact_pair.hpp"
#include "contact/contact_points.hpp"
#include "contact/contact_samples.hpp"
#include "contact/pair_report.hpp"
#include "contact/slip_path.hpp"
#include "form/form.hpp"
#include "friction/return_mapping.hpp"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace amontons {

/// Rows and columns of a group's dense block (ContactForm::gather_equations): slave displacements, node by node, from
/// 0 on; then the groups below. Absent ones are negative.
struct ContactBlock {
  std::size_t size;
  std::ptrdiff_t normal_multipliers, tangential_multipliers, master;
};

class TangentialPart {
 public:
  /// `nodes`: the multiplier nodes of the pair; `scale`: traction per unknown multiplier; `position`: of a local mesh
  /// node in `nodes`. Views outlive this object. Collective.
  TangentialPart(const DofLayout& layout, const ContactPair& pair, const ContactPoints& points, const NodeField& nodes,
                 std::span<const std::int32_t> position, double scale);

  /// Shear traction of all points, given their normal traction (zero or positive: none) and which are in contact.
  /// Throws UserError where the friction factor is negative. Collective.
  void evaluate(const State& state, std::span<const double> sigma, std::span<const std::uint8_t> active);
  const FrictionResponse& response(std::size_t i) const { return responses_[i]; }
  const TangentVector& traction(std::size_t i) const { return responses_[i].traction; }
  ContactStatus status(std::size_t i) const;
  /// The response whose derivatives stand for those of a point in the first tangent of an increment (guess_response).
  FrictionResponse guess(std::size_t i) const;
  bool is_pressed(std::size_t i) const { return pressed_[i] != 0; }
  /// Finite kinematics: where the points come from. Null in small kinematics.
  const SlipPath* path() const { return path_.get(); }
  /// What a point carries over from the last accepted state without its multipliers: σ_t,old − λ_t,old, turned with the
  /// slave; zero where it was open. Stress.
  TangentVector kept(std::size_t i) const;
  /// kept() and λ_t.
  TangentVector carried(std::size_t i) const;

  /// Forces of points [begin, end), which lie on one slave facet and one master facet.
  void add_residual(std::size_t begin, std::size_t end, Residual& residual) const;
  /// Their tangent, added to a block; returns whether anything was added. `first_guess`: that of guess().
  bool add_tangent(std::size_t begin, std::size_t end, const ContactBlock& layout, bool first_guess,
                   std::span<double> block) const;
  void gather_multiplier_equations(std::int32_t facet, std::vector<PetscInt>& equations) const;
  /// Is the tangent another than when remember_tangent was called?
  bool tangent_changed() const;
  void remember_tangent(bool first_guess);

  /// From the next evaluation on the law is asked with the pressures of the last one, which then do not vary, until
  /// they are released: friction with a given bound.
  void hold_pressure();
  void release_pressure() { held_pressure_.clear(); }

  void commit(const State& state);
  void roll_back();
  /// The next increment's first guess is that all points stick.
  void forget_course();
  /// Adds what was last accepted to the pair's history, and makes a history the last accepted one.
  void save(ContactHistory& history) const;
  void restore(const ContactHistory& history);
  /// Takes the present places for those of the last accepted state.
  void remember();

  /// Cartesian components of λ_t at the pair's multiplier nodes: traction.
  const std::vector<std::vector<double>>& multipliers() const { return multipliers_; }
  void hold_multipliers(std::vector<std::vector<double>> multipliers);
  void release_multipliers() { away_.reset(); }
  /// What the equation of a nodal multiplier's component makes zero at a point.
  double multiplier_defect_at(std::size_t i, int component, std::int32_t node) const;
  /// This rank's parts of ∫ N_i (σ_t − λ_t,i) / ε at the nodes, component by component.
  std::vector<std::vector<double>> multiplier_defect() const;

  TangentialSums sums() const;
  /// Potential (|σ_t|² − |λ_t|²) / (2 ε) on this rank, of penalty springs |σ_t|² / (2 ε), at the last evaluation.
  double stored_energy() const;
  /// Fills in what friction adds to the samples of the pair's points.
  void sample(ContactSamples& samples) const;

 private:
  bool is_unknown() const { return std::holds_alternative<Semismooth>(pair_.enforcement); }
  bool is_sought() const { return is_unknown() && !away_; }
  bool has_multipliers() const { return !std::holds_alternative<Penalty>(pair_.enforcement); }
  void fetch_multipliers(const State& state);
  void find_factors(double time);
  void jump_variation(const ContactPoint& point, const ContactBlock& layout, std::span<double> motion) const;
  void trial_tangent(std::size_t i, const ContactBlock& layout, bool first_guess, std::span<const double> motion,
                     std::span<double> response) const;
  double spring_energy(std::size_t i, const TangentVector& traction,
                       const std::vector<std::vector<double>>& multipliers) const;

  const DofLayout& layout_;
  const ContactPair& pair_;
  const ContactPoints& points_;
  const NodeField& nodes_;
  std::span<const std::int32_t> position_;
  double scale_;
  std::unique_ptr<SlipPath> path_;
  std::vector<std::vector<double>> multipliers_, multipliers_old_; // [component][node]
  std::optional<std::vector<std::vector<double>>> away_;           // see ContactForm
  std::vector<PointHistory> history_;
  double accepted_time_ = 0.0, factor_time_ = -1.0;
  std::vector<double> factor_;
  // At the last evaluation, per point:
  std::vector<FrictionContext> contexts_;
  std::vector<FrictionResponse> responses_;
  std::vector<std::array<double, 3>> jump_;      // u_slave − u_master − rigid shift
  std::vector<std::array<double, 3>> motion_;    // jump less that of the last accepted state
  std::vector<double> pressure_, held_pressure_; // held: empty when released
  std::vector<std::uint8_t> active_, pressed_, assembled_status_;
  VecHandle local_multipliers_;
  ScatterHandle multiplier_scatter_;
};

} // namespace amontons
