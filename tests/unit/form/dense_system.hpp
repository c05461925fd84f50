// Small systems put together densely on each rank, so that forms can be tested without a Problem or a solver.
#pragma once

#include "box_mesh.hpp"
#include "form/form.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <map>
#include <random>

namespace amontons::testing {

class DenseTangent : public Tangent {
 public:
  explicit DenseTangent(PetscInt size) : matrix(Eigen::MatrixXd::Zero(size, size)) {}
  void add(std::span<const PetscInt> equations, std::span<const double> block) override {
    for (std::size_t i = 0; i < equations.size(); ++i)
      for (std::size_t j = 0; j < equations.size(); ++j)
        matrix(equations[i], equations[j]) += block[i * equations.size() + j];
  }
  Eigen::MatrixXd matrix;
};

inline State state_of(const Eigen::VectorXd& u, double time = 0.0) {
  return {time, nullptr, {u.data(), std::size_t(u.size())}};
}

/// Residual at nodal displacements `u` (num_local x dim), owned entries of the global vector. Collective.
inline Eigen::VectorXd residual_of(const DofLayout& layout, Form& form, const Eigen::VectorXd& u, double time = 0.0) {
  const VecHandle global = layout.new_vector();
  Residual residual(layout, global);
  form.add_residual(state_of(u, time), residual);
  residual.finish();
  const VecReader values(global);
  return Eigen::Map<const Eigen::VectorXd>(values.data(), values.size());
}

inline Eigen::MatrixXd tangent_of(const DofLayout& layout, Form& form, const Eigen::VectorXd& u) {
  DenseTangent tangent(layout.num_global());
  form.add_tangent(state_of(u), tangent);
  return tangent.matrix;
}

/// A displacement field: components at a place.
using Field = std::function<std::array<double, 3>(std::span<const double>)>;

inline Eigen::VectorXd nodal_values(const Mesh& mesh, const Field& field) {
  Eigen::VectorXd u(std::size_t(mesh.num_local()) * mesh.dim);
  for (std::int32_t node = 0; node < mesh.num_local(); ++node) {
    const auto value = field(mesh.position(node));
    for (int i = 0; i < mesh.dim; ++i)
      u[node * mesh.dim + i] = value[i];
  }
  return u;
}

inline Eigen::VectorXd random_vector(Eigen::Index size, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::VectorXd result(size);
  for (auto& value : result)
    value = uniform(engine);
  return result;
}

/// Solves the linear problem of `solid` and `loads` on a mesh of one rank: the residual of both vanishes but for the
/// unknowns in `prescribed` (number to value).
inline Eigen::VectorXd solve_linear(const DofLayout& layout, Form& solid, Form& loads,
                                    const std::map<Eigen::Index, double>& prescribed) {
  Eigen::VectorXd u = Eigen::VectorXd::Zero(layout.num_global());
  const Eigen::MatrixXd K = tangent_of(layout, solid, u);
  for (const auto& [unknown, value] : prescribed)
    u[unknown] = value;
  const Eigen::VectorXd residual = residual_of(layout, solid, u) + residual_of(layout, loads, u);
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < u.size(); ++i)
    if (!prescribed.contains(i)) free.push_back(i);
  const Eigen::MatrixXd reduced = K(free, free);
  const Eigen::VectorXd change = reduced.llt().solve(residual(free));
  for (std::size_t i = 0; i < free.size(); ++i)
    u[free[i]] -= change[i];
  return u;
}

/// sqrt(∫ |u_h - u|²) over the cells, with a rule well above the element's order.
inline double displacement_error(const Mesh& mesh, const Eigen::VectorXd& u, const Field& exact) {
  double sum = 0;
  for (const auto& block : mesh.blocks) {
    const Tabulation& table = tabulation(block.type, 6);
    for (std::int32_t c = 0; c < block.size(); ++c)
      for (int q = 0; q < table.rule->size(); ++q) {
        Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(mesh.dim, mesh.dim);
        Eigen::VectorXd x = Eigen::VectorXd::Zero(mesh.dim), value = x;
        const auto nodes = block.cell(c);
        for (std::size_t a = 0; a < nodes.size(); ++a)
          for (int i = 0; i < mesh.dim; ++i) {
            x[i] += table.value(q)[a] * mesh.position(nodes[a])[i];
            value[i] += table.value(q)[a] * u[nodes[a] * mesh.dim + i];
            for (int j = 0; j < mesh.dim; ++j)
              jacobian(i, j) += table.gradient(q)[a * mesh.dim + j] * mesh.position(nodes[a])[i];
          }
        const auto wanted = exact({x.data(), std::size_t(x.size())});
        for (int i = 0; i < mesh.dim; ++i)
          value[i] -= wanted[i];
        sum += table.rule->weights[q] * jacobian.determinant() * value.squaredNorm();
      }
  }
  return std::sqrt(sum);
}

} // namespace amontons::testing
