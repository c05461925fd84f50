#include "form/follower_pressure.hpp"

#include "base/error.hpp"
#include "math/reference_element.hpp"

#include <Eigen/Geometry>

namespace amontons {
namespace {

using Vector3 = Eigen::Vector3d;

/// N_a n da, with r in axisymmetric space, is a polynomial of degree 5 in each variable at most for order 2, 3 for
/// order 1: a uniform pressure is integrated exactly.
int pressure_degree(ElementType type) { return 3 * element_order(type) + 1; }

/// A point of a deformed facet: place and directions of the coordinate lines, padded with zeros.
struct Deformed {
  Vector3 x = Vector3::Zero(), first = Vector3::Zero(), second = Vector3::Zero();

  Deformed(const Mesh& mesh, std::span<const double> displacement, std::span<const std::int32_t> nodes,
           const Tabulation& table, int q) {
    const int dim = mesh.dim;
    const auto values = table.value(q), slopes = table.gradient(q);
    for (std::size_t a = 0; a < nodes.size(); ++a)
      for (int i = 0; i < dim; ++i) {
        const double place = mesh.position(nodes[a])[i] + displacement[std::size_t(nodes[a]) * dim + i];
        x[i] += values[a] * place;
        first[i] += slopes[a * (dim - 1)] * place;
        if (dim == 3) second[i] += slopes[a * 2 + 1] * place;
      }
    if (dim == 2) second = Vector3::UnitZ(); // so that the normal is (t_y, -t_x), outward (see FacetSet)
  }
  /// n da over dξ dη.
  Vector3 normal() const { return first.cross(second); }
};

/// ∂(n da)_i / ∂u_bj for the node with slopes dN/dξ, dN/dη: of t × s it is ε_ijk (dN/dξ s_k − dN/dη t_k).
Eigen::Matrix3d normal_derivative(const Deformed& point, double along_first, double along_second) {
  const Vector3 v = along_first * point.second - along_second * point.first;
  Eigen::Matrix3d derivative;
  derivative << 0, v[2], -v[1], -v[2], 0, v[0], v[1], -v[0], 0;
  return derivative;
}

} // namespace

FollowerPressureForm::FollowerPressureForm(const DofLayout& layout, Space space,
                                           std::vector<FollowerPressure> pressures)
    : layout_(layout), space_(space), pressures_(std::move(pressures)) {
  std::vector<std::string> known, errors;
  for (const auto& [name, facets] : layout.mesh().surfaces)
    known.push_back(name);
  for (const auto& load : pressures_)
    if (!layout.mesh().surfaces.contains(load.group))
      errors.push_back("the mesh has no surface group '" + load.group + "' for a pressure. It has " +
                       (known.empty() ? "none" : join_names(known)) + ".");
  if (!errors.empty()) throw UserError(errors);
}

template <class Work>
void FollowerPressureForm::each_point(double time, Work&& work) const {
  const Mesh& mesh = layout_.mesh();
  for (const auto& load : pressures_) {
    const FacetSet& facets = mesh.surfaces.at(load.group);
    for (std::int32_t f = 0; f < facets.size(); ++f) {
      const auto nodes = facets.facet(f);
      const Tabulation& table = tabulation(facets.types[f], pressure_degree(facets.types[f]));
      for (int q = 0; q < table.rule->size(); ++q) {
        std::array<double, 3> X{};
        for (std::size_t a = 0; a < nodes.size(); ++a)
          for (int i = 0; i < mesh.dim; ++i)
            X[i] += table.value(q)[a] * mesh.position(nodes[a])[i];
        work(nodes, table, q, load.pressure(time, std::span(X).first(mesh.dim)) * table.rule->weights[q]);
      }
    }
  }
}

std::vector<double> FollowerPressureForm::nodal_forces(const State& state) const {
  const Mesh& mesh = layout_.mesh();
  std::vector<double> forces(state.displacement.size(), 0.0);
  each_point(state.time, [&](auto nodes, const Tabulation& table, int q, double pressure) {
    const Deformed point(mesh, state.displacement, nodes, table, q);
    const Vector3 force = -pressure * circumference(space_, point.x[0]) * point.normal();
    for (std::size_t a = 0; a < nodes.size(); ++a)
      for (int i = 0; i < mesh.dim; ++i)
        forces[std::size_t(nodes[a]) * mesh.dim + i] += table.value(q)[a] * force[i];
  });
  return forces;
}

void FollowerPressureForm::add_residual(const State& state, Residual& residual) {
  const auto forces = nodal_forces(state);
  for (std::size_t i = 0; i < forces.size(); ++i)
    residual.nodal()[i] -= forces[i];
}

void FollowerPressureForm::add_tangent(const State& state, Tangent& tangent) {
  const Mesh& mesh = layout_.mesh();
  const int dim = mesh.dim;
  const double turn = circumference(space_, 1.0); // 2 π when axisymmetric
  std::vector<PetscInt> equations;
  std::vector<double> block;
  each_point(state.time, [&](auto nodes, const Tabulation& table, int q, double pressure) {
    const Deformed point(mesh, state.displacement, nodes, table, q);
    const auto values = table.value(q), slopes = table.gradient(q);
    const std::size_t size = nodes.size() * dim;
    equations.clear();
    for (const auto node : nodes)
      for (int i = 0; i < dim; ++i)
        equations.push_back(layout_.equation(node, i));
    block.assign(size * size, 0.0);
    for (std::size_t b = 0; b < nodes.size(); ++b) {
      Eigen::Matrix3d derivative = circumference(space_, point.x[0]) *
                                   normal_derivative(point, slopes[b * (dim - 1)], dim == 3 ? slopes[b * 2 + 1] : 0.0);
      if (space_ == Space::Axisymmetric) derivative.col(0) += turn * values[b] * point.normal();
      for (std::size_t a = 0; a < nodes.size(); ++a)
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j)
            block[(a * dim + i) * size + b * dim + j] = pressure * values[a] * derivative(i, j);
    }
    tangent.add(equations, block);
  });
}

} // namespace amontons
