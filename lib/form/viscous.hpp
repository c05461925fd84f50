// Artificial viscosity that holds bodies back while they move: to get past a limit point where a quasi-static path has
// no neighbour (snap-through, buckling), and, with a resistance that vanishes, as a support on the way to a solution.
#pragma once

#include "form/form.hpp"
#include "math/space.hpp"

#include <vector>

namespace amontons {

/// Nodal forces −c (u − u_old) / Δt over an increment, u_old and Δt from the last accepted state, with
///   c = ratio · (E / L²) · duration · V
/// V the part of the body's volume that the node stands for (equal parts for the nodes of a cell), L the diagonal of
/// the body's box, E its stiffness. So a body that moves steadily by d over `duration` meets the force
/// ratio · E V d / L², to be compared with E V d / L², the order of its elastic forces when stretched by d: `ratio` is
/// dimensionless.
class ViscousForm : public Form {
 public:
  /// `stiffness`: Young's modulus by body, stress; `duration`: time over which the ratio is meant. Collective.
  ViscousForm(const DofLayout& layout, Space space, const std::vector<double>& stiffness, double ratio,
              double duration);

  const char* name() const override { return "stabilization"; }
  void couple(Coupling& coupling) const override;
  void add_residual(const State& state, Residual& residual) override;
  void add_tangent(const State& state, Tangent& tangent) override;
  bool tangent_changed(const State& state) override { return resistance(state) != assembled_; }
  void commit(const State& state) override;
  std::any history() const override { return history_; }
  void restore(const std::any& history) override { history_ = std::any_cast<const History&>(history); }
  /// Takes up the accepted state of a checkpoint.
  void resume(const State& state) { commit(state); }

  void set_ratio(double ratio) { ratio_ = ratio; }
  /// Viscous forces on the bodies at this rank's nodes (num_local x dim, this rank's parts). The opposite of what
  /// add_residual adds.
  std::vector<double> nodal_forces(const State& state) const;

 private:
  /// The last accepted state.
  struct History {
    double time = 0.0;
    std::vector<double> displacement;
  };
  /// ratio · duration / Δt; zero before the time has moved on.
  double resistance(const State& state) const;

  const DofLayout& layout_;
  double ratio_, duration_, assembled_ = 0.0;
  std::vector<double> weight_; // E V / L² by local node, this rank's part
  History history_;
};

} // namespace amontons
