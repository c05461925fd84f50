// The book-keeping of forces and energies over accepted increments: reactions, external work, its bounds.
#pragma once

#include "output/checkpoint.hpp"
#include "scene.hpp"

#include <array>
#include <span>
#include <vector>

namespace amontons {

/// Force on a group by its supports, and its mean displacement where it moves as one.
struct GroupReaction {
  std::string group;
  std::array<double, 3> force{};
};

class Ledger {
 public:
  explicit Ledger(Scene& scene);

  /// Do surfaces overlap before anything has moved? Then the books open with the first equilibrium, and what it took to
  /// get there counts as external work.
  bool initial_overlap() const { return initial_overlap_; }

  /// Takes the accepted state into the books; call before Problem::commit, after a residual at `unknowns`. Collective.
  void accept(Vec unknowns);

  /// ∫ F · du by the trapezoidal rule over the accepted increments: supports, loads and moving rigid masters.
  double external_work() const { return external_work_ + artificial_work_; }
  /// What of it the stabilization has taken.
  double artificial_work() const { return artificial_work_; }
  /// How far external_work can be off stored_energy + dissipated_energy for the length of the increments alone; see
  /// EnergyLedger::work_uncertainty.
  double work_uncertainty() const { return work_uncertainty_; }
  double stored_energy() const { return stored_energy_; }
  /// Dissipation since the start: of all pairs by friction and of the bodies by their materials; of each pair.
  double dissipated_energy() const;
  const std::vector<double>& dissipated_by_pair() const { return dissipated_; }
  /// e · u − ∫ (σ (g − g0) + σ_t · u) − W at the state, W the work of the stresses on the displacement
  /// (SolidForm::internal_work): zero in equilibrium; and its scale Σ |e · u| + |W| + what the
  /// bodies have dissipated.
  double virtual_work_defect() const { return virtual_work_defect_; }
  double virtual_work_scale() const { return virtual_work_scale_; }
  /// Applied loads and support reactions by node: num_local x dim, this rank's parts. Collective.
  std::vector<double> nodal_external_forces(Vec unknowns);
  /// One entry per group with a prescribed displacement, in the order of the deck.
  const std::vector<GroupReaction>& reactions() const { return reactions_; }

  /// Displacement of each tied group of the layout, in its direction.
  const std::vector<double>& tied_displacements() const { return tied_displacements_; }

  /// Puts the books into a checkpoint. The forces go with them: a restart cannot evaluate them anew, for those of
  /// friction depend on how the accepted state was reached. Collective.
  void save(Checkpoint& checkpoint) const;
  /// Opens the books as a checkpoint left them, with the state that it holds in `unknowns`. Collective.
  void restore(const Checkpoint& checkpoint, Vec unknowns);

 private:
  void find_external_forces(Vec unknowns);
  void take_artificial_work(Vec unknowns);
  void add_bubble_work(Vec unknowns, std::span<double> sums);
  double trapezoid_error(Vec unknowns, double change, double absolute_change);
  void collect_reactions();
  void collect_tied_displacements(Vec unknowns);

  Scene& scene_;
  VecHandle external_, external_old_, unknowns_old_, work_;
  std::vector<std::array<double, 3>> rigid_force_old_, rigid_shift_old_;
  VecHandle viscous_, viscous_old_; // residual of the stabilization; absent without
  double external_work_ = 0.0;      // without what the stabilization takes
  double artificial_work_ = 0.0, work_uncertainty_ = 0.0, stored_energy_ = 0.0, bulk_dissipation_ = 0.0;
  std::vector<double> dissipated_;
  double virtual_work_defect_ = 0.0, virtual_work_scale_ = 0.0;
  LoadedBubbles bubbles_old_;
  bool initial_overlap_ = false, opened_ = false;
  std::vector<GroupReaction> reactions_;
  std::vector<double> tied_displacements_;
};

} // namespace amontons
