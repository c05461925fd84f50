#include "form/point_rows.hpp"

#include "base/error.hpp"
#include "form/cell_kernel.hpp"

#include <cmath>

namespace amontons {
namespace {

/// Two ranks' places of one point differ by rounding; neighbouring points by a good part of the cell.
constexpr double same_place = 1e-6;

constexpr int place_size = 3, head_size = place_size + 1;

using Place = std::array<double, place_size>;

/// Calls work(cell's states, number of its first point, the points' places) for each cell of a body.
template <class States, class Work>
void each_cell(const Mesh& mesh, Space space, States& states, std::size_t body, Work&& work) {
  std::vector<Place> places;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const CellBlock& block = mesh.blocks[b];
    if (std::size_t(block.body) != body) continue;
    const Tabulation& table = *cell_rule(block.type, space).table;
    for (std::int32_t c = 0; c < block.size(); ++c) {
      const auto nodes = block.cell(c);
      places.assign(table.rule->size(), Place{});
      for (int q = 0; q < table.rule->size(); ++q)
        for (std::size_t a = 0; a < nodes.size(); ++a)
          for (int i = 0; i < mesh.dim; ++i)
            places[q][i] += table.value(q)[a] * mesh.position(nodes[a])[i];
      work(states.blocks[b], std::size_t(c) * places.size(), std::span<const Place>(places));
    }
  }
}

double distance(const Place& a, const double* b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

} // namespace

int state_size(const Mesh& mesh, const PointStates& states, std::size_t body) {
  int size = 0;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b)
    if (std::size_t(mesh.blocks[b].body) == body) size = states.blocks[b].components;
  MPI_Allreduce(MPI_IN_PLACE, &size, 1, MPI_INT, MPI_MAX, mesh.comm);
  return size;
}

PointRows point_rows(const Mesh& mesh, Space space, const PointStates& states, std::size_t body) {
  PointRows result;
  result.components = head_size + state_size(mesh, states, body);
  each_cell(mesh, space, states, body, [&](const PointStates::Block& block, std::size_t first, auto places) {
    result.rows.push_back(static_cast<std::int32_t>(places.size()));
    for (std::size_t q = 0; q < places.size(); ++q) {
      const auto state = block.states_of(first + q, 1);
      result.values.insert(result.values.end(), places[q].begin(), places[q].end());
      result.values.push_back(block.dissipated[first + q]);
      result.values.insert(result.values.end(), state.begin(), state.end());
    }
  });
  return result;
}

void put_point_rows(const Mesh& mesh, Space space, std::size_t body, const PointRows& rows, PointStates& states) {
  std::size_t cell = 0, row = 0;
  each_cell(mesh, space, states, body, [&](PointStates::Block& block, std::size_t first, auto places) {
    const auto count = static_cast<std::size_t>(rows.rows[cell++]);
    // Of order 1 simplices have one point, which cannot be taken for another.
    const double size = places.size() > 1 ? distance(places.front(), places.back().data()) : 1e300;
    for (std::size_t q = 0; q < places.size(); ++q) {
      const double* nearest = nullptr;
      for (std::size_t i = row; i < row + count; ++i) {
        const double* const candidate = &rows.values[i * rows.components];
        if (!nearest || distance(places[q], candidate) < distance(places[q], nearest)) nearest = candidate;
      }
      if (!nearest || distance(places[q], nearest) > same_place * size)
        throw UserError("--restart: the body '" + mesh.bodies[body] +
                        "' has other quadrature points than in the run that wrote the checkpoint. Restart with the "
                        "same space.");
      block.dissipated[first + q] = nearest[place_size];
      std::copy_n(nearest + head_size, block.components, block.states.begin() + (first + q) * block.components);
    }
    row += count;
  });
}

} // namespace amontons
