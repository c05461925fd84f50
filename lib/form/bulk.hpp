// The deformable solid: internal forces, stiffness, stored energy and stress recovery over all cells of a mesh, with a
// law per body. Small strains. It does not know supports, loads or contact.
#pragma once

#include "form/form.hpp"
#include "material/law.hpp"
#include "math/reference_element.hpp"
#include "math/space.hpp"

#include <functional>
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

/// Quadrilaterals and hexahedra are integrated with mean dilatation (except in plane stress) and are as accurate at
/// nu = 0.4999 as at 0.3. Triangles and tetrahedra have full integration: of order 1 they lock near incompressibility,
/// of order 2 they lose one order of convergence there.
class BulkForm : public Form {
 public:
  /// One law for each of Mesh::bodies, made for the same space. `layout` must outlive the form. Throws UserError for
  /// inverted cells and, in axisymmetric space, for cells that reach across the axis. Collective.
  BulkForm(const DofLayout& layout, Space space, std::vector<BulkLawPtr> laws);

  const char* name() const override { return "bulk"; }
  void couple(Coupling& coupling) const override;
  void add_residual(const State& state, Residual& residual) override;
  void add_tangent(const State& state, Tangent& tangent) override;
  bool tangent_is_constant() const override;
  double stored_energy(const State& state) override;

  /// Visits the quadrature points of all cells of this rank, batch by batch. Not collective.
  void for_each_batch(std::span<const double> displacement, const std::function<void(const PointBatch&)>& visit) const;

  /// Nodal averages of stress and strain by the lumped L2 projection σ_a = ∫ N_a σ / ∫ N_a over the cells around a
  /// corner node, with the corner functions N_a of order 1 (those of order 2 have zero or negative integrals); nodes in
  /// the middle of edges, faces and cells get the interpolated values. Bodies share no nodes, so averages never cross
  /// an interface. In plane stress the zz strain is the implied one. Collective.
  NodalStress nodal_stress(std::span<const double> displacement) const;

  Space space() const { return space_; }
  const BulkLaw& law(std::int32_t body) const { return *laws_[body]; }

 private:
  void check_cells() const;

  const DofLayout& layout_;
  Space space_;
  std::vector<BulkLawPtr> laws_;
};

} // namespace amontons
