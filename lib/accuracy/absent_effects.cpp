#include "accuracy/absent_effects.hpp"

#include "accuracy/gap_search.hpp"
#include "math/reference_element.hpp"
#include "math/tensor.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace amontons {

namespace {

using Vector = std::array<double, 3>;

/// Volume of a cell by its middle, and a nodal field there.
struct Middle {
  double volume = 0.0;
  Vector value{};
};

Middle middle_of(const Mesh& mesh, Space space, std::span<const double> field, std::span<const std::int32_t> nodes,
                 const Tabulation& table) {
  const int dim = mesh.dim;
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
  jacobian.topLeftCorner(dim, dim).setZero();
  Middle middle;
  double radius = 0.0;
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    const auto X = mesh.position(nodes[a]);
    for (int i = 0; i < dim; ++i) {
      middle.value[i] += table.value(0)[a] * field[std::size_t(nodes[a]) * dim + i];
      for (int j = 0; j < dim; ++j)
        jacobian(i, j) += X[i] * table.gradient(0)[a * dim + j];
    }
    radius += table.value(0)[a] * X[0];
  }
  middle.volume = std::abs(jacobian.determinant()) * table.rule->weights[0];
  if (space == Space::Axisymmetric) middle.volume *= 2.0 * std::numbers::pi * radius;
  return middle;
}

} // namespace

YieldAudit audit_yield(SolidForm& solid, const Mesh& mesh, const State& state, std::span<const double> stresses) {
  struct {
    double ratio = 0.0;
    int body = -1;
  } worst;
  solid.for_each_batch(state, [&](const PointBatch& batch) {
    const double yield = stresses[batch.block->body];
    if (yield <= 0.0) return;
    const std::size_t components = batch.stress.size() / batch.weights.size();
    for (std::size_t at = 0; at < batch.stress.size(); at += components)
      if (const double ratio = von_mises(batch.stress.subspan(at, components)) / yield; ratio > worst.ratio)
        worst = {ratio, batch.block->body};
  });
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE_INT, MPI_MAXLOC, mesh.comm);
  return {.ratio = worst.ratio, .body = worst.body};
}

std::vector<double> body_volumes(SolidForm& solid, const Mesh& mesh, const State& state) {
  std::vector<double> volumes(mesh.bodies.size(), 0.0);
  solid.for_each_batch(state, [&](const PointBatch& batch) {
    for (const double weight : batch.weights)
      volumes[batch.block->body] += weight;
  });
  MPI_Allreduce(MPI_IN_PLACE, volumes.data(), static_cast<int>(volumes.size()), MPI_DOUBLE, MPI_SUM, mesh.comm);
  return volumes;
}

double sliding_work(const Mesh& mesh, std::span<const double> displacement, const ContactPairNames& pair,
                    const ContactSamples& samples) {
  const FacetSet& slave = mesh.surfaces.at(pair.slave);
  std::vector<accuracy::SlavePoint> points;
  for (std::size_t i = 0; i < samples.size(); ++i)
    points.push_back(accuracy::slave_point(mesh, displacement, slave, samples.facet[i], samples.xi[i]));
  std::vector<Vector> motion(points.size());
  if (const auto* rigid = std::get_if<MovedShape>(&pair.master)) {
    for (std::size_t i = 0; i < points.size(); ++i)
      for (int c = 0; c < mesh.dim; ++c)
        motion[i][c] = points[i].displacement[c] - rigid->shift[c];
  } else {
    const FacetSet& master = mesh.surfaces.at(std::get<std::string>(pair.master));
    const double reach = accuracy::reach_of(mesh, displacement, master, points);
    const auto hits = accuracy::find_on_master(mesh, displacement, master, points, reach);
    for (std::size_t i = 0; i < points.size(); ++i)
      motion[i] = hits[i].jump;
  }
  double work = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Map<const Eigen::Vector3d> u(motion[i].data()), n(samples.normal[i].data());
    work += samples.weight[i] * std::max(0.0, samples.pressure[i]) * (u - u.dot(n) * n).norm();
  }
  MPI_Allreduce(MPI_IN_PLACE, &work, 1, MPI_DOUBLE, MPI_SUM, mesh.comm);
  return work;
}

MotionAudit audit_motion(const Mesh& mesh, Space space, std::span<const double> increment, double dt,
                         std::span<const double> density, std::span<const double> wave_speed) {
  // Per body: volume and ∫ Δu; at the end ∫ ½ ρ |Δu|².
  std::vector<double> sums(4 * mesh.bodies.size() + 1, 0.0);
  for (const auto& block : mesh.blocks) {
    const Tabulation& centre = tabulation(block.type, 1);
    for (std::int32_t c = 0; c < block.size(); ++c) {
      const auto [volume, moved] = middle_of(mesh, space, increment, block.cell(c), centre);
      double* sum = &sums[4 * std::size_t(block.body)];
      sum[0] += volume;
      for (int i = 0; i < 3; ++i) {
        sum[i + 1] += volume * moved[i];
        sums.back() += 0.5 * density[block.body] * volume * moved[i] * moved[i];
      }
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, mesh.comm);
  MotionAudit audit{.kinetic = sums.back() / (dt * dt)};
  for (std::size_t body = 0; body < mesh.bodies.size(); ++body) {
    if (density[body] <= 0.0) continue;
    const double* sum = &sums[4 * body];
    const double speed = std::hypot(sum[1], sum[2], sum[3]) / sum[0] / dt;
    audit.largest_speed = std::max(audit.largest_speed, speed / wave_speed[body]);
  }
  return audit;
}

} // namespace amontons
