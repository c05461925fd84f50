// The deformable solid at finite strain: internal forces, tangent, energies and stresses over all cells of a mesh,
// total Lagrangian, with a law per body. It does not know supports, loads or contact.
#pragma once

#include "form/solid.hpp"
#include "material/finite_law.hpp"

namespace amontons {

/// Quadrilaterals and hexahedra keep only the constant (order 1) or linear (order 2) part of the volume ratio and do
/// not lock near incompressibility (finite_kernel.hpp). Triangles and tetrahedra are integrated as they are: those of
/// order 1 lock there, those of order 2 lose accuracy.
class FiniteBulkForm : public SolidForm {
 public:
  /// One law for each of Mesh::bodies. `layout` must outlive the form. Throws UserError for inverted cells, in
  /// axisymmetric space for cells that reach across the axis, and std::invalid_argument for plane stress. Collective.
  FiniteBulkForm(const DofLayout& layout, Space space, std::vector<FiniteLaw> laws);

  void couple(Coupling& coupling) const override { couple_cells(layout_, coupling); }
  /// Fails where a cell is turned inside out or a law has no answer.
  void add_residual(const State& state, Residual& residual) override;
  void add_tangent(const State& state, Tangent& tangent) override;
  bool tangent_is_symmetric() const override;
  bool wants_predictor() const override { return true; }
  double stored_energy(const State& state) override;

  Space space() const override { return space_; }
  double stiffness(std::int32_t body) const override;
  void for_each_batch(const State& state, const std::function<void(const PointBatch&)>& visit) override;
  /// The volume ratio det F̄, and with plasticity the accumulated plastic strain.
  std::vector<std::string> scalar_names() const override;
  double internal_work(const State& state) override;

 private:
  void for_each_new_states(const State& state, const std::function<void(const NewPointStates&)>& visit) override;
  /// Calls work(kernel, block with all that belongs to it) for each block of cells.
  template <class Work>
  void each_block(const State& state, Work&& work);

  const DofLayout& layout_;
  Space space_;
  std::vector<FiniteLaw> laws_;
};

} // namespace amontons
