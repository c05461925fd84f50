// Pressure on surfaces of bodies at finite strain: it acts along the normal and on the area of the deformed surface.
#pragma once

#include "base/expression.hpp"
#include "form/form.hpp"
#include "math/space.hpp"

#include <string>
#include <vector>

namespace amontons {

/// Pressure (force per deformed area) on a surface group, positive into the body; x, y, z of the expression are the
/// reference place.
struct FollowerPressure {
  std::string group;
  Expression pressure;
};

/// Residual ∫ N_a p n da with n da = ∂x/∂ξ × ∂x/∂η dξ dη of the deformed facet, and its derivative; per thickness 1 in
/// plane strain, over the whole deformed circumference in axisymmetric space. The derivative is symmetric only up to
/// terms at the border of the surface (J. Bonet, R. D. Wood, Nonlinear Continuum Mechanics for Finite Element Analysis,
/// 2nd ed. 2008, section 9.5.2) and is left as it is.
class FollowerPressureForm : public Form {
 public:
  /// `layout` must outlive the form. Throws UserError for a group that the mesh lacks; every rank throws alike.
  FollowerPressureForm(const DofLayout& layout, Space space, std::vector<FollowerPressure> pressures);

  const char* name() const override { return "loads"; }
  /// The nodes of a facet are those of its cell, which couples them.
  void couple(Coupling&) const override {}
  void add_residual(const State& state, Residual& residual) override;
  void add_tangent(const State& state, Tangent& tangent) override;
  bool tangent_is_symmetric() const override { return false; }

  /// Forces on the nodes of the facets of this rank (num_local x dim; not summed over ranks).
  std::vector<double> nodal_forces(const State& state) const;

 private:
  /// Calls work(facet's nodes, its table, point, pressure times the point's weight) for each point of each facet.
  template <class Work>
  void each_point(double time, Work&& work) const;

  const DofLayout& layout_;
  Space space_;
  std::vector<FollowerPressure> pressures_;
};

} // namespace amontons
