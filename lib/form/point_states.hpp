// The memory of the quadrature points of a solid: what its laws remember of the accepted states.
#pragma once

#include "mesh/mesh.hpp"

#include <algorithm>
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
    /// The states of `count` points from number `first` on.
    std::span<const double> states_of(std::size_t first, std::size_t count) const {
      return std::span(states).subspan(first * components, count * components);
    }
    std::span<const double> dissipated_at(std::size_t first, std::size_t count) const {
      return std::span(dissipated).subspan(first, count);
    }
    /// Puts new states and the energy dissipated on the way to them in place, from point `first` on.
    void accept(std::size_t first, std::span<const double> new_states, std::span<const double> increments) {
      std::copy(new_states.begin(), new_states.end(), states.begin() + std::ptrdiff_t(first) * components);
      for (std::size_t p = 0; p < increments.size(); ++p)
        dissipated[first + p] += increments[p];
    }
  };
  std::vector<Block> blocks; // as Mesh::blocks
  double time = 0.0;         // of the last accepted state
};

} // namespace amontons
