// The deformable solid: internal forces, stiffness, stored energy and stress recovery over all cells of a mesh, with a
// law per body. Small strains. It does not know supports, loads or contact.
#pragma once

#include "form/form.hpp"
#include "form/loads.hpp"
#include "material/law.hpp"
#include "math/reference_element.hpp"
#include "math/space.hpp"

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace amontons {

/// Strains and stresses at the quadrature points of some consecutive cells of one block. The arrays run cell by cell,
/// point by point; `strain` and `stress` have strain_size components each (see math/tensor.hpp).
struct PointBatch {
  const CellBlock* block;
  std::int32_t first_cell, num_cells;
  const Tabulation* table;         // of the block's element at the points
  std::span<const double> weights; // volume that a point stands for: area x thickness 1 in the plane, with 2 π r in
                                   // axisymmetric space
  std::span<const double> strain, stress;
};

/// Values at this rank's nodes (num_local x strain_size).
struct NodalStress {
  std::vector<double> stress, strain;
};

/// Body forces on the cell bubbles and the bubbles' displacements, cell by cell with the components of a cell together:
/// the work of body loads that nodal forces leave out. Empty where there are no body loads or no bubbles.
struct LoadedBubbles {
  std::vector<double> forces, displacements;
};

/// Quadrilaterals and hexahedra are integrated with mean dilatation, triangles and tetrahedra of order 2 have a cell
/// bubble (neither in plane stress, where nothing locks): they are as accurate at nu = 0.4999 as at 0.3. Triangles and
/// tetrahedra of order 1 lock near incompressibility.
class BulkForm : public Form {
 public:
  /// One law for each of Mesh::bodies, made for the same space. `body_loads` act on the cell bubbles, which a LoadForm
  /// cannot reach; give it the same ones. `layout` must outlive the form. Throws UserError for inverted cells and, in
  /// axisymmetric space, for cells that reach across the axis. Collective.
  BulkForm(const DofLayout& layout, Space space, std::vector<BulkLawPtr> laws, std::vector<BodyLoad> body_loads = {});

  const char* name() const override { return "bulk"; }
  void couple(Coupling& coupling) const override;
  void add_residual(const State& state, Residual& residual) override;
  void add_tangent(const State& state, Tangent& tangent) override;
  bool tangent_is_constant() const override;
  double stored_energy(const State& state) override;

  /// Not collective.
  LoadedBubbles loaded_bubbles(const State& state);

  /// Visits the quadrature points of all cells of this rank, batch by batch. Not collective.
  void for_each_batch(const State& state, const std::function<void(const PointBatch&)>& visit);

  /// Nodal averages of stress and strain by the lumped L2 projection σ_a = ∫ N_a σ / ∫ N_a over the cells around a
  /// corner node, with the corner functions N_a of order 1 (those of order 2 have zero or negative integrals); nodes in
  /// the middle of edges, faces and cells get the interpolated values. Bodies share no nodes, so averages never cross
  /// an interface. In plane stress the zz strain is the implied one. Collective.
  NodalStress nodal_stress(const State& state);

  Space space() const { return space_; }
  const BulkLaw& law(std::int32_t body) const { return *laws_[body]; }

 private:
  void check_cells() const;
  /// Calls work(kernel, block with all that belongs to it) for each block of cells.
  template <class Work>
  void each_block(double time, Work&& work);

  const DofLayout& layout_;
  Space space_;
  std::vector<BulkLawPtr> laws_;
  std::vector<BodyLoad> body_loads_;
  std::vector<std::vector<double>> bubble_forces_; // block by block, dim a cell; empty: none
  std::optional<double> bubble_forces_time_;
};

} // namespace amontons
