// The nodes that several ranks have. Each rank knows of them what its own cells give; here that is brought together, so
// that what is made of all nodes does not depend on how the cells are divided.
#pragma once

#include "fe/node_numbering.hpp"

namespace amontons {

/// Values at all local nodes of a mesh, `components` a node. Construction is collective.
class SharedNodes {
 public:
  SharedNodes(const Mesh& mesh, int components);

  /// Σ v², v the sum over ranks of what each has at a node (num_local x components): this rank's share, which the ranks
  /// have yet to add. (The sum of the ranks' own squares would be another number: the forces of two ranks' cells on a
  /// node cancel.) Collective.
  double square_of_sum(std::span<const double> values) const;

 private:
  int components_;
  std::vector<std::int32_t> nodes_;     // shared ones among the local nodes, ascending
  std::vector<std::uint8_t> is_shared_; // per local node
  NodeSpace space_;                     // a field for each component at nodes_
  VecHandle sums_;
};

} // namespace amontons
