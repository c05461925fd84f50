// One contact pair as a Form: adds ∫ σ_n δg_n over the slave surface, with λ from wherever the pair's enforcement has
// it.
#pragma once

#include "contact/contact_pair.hpp"
#include "contact/contact_points.hpp"
#include "contact/contact_samples.hpp"
#include "contact/pair_report.hpp"
#include "contact/point_tangent.hpp"
#include "contact/tangential_part.hpp"
#include "form/form.hpp"
#include "form/switching.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace amontons {

/// The vertices of a slave surface, where its multipliers live (linear for elements of order 1 and 2: stable with
/// both).
NodeField multiplier_nodes(const Mesh& mesh, const std::string& pair, const std::string& slave);

class ContactForm : public Form, public PairReport, public Switching {
 public:
  /// Searches. Collective.
  ContactForm(const DofLayout& layout, ContactPair pair);

  const char* name() const override { return "contact"; }
  void couple(Coupling& coupling) const override;
  void add_residual(const State& state, Residual& residual) override;
  void add_tangent(const State& state, Tangent& tangent) override;
  bool tangent_changed(const State& state) override;
  bool coupling_changed(const State& state) override;
  void commit(const State& state) override;
  void roll_back() override;
  void forget_course() override {
    if (tangential_) tangential_->forget_course();
  }
  /// A ContactHistory.
  std::any history() const override { return accepted(); }
  void restore(const std::any& history) override { restore(std::any_cast<const ContactHistory&>(history)); }
  /// What of an accepted state follows from its unknowns and need not be in a checkpoint; commit() does it, too.
  /// Collective.
  void remember(const State& state) override;
  ContactHistory accepted() const override;
  void restore(const ContactHistory& history) override;
  double stored_energy(const State& state) override;
  bool tangent_is_symmetric() const override { return !tangential_ && !points_.is_following(); }

  // contact_switching.cpp
  Switching* switching() override { return this; }
  const std::string& switch_name() const override { return pair_.name; }
  std::array<double, 3> switch_place(std::size_t point) const override { return points_.points()[point].place; }
  std::vector<std::uint8_t> branches() const override;
  void hold(std::vector<Hold> holds) override;
  std::vector<std::uint8_t> wanted() const override { return wanted_; }
  bool has_limits() const override { return tangential_ != nullptr; }
  void hold_limits() override;
  void release_limits() override;
  void scale_augmentation(double factor) override;

  const ContactPair& pair() const override { return pair_; }
  void hold_floating_body(bool holds) override { pair_.holds_floating_body = holds; }
  const NodeField& nodes() const override { return nodes_; }
  const ContactPoints& points() const override { return points_; }

  double multiplier_scale() const override { return scale_; }
  const std::vector<double>& multipliers() const override { return multipliers_; }
  void hold_multipliers(std::vector<double> multipliers) override;
  /// Are multipliers nodal numbers that can be held: `uzawa` and `semismooth`?
  bool has_multipliers() const { return !std::holds_alternative<Penalty>(pair_.enforcement); }
  /// Makes multipliers that are unknowns of the layout unknown again: held, normal and tangential ones together, they
  /// are what hold_multipliers() says, and their equations that the unknowns are the same.
  void release_multipliers();
  /// This rank's parts of ∫ N_i (σ − λ_i) / ε, by which the potential falls with λ_i, and of ∫ N_i / ε at nodes().
  /// Where facets differ in size, so does ε: without it the loop would end at another state than semismooth.
  /// Collective.
  void multiplier_defect(const State& state, std::vector<double>& defect, std::vector<double>& mass);

  /// Absent without friction.
  const TangentialPart* tangential() const { return tangential_.get(); }
  TangentialPart* tangential() { return tangential_.get(); }

  ContactSamples samples(const State& state) override;
  ContactTotals totals(const State& state) override;
  double work_of_displacement(const State& state) override;
  std::array<double, 3> rigid_shift() const override { return points_.rigid_shift(); }

