#include "accuracy/followed_peak.hpp"

#include "math/reference_element.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <utility>

namespace amontons {

namespace {

/// Facets to each side that the fit reaches over: the least with more points of support than a quadratic has terms.
constexpr double reach = 2.0;

Eigen::Vector3d place_of(const Mesh& mesh, std::int32_t node) {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  for (int i = 0; i < mesh.dim; ++i)
    place[i] = mesh.position(node)[i];
  return place;
}

/// Gives all ranks the numbers of the rank whose `key` is the largest; the first of equals. Collective.
template <std::size_t n>
double take_from_largest(MPI_Comm comm, double key, std::array<double, n>& numbers) {
  struct {
    double value;
    int rank;
  } best{key, 0};
  MPI_Comm_rank(comm, &best.rank);
  MPI_Allreduce(MPI_IN_PLACE, &best, 1, MPI_DOUBLE_INT, MPI_MAXLOC, comm);
  MPI_Bcast(numbers.data(), static_cast<int>(n), MPI_DOUBLE, best.rank, comm);
  return best.value;
}

/// Where the largest pressure is, what surface there is around it.
struct Peak {
  double pressure = 0.0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double size = 0.0; // of the nearest facet
};

Peak find_peak(const Mesh& mesh, const ContactSamples& samples, std::span<const double> nodal) {
  Peak peak;
  std::array<double, 3> place{};
  double largest = 0.0;
  for (const auto node : samples.nodes)
    if (nodal[node] > largest) {
      largest = nodal[node];
      const auto found = place_of(mesh, node);
      place = {found[0], found[1], found[2]};
    }
  peak.pressure = take_from_largest(mesh.comm, largest, place);
  peak.place = {place[0], place[1], place[2]};
  std::array<double, 4> surface{};
  double nearest = -1e300; // minus the distance
  for (std::size_t q = 0; q < samples.size(); ++q) {
    const double closeness = -(Eigen::Vector3d(samples.place[q].data()) - peak.place).norm();
    if (closeness <= nearest) continue;
    nearest = closeness;
    surface = {samples.normal[q][0], samples.normal[q][1], samples.normal[q][2], samples.facet_size[q]};
  }
  take_from_largest(mesh.comm, nearest, surface);
  peak.normal = {surface[0], surface[1], surface[2]};
  peak.size = surface[3];
  return peak;
}

/// Unit vectors along the surface: one in 2D, two in 3D.
std::vector<Eigen::Vector3d> directions_along(int dim, const Eigen::Vector3d& normal) {
  if (dim == 2) return {{-normal[1], normal[0], 0.0}};
  const Eigen::Vector3d first = normal.unitOrthogonal();
  return {first, normal.cross(first)};
}

/// 1, s_a, s_a s_b.
Eigen::VectorXd terms_of(const std::vector<double>& s) {
  const auto n = static_cast<Eigen::Index>(s.size());
  Eigen::VectorXd terms(1 + n + n * (n + 1) / 2);
  Eigen::Index next = 0;
  terms[next++] = 1.0;
  for (const double value : s)
    terms[next++] = value;
  for (std::size_t a = 0; a < s.size(); ++a)
    for (std::size_t b = a; b < s.size(); ++b)
      terms[next++] = s[a] * s[b];
  return terms;
}

/// The pressure at a point, linear between the corners of its facet.
double linear_pressure(const FacetSet& slave, const ContactSamples& samples, std::size_t q,
                       std::span<const double> nodal) {
  const ElementType corners = linear_element(slave.types[samples.facet[q]]);
  std::array<double, 4> shape{};
  const auto count = static_cast<std::size_t>(num_nodes(corners));
  shape_values(corners, std::span(samples.xi[q]).first(static_cast<std::size_t>(element_dim(corners))),
               std::span(shape).first(count));
  double value = 0.0;
  for (std::size_t a = 0; a < count; ++a)
    value += shape[a] * nodal[slave.facet(samples.facet[q])[a]];
  return value;
}

} // namespace

double peak_deviation(const Mesh& mesh, const FacetSet& slave, const ContactSamples& samples,
                      std::span<const double> nodal) {
  const Peak peak = find_peak(mesh, samples, nodal);
  if (peak.pressure <= 0.0 || peak.size <= 0.0) return 0.0;
  const double radius = reach * peak.size;
  const auto along = directions_along(mesh.dim, peak.normal);
  const Eigen::Index n = terms_of(std::vector<double>(along.size())).size();
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(n, n + 1); // Σ w t tᵀ and Σ w t p
  for (std::size_t q = 0; q < samples.size(); ++q) {
    const Eigen::Vector3d away = (Eigen::Vector3d(samples.place[q].data()) - peak.place) / radius;
    if (away.squaredNorm() >= 1.0) continue;
    std::vector<double> s;
    for (const auto& direction : along)
      s.push_back(away.dot(direction));
    const auto terms = terms_of(s);
    const double weight = samples.weight[q] * std::pow(1.0 - away.squaredNorm(), 2);
    sums.leftCols(n) += weight * terms * terms.transpose();
    sums.col(n) += weight * linear_pressure(slave, samples, q, nodal) / peak.pressure * terms;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, mesh.comm);
  const Eigen::VectorXd quadratic = sums.leftCols(n).completeOrthogonalDecomposition().solve(sums.col(n));
  return std::abs(quadratic[0] - 1.0);
}

} // namespace amontons
