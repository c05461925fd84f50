#include "accuracy/kinematics_audit.hpp"

#include "math/reference_element.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace amontons {

namespace {

/// H = ∂u/∂X at point 0 of a rule, 3 x 3; in axisymmetric space with u_r / r as hoop entry.
Eigen::Matrix3d displacement_gradient(const Mesh& mesh, Space space, std::span<const double> displacement,
                                      std::span<const std::int32_t> nodes, const Tabulation& table) {
  const int dim = mesh.dim;
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(dim, dim), change = jacobian; // ∂X/∂ξ, ∂u/∂ξ
  double radius = 0, radial = 0;
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    const auto X = mesh.position(nodes[a]);
    const auto u = displacement.subspan(std::size_t(nodes[a]) * dim, dim);
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j) {
        jacobian(i, j) += X[i] * table.gradient(0)[a * dim + j];
        change(i, j) += u[i] * table.gradient(0)[a * dim + j];
      }
    radius += table.value(0)[a] * X[0];
    radial += table.value(0)[a] * u[0];
  }
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  H.topLeftCorner(dim, dim) = change * jacobian.inverse();
  if (space == Space::Axisymmetric) H(2, 2) = radial / radius;
  return H;
}

} // namespace

KinematicsAudit audit_kinematics(const Mesh& mesh, Space space, std::span<const double> displacement) {
  std::array<double, 3> largest{}; // rotation, strain, neglected
  for (const auto& block : mesh.blocks) {
    const Tabulation& centre = tabulation(block.type, 1);
    for (std::int32_t c = 0; c < block.size(); ++c) {
      const Eigen::Matrix3d H = displacement_gradient(mesh, space, displacement, block.cell(c), centre);
      // |w|² = ½ |skew|², each component of w being there twice.
      const std::array<double, 3> values = {(0.5 * (H - H.transpose())).norm() / std::sqrt(2.0),
                                            (0.5 * (H + H.transpose())).norm(), (0.5 * H.transpose() * H).norm()};
      for (std::size_t i = 0; i < values.size(); ++i)
        largest[i] = std::max(largest[i], values[i]);
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, largest.data(), 3, MPI_DOUBLE, MPI_MAX, mesh.comm);
  return {.rotation = largest[0], .strain = largest[1], .neglected = largest[2]};
}

} // namespace amontons
