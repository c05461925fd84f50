// The memory of the quadrature points of a solid: what its laws remember of the accepted states.
#pragma once

#include "mesh/mesh.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace amontons {

struct PointStates {
  /// Of one block of cells, cell by cell and point by point. Empty for a law without memory.
  struct Block {
    int components = 0; // numbers of the law's state a point
    int points = 0;     // a cell
    std::vector<double> states;
    std::vector<double> dissipated; // energy per reference volume since the start, one number a point
    bool has_memory() const { return components > 0; }
  };
  std::vector<Block> blocks; // as Mesh::blocks
  double time = 0.0;         // of the last accepted state
};

} // namespace amontons
