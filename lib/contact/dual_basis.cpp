#include "contact/dual_basis.hpp"

#include "mesh/topology.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <map>

namespace amontons {

namespace {

/// Smallest eigenvalue of the scaled mass matrix, whose largest is one: 1/3, 1/4 and 1/9 on whole segments, triangles
/// and quadrilaterals of order 1, a sixth of the covered share of a segment when that is small. A facet with less than
/// this drops out.
constexpr double smallest_cover = 1e-6;

/// A middle of an edge is a quarter of each end and half of its own control; the middle of a nine-node quadrilateral is
/// the product of two such rules.
Eigen::MatrixXd bernstein_rows(ElementType type) {
  const int n = num_nodes(type);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Identity(n, n);
  const auto& supports = topology(type).supports;
  for (int a = num_vertices(type); a < n; ++a) {
    const bool is_centre = supports[a].size() == 4;
    for (const int corner : supports[a])
      rows(a, corner) = is_centre ? 1.0 / 16.0 : 1.0 / 4.0;
    rows(a, a) = is_centre ? 1.0 / 4.0 : 1.0 / 2.0;
    for (int edge = num_vertices(type); is_centre && edge < a; ++edge)
      rows(a, edge) = 1.0 / 8.0;
  }
  return rows;
}

struct Change {
  Eigen::MatrixXd forward, backward;
};

const Change& change(ElementType type) {
  static std::map<ElementType, Change> known;
  auto [place, is_new] = known.try_emplace(type);
  if (is_new) {
    place->second.forward = bernstein_rows(type);
    place->second.backward = place->second.forward.inverse();
  }
  return place->second;
}

} // namespace

const Eigen::MatrixXd& nodes_from_controls(ElementType type) { return change(type).forward; }

const Eigen::MatrixXd& controls_from_nodes(ElementType type) { return change(type).backward; }

/// ψ = N M⁻¹ D with M_ij = ∫ N_i N_j, D = diag ∫ N_i; through the scaled S = D^-1/2 M D^-1/2, whose condition does not
/// depend on how unequal the covered shares of the nodes are.
std::optional<DualBasis> dual_basis(const PointTable& shape, std::span<const double> weights) {
  const Eigen::Map<const Eigen::VectorXd> w(weights.data(), static_cast<Eigen::Index>(weights.size()));
  DualBasis basis;
  basis.integral = shape.transpose() * w;
  if (weights.empty() || basis.integral.minCoeff() <= 0.0) return std::nullopt;
  const Eigen::VectorXd root = basis.integral.cwiseSqrt(), inverse_root = root.cwiseInverse();
  const Eigen::MatrixXd mass = shape.transpose() * w.asDiagonal() * shape;
  const Eigen::MatrixXd scaled = inverse_root.asDiagonal() * mass * inverse_root.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  if (eigen.eigenvalues()[0] < smallest_cover) return std::nullopt;
  const Eigen::MatrixXd inverse =
      eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
  basis.values = shape * (inverse_root.asDiagonal() * inverse * root.asDiagonal());
  return basis;
}

} // namespace amontons
