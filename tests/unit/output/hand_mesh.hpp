// Meshes of a few cells with every element type, dealt out to the ranks by a rule of the test's choice: what the tests
// of the output need to see the same mesh under different partitions.
#pragma once

#include "mesh/mesh.hpp"

#include <array>
#include <functional>

namespace amontons {

/// A box of lattice cells [0, cells[0]] x ..., filled with one or two element types.
struct HandMesh {
  int dim = 2;
  int order = 1;
  std::array<int, 3> cells = {4, 2, 1};
  /// Cells with the first index below this are of the tensor-product type and body 0, the rest simplices and body 1.
  int num_tensor_columns = 2;

  /// This rank's part; `rank_of(c)` deals out the lattice cells c = 0, 1 ... (first index fastest). The surface "top"
  /// is made of the facets of tensor-product cells at the largest last coordinate.
  Mesh distribute(MPI_Comm comm, const std::function<int(int)>& rank_of) const;
};

} // namespace amontons
