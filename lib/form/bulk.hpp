// The deformable solid: internal forces, stiffness, stored energy and stress recovery over all cells of a mesh, with a
// law per body. Small strains. It does not know supports, loads or contact.
#pragma once

#include "form/loads.hpp"
#include "form/solid.hpp"
#include "material/law.hpp"

#include <optional>

namespace amontons {

/// Quadrilaterals and hexahedra are integrated with mean dilatation, triangles and tetrahedra of order 2 have a cell
/// bubble (neither in plane stress, where nothing locks): they are as accurate at nu = 0.4999 as at 0.3. Triangles and
/// tetrahedra of order 1 lock near incompressibility.
class BulkForm : public SolidForm {
 public:
  /// One law for each of Mesh::bodies, made for the same space. `body_loads` act on the cell bubbles, which a LoadForm
  /// cannot reach; give it the same ones. `layout` must outlive the form. Throws UserError for inverted cells and, in
  /// axisymmetric space, for cells that reach across the axis. Collective.
  BulkForm(const DofLayout& layout, Space space, std::vector<BulkLawPtr> laws, std::vector<BodyLoad> body_loads = {});

  void couple(Coupling& coupling) const override { couple_cells(layout_, coupling); }
  void add_residual(const State& state, Residual& residual) override;
  void add_tangent(const State& state, Tangent& tangent) override;
  bool tangent_is_constant() const override;
  double stored_energy(const State& state) override;

  Space space() const override { return space_; }
  double stiffness(std::int32_t body) const override { return laws_[body]->stiffness(); }
  /// In plane stress the zz strain is the implied one.
  void for_each_batch(const State& state, const std::function<void(const PointBatch&)>& visit) override;
  double internal_work(const State& state) override { return 2.0 * stored_energy(state); }
  LoadedBubbles loaded_bubbles(const State& state) override;
  const PointStates& point_states() const override { return states_; }
  void restore_points(PointStates states) override { states_ = std::move(states); }

  const BulkLaw& law(std::int32_t body) const { return *laws_[body]; }

 private:
  /// Calls work(kernel, block with all that belongs to it) for each block of cells.
  template <class Work>
  void each_block(double time, Work&& work);

  const DofLayout& layout_;
  Space space_;
  std::vector<BulkLawPtr> laws_;
  std::vector<BodyLoad> body_loads_;
  std::vector<std::vector<double>> bubble_forces_; // block by block, dim a cell; empty: none
  std::optional<double> bubble_forces_time_;
  PointStates states_;
};

} // namespace amontons
