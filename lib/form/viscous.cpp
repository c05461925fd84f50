#include "form/viscous.hpp"

#include "form/support.hpp"
#include "math/reference_element.hpp"

#include <Eigen/LU>

namespace amontons {

namespace {

/// Volume of a cell (per unit thickness in the plane, of the full turn when axisymmetric).
double cell_volume(const Mesh& mesh, Space space, ElementType type, std::span<const std::int32_t> nodes) {
  const Tabulation& table = tabulation(type, 2 * element_order(type));
  double volume = 0.0;
  for (int q = 0; q < table.rule->size(); ++q) {
    Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
    jacobian.topLeftCorner(mesh.dim, mesh.dim).setZero();
    double x = 0.0;
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      const auto X = mesh.position(nodes[a]);
      x += table.value(q)[a] * X[0];
      for (int i = 0; i < mesh.dim; ++i)
        for (int j = 0; j < mesh.dim; ++j)
          jacobian(i, j) += table.gradient(q)[a * mesh.dim + j] * X[i];
    }
    volume += table.rule->weights[q] * jacobian.determinant() * circumference(space, x);
  }
  return volume;
}

} // namespace

ViscousForm::ViscousForm(const DofLayout& layout, Space space, const std::vector<double>& stiffness, double ratio,
                         double duration)
    : layout_(layout), ratio_(ratio), duration_(duration), weight_(layout.mesh().num_local(), 0.0) {
  const auto& mesh = layout.mesh();
  history_.displacement.assign(weight_.size() * mesh.dim, 0.0);
  const auto size = body_diagonals(mesh);
  for (const auto& block : mesh.blocks)
    for (std::int32_t c = 0; c < block.size(); ++c) {
      const auto nodes = block.cell(c);
      const double part = cell_volume(mesh, space, block.type, nodes) / static_cast<double>(nodes.size());
      for (const auto node : nodes)
        weight_[node] += stiffness[block.body] * part / (size[block.body] * size[block.body]);
    }
}

double ViscousForm::resistance(const State& state) const {
  const double dt = state.time - history_.time;
  return dt > 0.0 ? ratio_ * duration_ / dt : 0.0;
}

std::vector<double> ViscousForm::nodal_forces(const State& state) const {
  const double factor = resistance(state);
  std::vector<double> forces(state.displacement.size());
  const int d = layout_.dim();
  for (std::size_t i = 0; i < forces.size(); ++i)
    forces[i] = -factor * weight_[i / d] * (state.displacement[i] - history_.displacement[i]);
  return forces;
}

void ViscousForm::add_residual(const State& state, Residual& residual) {
  const auto forces = nodal_forces(state);
  for (std::size_t i = 0; i < forces.size(); ++i)
    residual.nodal()[i] -= forces[i];
}

void ViscousForm::couple(Coupling& coupling) const {
  for (std::size_t node = 0; node < weight_.size(); ++node)
    for (int c = 0; c < layout_.dim(); ++c) {
      const PetscInt equation = layout_.equation(static_cast<std::int32_t>(node), c);
      coupling.add({&equation, 1});
    }
}

void ViscousForm::add_tangent(const State& state, Tangent& tangent) {
  assembled_ = resistance(state);
  for (std::size_t node = 0; node < weight_.size(); ++node)
    for (int c = 0; c < layout_.dim(); ++c) {
      const PetscInt equation = layout_.equation(static_cast<std::int32_t>(node), c);
      const double value = assembled_ * weight_[node];
      tangent.add({&equation, 1}, {&value, 1});
    }
}

void ViscousForm::commit(const State& state) {
  history_ = {.time = state.time, .displacement = {state.displacement.begin(), state.displacement.end()}};
}

} // namespace amontons
