// Dead loads of small kinematics: traction and pressure on surface groups, body force in bodies, resultants of groups
// that move as one. All depend on time and reference place only.
#pragma once

#include "base/expression.hpp"
#include "form/form.hpp"
#include "math/space.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace amontons {

/// Force per reference area on a surface group: traction components plus -pressure times the outward normal.
struct SurfaceLoad {
  std::string group;
  std::array<std::optional<Expression>, 3> traction;
  std::optional<Expression> pressure;
};

/// Force per volume in a body.
struct BodyLoad {
  std::string body;
  std::array<std::optional<Expression>, 3> force;
};

/// ∫ b f of the body loads over each cell of a block of triangles or tetrahedra, with the cell bubble b of
/// math/bubble.hpp: mesh.dim numbers a cell; in axisymmetric space over the whole circumference.
std::vector<double> bubble_forces(const Mesh& mesh, Space space, const CellBlock& block,
                                  std::span<const BodyLoad> loads, double time);

/// Total force on tied group number `tied` of the layout, in its direction; in axisymmetric space over the whole
/// circumference.
struct ResultantLoad {
  std::size_t tied;
  Expression force;
};

/// The residual is minus the load; nothing couples. Surface and body loads are integrated once for each time.
class LoadForm : public Form {
 public:
  /// `layout` must outlive the form. Throws UserError for a group or body that the mesh lacks and for a third component
  /// in two dimensions; every rank throws alike.
  LoadForm(const DofLayout& layout, Space space, std::vector<SurfaceLoad> surface, std::vector<BodyLoad> body,
           std::vector<ResultantLoad> resultants);

  const char* name() const override { return "loads"; }
  void couple(Coupling&) const override {}
  void add_residual(const State& state, Residual& residual) override;
  void add_tangent(const State&, Tangent&) override {}
  bool tangent_is_constant() const override { return true; }

  /// Nodal forces of the surface and body loads that this rank integrates (num_local x dim; not summed over ranks).
  const std::vector<double>& nodal_forces(double time);

 private:
  void check_names() const;

  const DofLayout& layout_;
  Space space_;
  std::vector<SurfaceLoad> surface_;
  std::vector<BodyLoad> body_;
  std::vector<ResultantLoad> resultants_;
  std::vector<double> forces_;
  std::optional<double> time_; // of forces_
};

} // namespace amontons
