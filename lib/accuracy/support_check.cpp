// Whether what is supported is where the supports put it.
#include "accuracy/checks.hpp"

#include <algorithm>
#include <cmath>

namespace amontons::accuracy {

Worst check_supports(const CertificateInput& input) {
  const Mesh& mesh = input.mesh;
  double largest = 0.0;
  for (const double value : input.displacement)
    largest = std::max(largest, std::abs(value));
  for (const auto& support : input.supports)
    largest = std::max(largest, std::abs(support.displacement));
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, mesh.comm);
  Worst worst;
  for (const auto& [node, component, displacement] : input.supports) {
    const double off = std::abs(input.displacement[std::size_t(node) * mesh.dim + component] - displacement);
    if (off == 0.0) continue;
    worst.offer(off / largest, [&] {
      return std::string("displacement along ") + "xyz"[component] + " at " + place_text(mesh.position(node));
    });
  }
  return over_ranks(mesh.comm, std::move(worst));
}

} // namespace amontons::accuracy
