// What output, error estimates and the books ask of the deformable solid, whatever its kinematics and its materials;
// and what all such forms share.
#pragma once

#include "form/form.hpp"
#include "form/point_states.hpp"
#include "math/reference_element.hpp"
#include "math/space.hpp"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace amontons {

/// Strains and stresses at the quadrature points of some consecutive cells of one block. The arrays run cell by cell,
/// point by point. `strain` and `stress` have strain_size components each (see math/tensor.hpp): those of small
/// kinematics, or in finite kinematics the logarithmic strain ln V and Cauchy's stress.
struct PointBatch {
  const CellBlock* block;
  std::int32_t first_cell, num_cells;
  const Tabulation* table;         // of the block's element at the points
  std::span<const double> weights; // reference volume that a point stands for: area x thickness 1 in the plane, with
                                   // 2 π r in axisymmetric space
  std::span<const double> strain, stress;
  std::span<const double> scalars; // as many a point as SolidForm::scalar_names says
};

/// Values at this rank's nodes: num_local x strain_size, and num_local of each of SolidForm::scalar_names.
struct NodalStress {
  std::vector<double> stress, strain;
  std::vector<std::vector<double>> scalars;
};

/// Body forces on the cell bubbles and the bubbles' displacements, cell by cell with the components of a cell together:
/// the work of body loads that nodal forces leave out. Empty where there are no body loads or no bubbles.
struct LoadedBubbles {
  std::vector<double> forces, displacements;
};

/// What the laws make of the points of some consecutive cells of a block in the increment in progress. Point by point.
struct NewPointStates {
  std::size_t block, first_point; // number in Mesh::blocks, in the block
  std::span<const double> weights, states, dissipated;
};

/// All cells of a mesh, with a law a body, and what their points remember. None of the members is collective.
class SolidForm : public Form {
 public:
  const char* name() const override { return "bulk"; }

  virtual Space space() const = 0;
  /// Young's modulus of a body's virgin material, for scales.
  virtual double stiffness(std::int32_t body) const = 0;

  /// Visits the quadrature points of all cells of this rank, batch by batch.
  virtual void for_each_batch(const State& state, const std::function<void(const PointBatch&)>& visit) = 0;
  /// What a point has besides strain and stress; the same for all bodies.
  virtual std::vector<std::string> scalar_names() const { return {}; }

  /// Work of the stresses at the points on the displacement as if it were a virtual one: internal forces · u, with the
  /// bubbles' part, on this rank. Twice the strain energy of a linear body.
  virtual double internal_work(const State& state) = 0;
  /// Energy that the material has turned into heat since the start, on this rank; rises also with the increment in
  /// progress.
  double dissipated_energy(const State& state);
  virtual LoadedBubbles loaded_bubbles(const State&) { return {}; }

  /// The memory of the material as last accepted, for checkpoints.
  const PointStates& point_states() const { return states_; }
  void restore_points(PointStates states) { states_ = std::move(states); }

  void commit(const State& state) override;
  std::any history() const override { return states_; }
  void restore(const std::any& history) override { states_ = std::any_cast<const PointStates&>(history); }

 protected:
  explicit SolidForm(PointStates states) : states_(std::move(states)) {}
  /// Visits the points of all blocks whose law has a memory, up to the first batch of a block without an answer.
  virtual void for_each_new_states(const State& state, const std::function<void(const NewPointStates&)>& visit) = 0;

  PointStates states_; // as last accepted
};

/// Nodal averages by the lumped L2 projection σ_a = ∫ N_a σ / ∫ N_a over the cells around a corner node, with the
/// corner functions N_a of order 1 (those of order 2 have zero or negative integrals); nodes in the middle of edges,
/// faces and cells get the interpolated values. Bodies share no nodes, so averages never cross an interface.
/// Collective.
NodalStress nodal_stress(SolidForm& solid, const Mesh& mesh, const State& state);

/// Throws UserError for inverted cells and, in axisymmetric space, for cells that reach across the axis. Collective.
void check_cells(const Mesh& mesh, Space space);

/// The unknowns of the nodes of each cell couple to each other.
void couple_cells(const DofLayout& layout, Coupling& coupling);

} // namespace amontons
