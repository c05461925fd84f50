#include "accuracy/path_difference.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

namespace {

/// Part of a pair's largest traction that points of different status must differ by.
constexpr double border = 0.01;

using Vector = std::array<double, 3>;

double square(const Vector& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

/// The largest distance of a node's vector in `a` to that in `b` (empty: to zero) on this rank.
double largest_distance(int dim, std::span<const double> a, std::span<const double> b) {
  double largest = 0.0;
  for (std::size_t node = 0; node + dim <= a.size(); node += dim) {
    double sum = 0.0;
    for (int c = 0; c < dim; ++c)
      sum += std::pow(a[node + c] - (b.empty() ? 0.0 : b[node + c]), 2);
    largest = std::max(largest, sum);
  }
  return std::sqrt(largest);
}

double relative(double difference, double scale) { return difference > 0.0 ? difference / scale : 0.0; }

} // namespace

double PathDifference::largest() const { return std::max({displacement, pressure, shear}); }

void PathScales::include(const PathScales& other) {
  displacement = std::max(displacement, other.displacement);
  pairs.resize(std::max(pairs.size(), other.pairs.size()));
  for (std::size_t i = 0; i < other.pairs.size(); ++i) {
    auto& mine = pairs[i];
    const auto& its = other.pairs[i];
    mine.pressure = std::max(mine.pressure, its.pressure);
    mine.shear = std::max(mine.shear, its.shear);
    mine.traction = std::max(mine.traction, its.traction);
    mine.area = std::max(mine.area, its.area);
  }
}

PathScales path_scales(MPI_Comm comm, const PathState& state) {
  const std::size_t count = state.samples.size();
  std::vector<double> sums(3 * count, 0.0), largest(count + 1, 0.0);
  largest[count] = largest_distance(state.dim, state.displacement, {});
  for (std::size_t pair = 0; pair < count; ++pair) {
    const auto& samples = state.samples[pair];
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double weight = samples.weight[i];
      sums[3 * pair] += weight * samples.pressure[i] * samples.pressure[i];
      if (samples.has_friction) sums[3 * pair + 1] += weight * samples.tau_c[i] * samples.tau_c[i];
      if (samples.status[i] != ContactStatus::Open) sums[3 * pair + 2] += weight;
      largest[pair] = std::max(largest[pair], std::sqrt(square(samples.traction(i))));
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, comm);
  MPI_Allreduce(MPI_IN_PLACE, largest.data(), static_cast<int>(largest.size()), MPI_DOUBLE, MPI_MAX, comm);
  PathScales scales{.displacement = largest[count], .pairs = {}};
  for (std::size_t pair = 0; pair < count; ++pair)
    scales.pairs.push_back({.pressure = std::sqrt(sums[3 * pair]),
                            .shear = std::sqrt(sums[3 * pair + 1]),
                            .traction = largest[pair],
                            .area = sums[3 * pair + 2]});
  return scales;
}

PathDifference path_difference(MPI_Comm comm, const PathState& a, const PathState& b, const PathScales& scales) {
  const std::size_t count = a.samples.size();
  std::vector<double> sums(3 * count, 0.0);
  for (std::size_t pair = 0; pair < count; ++pair) {
    const auto &one = a.samples[pair], &other = b.samples[pair];
    const double threshold = std::pow(border * scales.pairs[pair].traction, 2);
    for (std::size_t i = 0; i < one.size(); ++i) {
      const double weight = one.weight[i];
      sums[3 * pair] += weight * std::pow(one.pressure[i] - other.pressure[i], 2);
      if (one.has_friction) sums[3 * pair + 1] += weight * square(minus(one.shear[i], other.shear[i]));
      if (one.status[i] != other.status[i] && square(minus(one.traction(i), other.traction(i))) > threshold)
        sums[3 * pair + 2] += weight;
    }
  }
  double moved = largest_distance(a.dim, a.displacement, b.displacement);
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, comm);
  MPI_Allreduce(MPI_IN_PLACE, &moved, 1, MPI_DOUBLE, MPI_MAX, comm);
  PathDifference difference{.displacement = relative(moved, scales.displacement)};
  for (std::size_t pair = 0; pair < count; ++pair) {
    const auto& scale = scales.pairs[pair];
    difference.pressure = std::max(difference.pressure, relative(std::sqrt(sums[3 * pair]), scale.pressure));
    difference.shear = std::max(difference.shear, relative(std::sqrt(sums[3 * pair + 1]), scale.shear));
    difference.status = std::max(difference.status, relative(sums[3 * pair + 2], scale.area));
  }
  return difference;
}

} // namespace amontons
