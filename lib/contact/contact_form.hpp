// One contact pair as a Form: adds ∫ σ_n δg_n over the slave surface, with λ from wherever the pair's enforcement has
// it.
#pragma once

#include "contact/contact_pair.hpp"
#include "contact/contact_points.hpp"
#include "contact/contact_samples.hpp"
#include "contact/tangential_part.hpp"
#include "form/form.hpp"

#include <memory>
#include <string>
#include <vector>

namespace amontons {

/// The vertices of a slave surface, where its multipliers live (linear for elements of order 1 and 2: stable with
/// both).
NodeField multiplier_nodes(const Mesh& mesh, const std::string& pair, const std::string& slave);

/// Totals of one pair over all ranks.
struct ContactTotals {
  std::array<double, 3> force{};    // on the slave
  std::array<double, 3> moment{};   // of that force about the origin (reference places)
  double area = 0.0;                // of slave points in contact, weighted
  double max_pressure = 0.0;        // nodal
  double largest_penetration = 0.0; // −g over the points in contact, relative to the facet size
  // Zero without friction:
  std::array<double, 3> tangential_force{}; // on the slave; part of `force`
  double stick_area = 0.0, slip_area = 0.0, open_area = 0.0;
  double dissipation = 0.0; // in the increment since the last accepted state
  double turning = 0.0;     // see ContactForm::turning_work
  double path_error = 0.0;  // of the shear's work in that increment: |mismatch| + change of TangentialSums
};

class ContactForm : public Form {
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
  /// A ContactHistory.
  std::any history() const override { return accepted(); }
  void restore(const std::any& history) override { restore(std::any_cast<const ContactHistory&>(history)); }
  /// What of an accepted state follows from its unknowns and need not be in a checkpoint; commit() does it, too.
  /// Collective.
  void remember(const State& state);
  ContactHistory accepted() const;
  void restore(const ContactHistory& history);
  double stored_energy(const State& state) override;
  bool tangent_is_symmetric() const override { return !tangential_; }

  const ContactPair& pair() const { return pair_; }
  const NodeField& nodes() const { return nodes_; }
  const ContactPoints& points() const { return points_; }

  /// Traction per unknown multiplier of the layout's extra field (`semismooth`).
  double multiplier_scale() const { return scale_; }
  /// Multipliers at nodes(), held (Uzawa) or as of the last evaluation (semismooth): traction, <= 0 in contact.
  const std::vector<double>& multipliers() const { return multipliers_; }
  void hold_multipliers(std::vector<double> multipliers);
  /// This rank's parts of ∫ N_i (σ − λ_i) and ∫ N_i at nodes(). Collective.
  void multiplier_defect(const State& state, std::vector<double>& defect, std::vector<double>& mass);

  /// Absent without friction.
  const TangentialPart* tangential() const { return tangential_.get(); }
  TangentialPart* tangential() { return tangential_.get(); }

  /// What the solver claims, point by point, with the nodal pressure summed over ranks. Collective.
  ContactSamples samples(const State& state);
  /// Collective.
  ContactTotals totals(const State& state);
  /// ∫ σ n·(u_slave − u_master) + σ_t·(u_slave − u_master): the contact tractions' virtual work on the displacement
  /// itself, over all ranks (a rigid master's motion not included). Collective.
  double work_of_displacement(const State& state);
  /// The rigid master where it is now.
  std::array<double, 3> rigid_shift() const { return points_.rigid_shift(); }

 private:
  struct Group; // consecutive points of one slave facet with one master facet
  std::vector<Group> groups() const;
  bool is_unknown() const { return std::holds_alternative<Semismooth>(pair_.enforcement); }
  void evaluate(const State& state);
  void fetch_multipliers(const State& state);
  void guess_contact();
  void evaluate_friction(const State& state);
  double gap_at(const ContactPoint& point, const State& state) const;
  double multiplier_at(const ContactPoint& point) const;
  bool master_turns() const;
  std::array<double, 3> relative_jump(const ContactPoint& point, const State& state) const;
  double turning_work(const State& state) const;
  double sigma(std::size_t i) const { return active_[i] ? augmented_[i] : 0.0; }
  void gather_equations(const Group& group, std::vector<PetscInt>& equations) const;
  ContactBlock block_layout(const Group& group, std::size_t size) const;
  void gap_variation(const ContactPoint& point, const Group& group, std::span<double> variation) const;
  bool coupled(const Group& group) const;
  void couple_near();
  std::vector<double> nodal_pressure();

  const DofLayout& layout_;
  ContactPair pair_;
  NodeField nodes_;
  NodeSpace space_;
  std::vector<std::int32_t> position_; // of a local mesh node in nodes_, or -1
  ContactPoints points_;
  double scale_ = 1.0; // unknown multiplier x scale_ = traction: gives it the unit of a displacement (see .cpp)
  std::vector<double> multipliers_, multipliers_old_; // traction at nodes_
  double rigid_time_ = 0.0;
  std::vector<NormalHistory> normals_old_; // empty unless master_turns()
  // At the last evaluation, per point:
  std::vector<double> gap_, lambda_, augmented_;
  std::vector<std::uint8_t> active_, assembled_active_, coupled_;
  bool assembled_ = false;
  std::unique_ptr<TangentialPart> tangential_;
  std::vector<double> normal_traction_; // for it
  VecHandle local_multipliers_;
  ScatterHandle multiplier_scatter_;
};

} // namespace amontons
