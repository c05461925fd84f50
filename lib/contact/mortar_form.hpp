// A contact pair whose tractions are given from outside: nodal multipliers with the dual basis, found by a solver of
// variational inequalities as the forces on bounds (MortarTransform), or by a semismooth Newton method as what relative
// motions are out of balance by (CondensedContact). Adds their forces to the residual and nothing to the tangent.
#pragma once

#include "contact/contact_points.hpp"
#include "contact/dual_basis.hpp"
#include "contact/nodal_friction.hpp"
#include "contact/pair_report.hpp"

#include <map>
#include <memory>
#include <vector>

namespace amontons {

class MortarForm : public Form, public PairReport {
 public:
  /// Searches. Collective.
  MortarForm(const DofLayout& layout, ContactPair pair);

  const char* name() const override { return "contact"; }
  void couple(Coupling&) const override {}
  void add_residual(const State& state, Residual& residual) override;
  void add_tangent(const State&, Tangent&) override {}
  bool tangent_is_constant() const override { return true; }
  /// That of the solver's equations: sliding takes its traction from the pressure, and not the other way round.
  bool tangent_is_symmetric() const override { return !friction_; }
  void commit(const State& state) override;
  void roll_back() override;
  void forget_course() override {
    if (friction_) friction_->forget_course();
  }
  std::any history() const override { return accepted(); }
  void restore(const std::any& history) override { restore(std::any_cast<const ContactHistory&>(history)); }
  ContactHistory accepted() const override;
  void restore(const ContactHistory& history) override;

  const ContactPair& pair() const override { return pair_; }
  void hold_floating_body(bool holds) override { pair_.holds_floating_body = holds; }
  /// All nodes of the slave surface that this rank knows; for order 2 the controls that go with them.
  const NodeField& nodes() const override { return nodes_; }
  const std::vector<double>& multipliers() const override { return multipliers_; }
  void hold_multipliers(std::vector<double> multipliers) override { multipliers_ = std::move(multipliers); }
  const ContactPoints& points() const override { return points_; }
  /// Absent without friction.
  NodalFriction* friction() const { return friction_.get(); }
  /// The normal multipliers must be held already.
  void hold_friction(const NodalFriction::Claim& claim);
  /// No traction anywhere.
  void release();
  ContactSamples samples(const State& state) override;
  ContactTotals totals(const State& state) override;
  double work_of_displacement(const State& state) override;
  std::array<double, 3> rigid_shift() const override { return points_.rigid_shift(); }

  /// What the constraint of a node is made of, over all ranks, with D = ∫ ψ N:
  /// gap · area / D + normal · (c_slave + Σ X c_left_out − Σ P u_master) >= 0.
  struct Constraint {
    double weight = 0.0;              // D, area; 0: no master covers the node, or it is left out
    double area = 0.0;                // ∫ ψ: D, and what the node takes over from those that are left out
    std::array<double, 3> normal{};   // unit mean of the points' normals, weighted with N
    double gap = 0.0;                 // initial: ∫ ψ g0 / ∫ ψ, length
    double epsilon = 0.0, size = 0.0; // means over the points around: augmentation, force / volume; h of the facets

    /// Mean motion of the surroundings, ∫ ψ (u_slave − u_master) / ∫ ψ, per motion of the node itself.
    double leverage() const { return weight / area; }
  };
  const std::vector<Constraint>& constraints() const { return constraints_; }
  /// Leaves nodes of nodes() without a multiplier (`places`: flags, the same on all ranks): their functions ψ go to the
  /// other nodes of each facet, so that a uniform traction stays one. Returns the facets of this rank that have no node
  /// left. Once only. Collective.
  std::vector<std::int32_t> leave_out(const std::vector<std::uint8_t>& places);
  /// This rank's part of X, by which a constraint follows nodes that are left out: coefficient of the displacement of
  /// local mesh node `node` in the row of nodes()[place].
  struct LeftOut {
    std::int32_t place, node;
    double coefficient;
  };
  std::vector<LeftOut> left_out_rows() const;
  /// This rank's part of the rows of P = D⁻¹ M, one a node of nodes(): node of master() -> coefficient.
  std::vector<std::map<std::int32_t, double>> master_rows() const;
  const MasterSurface* master() const { return points_.master(); }
  const FacetSet& slave() const { return points_.slave(); }

  /// Where a local mesh node stands in nodes(), -1 for others.
  std::int32_t place(std::int32_t node) const { return place_[node]; }
  /// Moves a rigid master; returns whether normals and gaps are others than before. Collective.
  bool move_rigid_master(double time);

 private:
  struct SlaveFacet {
    std::size_t begin = 0, end = 0;            // of points
    double size = 0.0;                         // h
    std::vector<std::array<double, 3>> places; // of the controls
    /// Rows of points that are not covered are zero, columns of nodes that are left out too; absent where the facet has
    /// too little cover or no node is left.
    std::optional<DualBasis> dual = std::nullopt;
  };
  /// Area around a node of a facet that the multiplier of a node acts on: that node's, or a neighbour's where the node
  /// is left out. Together the forces on parts, at their places, are those of the formulation.
  struct Part {
    std::int32_t facet;
    std::int32_t corner;
    std::int32_t multiplier; // place in nodes()
    double area;
  };
  void find_facets();
  void divide_into_parts();
  PointTable control_shape(std::int32_t facet) const;
  Eigen::VectorXd whole_integrals(std::int32_t facet) const;
  void find_constraints();
  std::vector<double> nodal_gaps(const State& state);
  bool is_covered(const ContactPoint& point) const { return point.master != ContactPoint::none; }
  TangentialSums friction_sums() const;
  std::vector<double> nodal_pressure() const;
  bool is_loaded(std::int32_t facet) const;
  std::array<double, 3> traction(std::size_t place) const;

  const DofLayout& layout_;
  ContactPair pair_;
  NodeField nodes_;
  std::vector<std::int32_t> place_; // of a local mesh node in nodes_, or -1
  ContactPoints points_;
  NodeSpace constraint_space_, gap_space_;
  std::vector<SlaveFacet> facets_;     // of the slave FacetSet
  std::vector<std::uint8_t> left_out_; // per node
  std::vector<Part> parts_;            // facet by facet
  std::vector<Constraint> constraints_;
  std::vector<double> multipliers_, multipliers_old_; // traction, <= 0
  double rigid_time_ = 0.0;
  std::unique_ptr<NodalFriction> friction_;
};

} // namespace amontons
