// Numbers scalars that live at subsets of the mesh nodes (multipliers of one or several slave surfaces), and moves them
// between global vectors and this rank's nodes.
#pragma once

#include "base/petsc.hpp"
#include "mesh/mesh.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace amontons {

/// A scalar at some nodes of the mesh.
struct NodeField {
  std::string name;
  std::vector<std::int32_t> nodes; // local nodes, owned and ghost: every rank that has a node of the field lists it
};

/// For each field, per local node: its place in the owner's sequence (all fields one after the other, nodes ascending),
/// or -1 where the field does not live. `num_owned` receives the length of this rank's sequence. Collective.
std::vector<std::vector<PetscInt>> number_node_fields(const Mesh& mesh, std::span<const NodeField> fields,
                                                      PetscInt& num_owned);

/// A global vector space of node fields of its own, separate from the unknowns. Construction is collective.
class NodeSpace {
 public:
  NodeSpace(const Mesh& mesh, std::vector<NodeField> fields);

  const std::vector<NodeField>& fields() const { return fields_; }
  /// Collective.
  VecHandle new_vector() const;
  /// Values of field `field` at its local nodes, in the order of NodeField::nodes. Collective.
  void gather(Vec global, std::vector<std::vector<double>>& local) const;
  /// Adds local contributions (same shape as gather's) into a global vector, summing over ranks. Collective.
  void add(const std::vector<std::vector<double>>& local, Vec global) const;

 private:
  MPI_Comm comm_;
  std::vector<NodeField> fields_;
  PetscInt num_owned_ = 0;
  VecHandle local_;
  ScatterHandle scatter_;
};

/// First global number of each rank's share, and the total at the end: num_ranks + 1 entries. Collective.
std::vector<PetscInt> rank_offsets(MPI_Comm comm, PetscInt num_owned);

} // namespace amontons
