// Bodies that no prescribed displacement holds (free bodies, held by contact alone): finding them, and a tiny stiffness
// in their tangent so that it can be factorized before contact holds them. The residual is untouched: the converged
// solution carries no artificial force.
#pragma once

#include "form/problem.hpp"

#include <cstdint>
#include <vector>

namespace amontons {

/// Per body of the mesh: can it move as a rigid body past the prescribed displacements? In axisymmetric space the only
/// rigid motion is along the axis. The same on every rank. Collective.
std::vector<std::uint8_t> find_floating_bodies(const Mesh& mesh, const std::vector<PrescribedDisplacement>& prescribed,
                                               bool axisymmetric);

/// Diagonal of the box around each body of the mesh, the same on every rank. Collective.
std::vector<double> body_diagonals(const Mesh& mesh);

/// Adds `support_ratio` × stiffness × size^(dim − 2) per body, shared equally by its nodes, to the diagonal of floating
/// bodies.
class SupportForm : public Form {
 public:
  static constexpr double support_ratio = 1e-8;
  /// `stiffness`: Young's modulus per body. Collective.
  SupportForm(const DofLayout& layout, const std::vector<std::uint8_t>& floating, const std::vector<double>& stiffness);

  const char* name() const override { return "support"; }
  void couple(Coupling&) const override {}
  void add_residual(const State&, Residual&) override {}
  void add_tangent(const State& state, Tangent& tangent) override;
  bool tangent_is_constant() const override { return true; }

 private:
  const DofLayout& layout_;
  std::vector<double> node_stiffness_; // per owned node
};

} // namespace amontons