 private:
  /// Consecutive points of one slave facet with one master facet.
  struct Group {
    std::size_t begin, end; // of points
    std::int32_t facet, master;
    std::int32_t old_master; // finite kinematics with friction: of the projection at the last accepted state
  };
  std::vector<Group> groups() const;
  bool is_unknown() const { return std::holds_alternative<Semismooth>(pair_.enforcement); }
  bool is_sought() const { return is_unknown() && !away_; }
  void evaluate(const State& state);
  void fetch_multipliers(const State& state);
  double multiplier_defect_at(std::size_t i, std::int32_t node) const;
  bool both_moved(std::span<const double> displacement) const;
  void guess_contact(bool at_any_distance);
  void apply_holds();
  void evaluate_friction(const State& state);
  double gap_at(const ContactPoint& point, const State& state) const;
  double multiplier_at(const ContactPoint& point) const;
  bool master_turns() const;
  std::array<double, 3> relative_jump(const ContactPoint& point, const State& state) const;
  double turning_work(const State& state) const;
  double sigma(std::size_t i) const { return active_[i] ? augmented_[i] : 0.0; }
  void gather_slave_equations(std::int32_t facet, std::vector<PetscInt>& equations) const;
  void gather_equations(const Group& group, std::vector<PetscInt>& equations) const;
  ContactBlock block_layout(const Group& group, std::size_t size) const;
  void gap_variation(const ContactPoint& point, const Group& group, std::span<double> variation) const;
  bool coupled(const Group& group) const;
  void couple_near();
  // Finite kinematics (finite_contact.cpp):
  void couple_now(Coupling& coupling) const;
  void couple_near_now();
  bool all_coupled_now() const;
  /// What shear over a gap exerts on the nodes of the facet whose motion turns the normal: dim numbers a node.
  struct TurningForces {
    bool on_slave;
    std::vector<double> values;
  };
  std::optional<TurningForces> turning_forces(std::size_t i) const;
  void add_turning_forces(const Group& group, Residual& residual) const;
  double work_of_turning(const State& state) const;
  void add_tangent_now(bool first_guess, Tangent& tangent) const;
  /// A group's part of the tangent, row-major. Equations of the old master facet stand behind all others.
  struct DenseBlock {
    std::vector<PetscInt> equations;
    ContactBlock parts{.size = 0, .normal_multipliers = -1, .tangential_multipliers = -1, .master = -1};
    std::ptrdiff_t old_master = -1;
    std::vector<double> values;
  };
  void add_point_now(std::size_t i, const Group& group, bool first_guess, DenseBlock& block) const;
  ScalarDerivative stretch_at(std::size_t i) const;
  PointTangent tangent_at(std::size_t i, bool first_guess) const;
  std::vector<PetscInt> master_equations(std::int32_t facet) const;
  std::vector<double> nodal_pressure();

  const DofLayout& layout_;
  ContactPair pair_;
  NodeField nodes_;
  NodeSpace space_;
  std::vector<std::int32_t> position_; // of a local mesh node in nodes_, or -1
  ContactPoints points_;
  double scale_ = 1.0; // unknown multiplier x scale_ = traction: gives it the unit of a displacement (see .cpp)
  std::vector<double> multipliers_, multipliers_old_; // traction at nodes_
  std::optional<std::vector<double>> away_;           // unknown less held multipliers; absent unless held
  double rigid_time_ = 0.0;
  std::vector<NormalHistory> normals_old_; // empty unless master_turns()
  // At the last evaluation, per point:
  std::vector<double> gap_, lambda_, augmented_;
  std::vector<std::uint8_t> active_, assembled_active_, coupled_;
  bool assembled_ = false;
  bool was_moved_ = false;           // both sides of the pair, in the last accepted state; the same on every rank
  std::vector<Hold> holds_;          // empty: none
  std::vector<std::uint8_t> wanted_; // active_ before holds
  std::vector<std::vector<PetscInt>> coupled_equations_; // finite kinematics: of masters, sorted, per slave facet
  std::unique_ptr<TangentialPart> tangential_;
  std::vector<double> normal_traction_; // for it
  VecHandle local_multipliers_;
  ScatterHandle multiplier_scatter_;
};

} // namespace amontons
