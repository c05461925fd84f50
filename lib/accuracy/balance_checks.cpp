// Balance of forces and moments, of the scene and of each body; the smallest volume ratio.
#include "accuracy/checks.hpp"
#include "accuracy/facet_cloud.hpp"
#include "math/reference_element.hpp"
#include "math/tensor.hpp"
#include "mesh/welded_bodies.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace amontons::accuracy {

namespace {

/// A body of each local node; of nodes that several have, any: they are welded.
std::vector<std::int32_t> bodies_of_nodes(const Mesh& mesh) {
  std::vector<std::int32_t> body(mesh.num_local(), -1);
  for (const CellBlock& block : mesh.blocks)
    for (const std::int32_t node : block.nodes)
      body[node] = block.body;
  return body;
}

/// Sizes of the force and of the moment in a wrench. Around the axis of revolution radial forces and moments cancel by
/// themselves: only the axial force is a condition.
std::array<double, 2> sizes(const std::array<double, 6>& wrench, Space space) {
  if (space == Space::Axisymmetric) return {std::abs(wrench[1]), 0.0};
  return {std::hypot(wrench[0], wrench[1], wrench[2]), std::hypot(wrench[3], wrench[4], wrench[5])};
}

/// Places and displacements of the nodes of a cell: looked up once for all of its points.
template <int dim>
struct CellMotion {
  static constexpr std::size_t most_nodes = 27; // hexahedra of order 2
  std::array<Point<dim>, most_nodes> X, u;

  void look_up(const CertificateInput& input, std::span<const std::int32_t> nodes) {
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      X[a] = Eigen::Map<const Point<dim>>(input.mesh.coordinates.data() + std::size_t(nodes[a]) * dim);
      u[a] = Eigen::Map<const Point<dim>>(input.displacement.data() + std::size_t(nodes[a]) * dim);
    }
  }
};

/// Volume after deformation over volume before, at a point of a cell: det(∂x/∂ξ) / det(∂X/∂ξ), with the hoop.
template <int dim>
double volume_ratio(const CellMotion<dim>& cell, Space space, std::span<const double> value,
                    std::span<const double> gradient) {
  using Matrix = Eigen::Matrix<double, dim, dim>;
  Matrix before = Matrix::Zero(), after;
  Matrix moved = Matrix::Zero();
  double radius = 0.0, widening = 0.0;
  for (std::size_t a = 0; a < value.size(); ++a) {
    const Eigen::Map<const Point<dim>> slope(gradient.data() + a * dim);
    before += cell.X[a] * slope.transpose();
    moved += cell.u[a] * slope.transpose();
    radius += value[a] * cell.X[a][0];
    widening += value[a] * cell.u[a][0];
  }
  after = before + moved;
  const double ratio = after.determinant() / before.determinant();
  return space == Space::Axisymmetric ? ratio * (1.0 + widening / radius) : ratio;
}

template <int dim>
Worst worst_volume(const CertificateInput& input) {
  const Mesh& mesh = input.mesh;
  Worst worst{-std::numeric_limits<double>::infinity(), ""};
  CellMotion<dim> cell;
  for (const CellBlock& block : mesh.blocks) {
    const Tabulation& table = tabulation(block.type, 2 * element_order(block.type));
    for (std::int32_t c = 0; c < block.size(); ++c) {
      const auto nodes = block.cell(c);
      cell.look_up(input, nodes);
      for (int q = 0; q < table.rule->size(); ++q)
        worst.offer(-volume_ratio(cell, input.space, table.value(q), table.gradient(q)), [&] {
          return "body '" + mesh.bodies[block.body] + "', cell with a corner at " + place_text(mesh.position(nodes[0]));
        });
    }
  }
  return worst;
}

} // namespace

void add_wrench(std::array<double, 6>& sum, const std::array<double, 3>& x, const std::array<double, 3>& pivot,
                const std::array<double, 3>& f) {
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t i = (c + 1) % 3, j = (c + 2) % 3;
    sum[c] += f[c];
    sum[3 + c] += (x[i] - pivot[i]) * f[j] - (x[j] - pivot[j]) * f[i];
  }
}

BalanceChecks check_balance(const CertificateInput& input, const std::array<double, 3>& pivot, double size,
                            const ClaimedForces& forces) {
  const Mesh& mesh = input.mesh;
  const std::vector<std::int32_t> body_of_node = bodies_of_nodes(mesh), first = welded_bodies(mesh);
  // Rows: the whole scene, then sets of bodies under their first body's number; behind them the force scale.
  const std::size_t rows = mesh.bodies.size() + 1;
  std::vector<std::array<double, 6>> sums(rows + 1, std::array<double, 6>{});
  double& absolute = sums.back()[0];
  absolute = forces.absolute;
  for (std::int32_t node = 0; node < mesh.num_local(); ++node) {
    std::array<double, 3> x{}, f{};
    std::copy_n(mesh.position(node).begin(), mesh.dim, x.begin());
    for (int c = 0; c < mesh.dim && input.kinematics == Kinematics::Finite; ++c)
      x[c] += input.displacement[std::size_t(node) * mesh.dim + c];
    std::copy_n(input.external_forces.begin() + std::ptrdiff_t(node) * mesh.dim, mesh.dim, f.begin());
    if (f == std::array<double, 3>{}) continue;
    absolute += std::hypot(f[0], f[1], f[2]);
    add_wrench(sums[0], x, pivot, f);
    add_wrench(sums[1 + first[body_of_node[node]]], x, pivot, f);
  }
  for (std::size_t c = 0; c < 6; ++c) {
    sums[0][c] += forces.by_rigid[c];
    if (c >= 3) sums[0][c] -= forces.couple[c];
    for (std::size_t body = 0; body + 1 < rows; ++body)
      sums[1 + first[body]][c] += forces.on_body[body][c];
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(6 * sums.size()), MPI_DOUBLE, MPI_SUM, mesh.comm);

  const double scale = std::max(absolute, input.force_floor);
  BalanceChecks result;
  const auto scene = sizes(sums[0], input.space);
  if (scene[0] != 0.0) result.force.offer(scene[0] / scale, [] { return std::string("the whole scene"); });
  if (scene[1] != 0.0) result.moment.offer(scene[1] / (scale * size), [] { return std::string("the whole scene"); });
  for (std::size_t body = 0; body + 1 < rows; ++body) {
    const auto part = sizes(sums[1 + body], input.space);
    const double value = std::max(part[0], part[1] / size);
    if (value != 0.0) result.body.offer(value / scale, [&] { return "body '" + mesh.bodies[body] + "'"; });
  }
  return result;
}

Worst check_volume(const CertificateInput& input) {
  return over_ranks(input.mesh.comm, input.mesh.dim == 2 ? worst_volume<2>(input) : worst_volume<3>(input));
}

} // namespace amontons::accuracy
