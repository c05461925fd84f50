#include "mesh/welded_bodies.hpp"

#include <numeric>

namespace amontons {

std::vector<std::int32_t> welded_bodies(const Mesh& mesh) {
  const std::size_t count = mesh.bodies.size();
  std::vector<std::uint8_t> shares(count * count, 0);
  std::vector<std::int32_t> body_of_node(mesh.num_local(), -1);
  for (const CellBlock& block : mesh.blocks)
    for (const std::int32_t node : block.nodes) {
      std::int32_t& known = body_of_node[node];
      if (known < 0) known = block.body;
      shares[known * count + block.body] = shares[block.body * count + known] = 1;
    }
  MPI_Allreduce(MPI_IN_PLACE, shares.data(), static_cast<int>(shares.size()), MPI_UINT8_T, MPI_MAX, mesh.comm);
  std::vector<std::int32_t> first(count);
  std::iota(first.begin(), first.end(), 0);
  // Spread the smallest number until nothing changes; chains of bodies are short.
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t a = 0; a < count; ++a)
      for (std::size_t b = 0; b < count; ++b)
        if (shares[a * count + b] != 0 && first[b] < first[a]) {
          first[a] = first[b];
          changed = true;
        }
  }
  return first;
}

} // namespace amontons
