// Which unknown of the algebraic system stands for which quantity: displacement components at mesh nodes, multipliers
// at slave nodes, groups that move as one. Everything that assembles does so through the equation numbers given here.
#pragma once

#include "base/petsc.hpp"
#include "fe/node_numbering.hpp"
#include "mesh/mesh.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace amontons {

/// All nodes of a group share one displacement component (a rigid grip in that direction).
struct TiedGroup {
  std::string group;
  int component;
};

/// Numbers the unknowns. Each rank owns [first_equation(), first_equation() + num_owned()): dim displacement components
/// of each owned node in node order, then its share of the extra fields (scalar unknowns such as multipliers). Equation
/// numbers are global. Construction is collective.
class DofLayout {
 public:
  DofLayout(const Mesh& mesh, std::vector<TiedGroup> tied, std::span<const NodeField> extra);

  const Mesh& mesh() const { return *mesh_; }
  int dim() const { return mesh_->dim; }
  PetscInt num_owned() const { return num_owned_; }
  PetscInt num_global() const { return num_global_; }
  PetscInt first_equation() const { return first_equation_; }
  PetscInt num_extra() const { return num_extra_global_; }

  /// Equation of a displacement component of a local node, after ties: all members of a tied group share one.
  PetscInt equation(std::int32_t node, int component) const {
    return equations_[std::size_t(node) * dim() + component];
  }
  /// dim() equations per local node, node by node.
  std::span<const PetscInt> equations() const { return equations_; }
  /// Equation of extra field `field` at a local node, -1 where it has none.
  PetscInt extra_equation(int field, std::int32_t node) const { return extra_[field][node]; }

  /// Unknowns that may share a matrix block: a node's displacement, or one extra scalar. Blocks are numbered globally,
  /// rank by rank; block b has equations [block_begin(b), block_begin(b) + block_size(b)).
  PetscInt block_of(PetscInt equation) const;
  PetscInt block_begin(PetscInt block) const;
  PetscInt block_size(PetscInt block) const;
  PetscInt first_block() const { return block_offsets_[rank_]; }
  PetscInt num_owned_blocks() const { return block_offsets_[rank_ + 1] - block_offsets_[rank_]; }
  /// The rank that owns a block.
  int block_owner(PetscInt block) const;

  /// Equations owned by this rank that stand for nothing because their component follows a tied group's.
  const std::vector<PetscInt>& idle_equations() const { return idle_; }
  /// Equation of tied group i (in the order given), known on every rank.
  PetscInt tied_equation(std::size_t i) const { return tied_equations_[i]; }
  const std::vector<TiedGroup>& tied() const { return tied_; }

  /// A new global vector of unknowns, zero. Collective.
  VecHandle new_vector() const;
  /// Displacement of all local nodes (num_local x dim) from a global vector, ties and ghosts included. Collective.
  void gather_displacement(Vec global, std::span<double> local) const;
  /// The opposite: writes what gather_displacement gave into the equations of this rank.
  void put_displacement(std::span<const double> local, Vec global) const;
  /// Adds a local array (num_local x dim) of nodal forces into a global vector: sums over ranks and tied groups.
  /// Collective.
  void add_forces(std::span<const double> local, Vec global) const;
  /// Makes of the displacement equations of a global vector the largest of their own value and of what local arrays
  /// (num_local x dim) have at their nodes, on all ranks and in all of a tied group. Collective.
  void take_largest(std::span<const double> local, Vec global) const;

 private:
  void bring(std::span<const double> local, Vec global, InsertMode how) const;

  const Mesh* mesh_;
  std::vector<TiedGroup> tied_;
  int rank_ = 0;
  PetscInt num_owned_ = 0, num_global_ = 0, first_equation_ = 0, num_extra_global_ = 0;
  std::vector<PetscInt> node_offsets_, equation_offsets_, block_offsets_; // per rank, with the total at the end
  std::vector<PetscInt> equations_, idle_, tied_equations_;
  std::vector<std::vector<PetscInt>> extra_;
  VecHandle local_;
  ScatterHandle scatter_;
};

} // namespace amontons
