// The cone and the dissipation of frictional pairs, from the tractions and slips that the samples claim.
#include "accuracy/checks.hpp"
#include "accuracy/facet_cloud.hpp"

#include <algorithm>
#include <cmath>

namespace amontons::accuracy {

namespace {

using Vector = std::array<double, 3>;

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// How far the shear of a point is outside of what is allowed.
double excess(const ContactSamples& samples, std::size_t i) {
  const double size = std::sqrt(dot(samples.shear[i], samples.shear[i]));
  if (samples.status[i] == ContactStatus::Open) return size;
  const double out_of_plane = std::abs(dot(samples.shear[i], samples.normal[i]));
  // In slip the shear is at the limit, neither above nor below.
  const double beyond =
      samples.status[i] == ContactStatus::Slip ? std::abs(size - samples.tau_c[i]) : size - samples.tau_c[i];
  return std::max(beyond, out_of_plane);
}

} // namespace

FrictionChecks check_friction(const CertificateInput& input) {
  const std::size_t count = input.pairs.size();
  std::vector<double> largest(count, 0.0), works(2 * count, 0.0); // per pair: −Σ min(0, work), Σ |work|
  for (std::size_t pair = 0; pair < count; ++pair) {
    const ContactSamples& samples = input.samples[pair];
    for (std::size_t i = 0; i < samples.shear.size(); ++i) {
      largest[pair] = std::max({largest[pair], samples.tau_c[i], std::sqrt(dot(samples.shear[i], samples.shear[i]))});
      const double work = -samples.weight[i] * dot(samples.shear[i], samples.slip[i]);
      works[2 * pair] += std::max(0.0, -work);
      works[2 * pair + 1] += std::abs(work);
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, largest.data(), static_cast<int>(count), MPI_DOUBLE, MPI_MAX, input.mesh.comm);
  MPI_Allreduce(MPI_IN_PLACE, works.data(), static_cast<int>(2 * count), MPI_DOUBLE, MPI_SUM, input.mesh.comm);
  FrictionChecks checks;
  for (std::size_t pair = 0; pair < count; ++pair) {
    const ContactSamples& samples = input.samples[pair];
    for (std::size_t i = 0; i < samples.shear.size(); ++i)
      if (const double over = excess(samples, i); over > 0.0)
        checks.cone.offer(over / largest[pair], [&] {
          return "pair '" + input.pairs[pair].name + "' at " +
                 place_text(std::span(samples.place[i]).first(input.mesh.dim));
        });
    if (works[2 * pair] > 0.0)
      checks.dissipation.offer(works[2 * pair] / works[2 * pair + 1],
                               [&] { return "pair '" + input.pairs[pair].name + "'"; });
  }
  checks.cone = over_ranks(input.mesh.comm, std::move(checks.cone));
  return checks;
}

} // namespace amontons::accuracy
