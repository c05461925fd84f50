// The deformable solid at small strain: internal forces, stiffness, energies and stresses over all cells of a mesh,
// with a law per body. It does not know supports, loads or contact.
#pragma once

#include "form/loads.hpp"
#include "form/solid.hpp"
#include "material/small_law.hpp"

#include <optional>

namespace amontons {

/// Quadrilaterals and hexahedra are integrated with mean dilatation, triangles and tetrahedra of order 2 have a cell
/// bubble (neither in plane stress, where nothing locks): they are as accurate at nu = 0.4999 as at 0.3. Triangles and
/// tetrahedra of order 1 lock near incompressibility. Linear elastic bodies are assembled once, by a kernel of their
/// own, also beside others.
class BulkForm : public SolidForm {
 public:
  /// One law for each of Mesh::bodies. `body_loads` act on the cell bubbles, which a LoadForm cannot reach; give it the
  /// same ones. `layout` must outlive the form. Throws UserError for inverted cells, in axisymmetric space for cells
  /// that reach across the axis, and for elastic constants out of range; std::invalid_argument for plane stress with a
  /// law that is not linear elastic. Collective.
  BulkForm(const DofLayout& layout, Space space, std::vector<SmallLaw> laws, std::vector<BodyLoad> body_loads = {});

  void couple(Coupling& coupling) const override { couple_cells(layout_, coupling); }
  /// Fails where a law has no answer, or the bubbles find no equilibrium with it.
  void add_residual(const State& state, Residual& residual) override;
  void add_tangent(const State& state, Tangent& tangent) override;
  void add_constant_tangent(const State& state, Tangent& tangent) override;
  void add_changing_tangent(const State& state, Tangent& tangent) override;
  bool tangent_is_constant() const override;
  bool wants_predictor() const override { return !tangent_is_constant(); }
  double stored_energy(const State& state) override;

  Space space() const override { return space_; }
  double stiffness(std::int32_t body) const override { return moduli_[body].young; }
  /// In plane stress the zz strain is the implied one.
  void for_each_batch(const State& state, const std::function<void(const PointBatch&)>& visit) override;
  /// With plasticity the accumulated plastic strain.
  std::vector<std::string> scalar_names() const override;
  double internal_work(const State& state) override;
  LoadedBubbles loaded_bubbles(const State& state) override;

 private:
  void for_each_new_states(const State& state, const std::function<void(const NewPointStates&)>& visit) override;
  struct BodyModuli {
    double young;
    std::optional<Lame> linear; // the constants of a linear elastic body in this space
  };
  /// Calls work(kernel, block with all that belongs to it, its number) for each block of cells.
  template <class Work>
  void each_block(const State& state, Work&& work);

  const DofLayout& layout_;
  Space space_;
  std::vector<SmallLaw> laws_;
  std::vector<BodyModuli> moduli_;
  std::vector<BodyLoad> body_loads_;
  std::vector<std::vector<double>> bubble_forces_; // block by block, dim a cell; empty: none
  std::optional<double> bubble_forces_time_;
};

} // namespace amontons
