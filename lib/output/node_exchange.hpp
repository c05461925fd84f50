// Values at the nodes of a mesh moved between owners and ghosts: what the output needs to number the nodes of a surface
// without gathering it.
#pragma once

#include "mesh/mesh.hpp"

#include <span>

namespace amontons {

/// One number per local node. Both operations are collective.
class NodeExchange {
 public:
  explicit NodeExchange(const Mesh& mesh);
  /// Ghost values become those of their owners.
  void to_ghosts(std::span<double> local);
  /// Owned values become the largest of all copies.
  void largest_to_owners(std::span<double> local);

 private:
  void load(std::span<const double> local);
  void unload(std::span<double> local) const;
  VecHandle vec_;
};

} // namespace amontons
