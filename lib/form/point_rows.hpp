// The memory of quadrature points as rows of numbers that can be found again when the mesh has been distributed in
// another way: for checkpoints.
#pragma once

#include "form/point_states.hpp"
#include "math/space.hpp"

#include <vector>

namespace amontons {

/// A row for each point of a body on this rank: its reference place (three numbers), the energy dissipated per volume,
/// the state. The points of a cell come in another order when its nodes do, so a row says where it belongs.
struct PointRows {
  int components = 0;             // numbers a row
  std::vector<std::int32_t> rows; // per cell of the body on this rank, block by block
  std::vector<double> values;
};

/// Numbers of the law's state at a point of the body, the same on every rank; 0 for a body without memory. Collective.
int state_size(const Mesh& mesh, const PointStates& states, std::size_t body);

/// Of a body with memory. Collective.
PointRows point_rows(const Mesh& mesh, Space space, const PointStates& states, std::size_t body);

/// Puts the rows back into `states`, which has the sizes of this mesh and space. Throws UserError when a point finds no
/// row at its place.
void put_point_rows(const Mesh& mesh, Space space, std::size_t body, const PointRows& rows, PointStates& states);

} // namespace amontons
