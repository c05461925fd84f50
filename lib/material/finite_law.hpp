// All laws for finite strain as one type, and what callers ask of any of them. The list below is the registry. The
// variant is visited once a batch of points.
#pragma once

#include "material/finite_plastic.hpp"
#include "material/hencky.hpp"
#include "material/mooney_rivlin.hpp"
#include "material/neo_hookean.hpp"
#include "material/small_law.hpp"
#include "material/st_venant_kirchhoff.hpp"

#include <optional>
#include <variant>

namespace amontons {

/// A law is hyperelastic (energy, piola and tangent as functions of F) or has a history (respond, tangent, names and
/// initial_state as FinitePlastic); either kind is found by its members. All may assume det F > 0.
using FiniteLaw = std::variant<StVenantKirchhoff, NeoHookean, MooneyRivlin, Hencky, FinitePlastic>;

/// Names of the state variables at a point, in their order; empty for a law without memory.
std::span<const std::string_view> state_names(const FiniteLaw& law);
/// The state of the virgin material; `state` has as many entries as there are names. Not zero for plasticity.
void initial_state(const FiniteLaw& law, std::span<double> state);
/// Isotropic moduli at zero strain, for scales and preconditioners.
Lame initial_lame(const FiniteLaw& law);
/// Is dP/dF always symmetric? Not with kinematic hardening.
bool has_symmetric_tangent(const FiniteLaw& law);

/// Stress, energies and new state at the end of the increment. The states have as many entries as there are names and
/// must not overlap.
FiniteResponse respond(const FiniteLaw& law, const PointContext& context, const Tensor& F,
                       std::span<const double> state_old, std::span<double> state_new);
/// dP/dF at the end of the increment, consistent with `respond`; zero when not Solved.
PointOutcome tangent(const FiniteLaw& law, const PointContext& context, const Tensor& F,
                     std::span<const double> state_old, PiolaTangent& tangent);

/// Arrays run point by point: F and P with nine components (iJ at 3 i + J), states, one number. Plane strain has
/// F_33 = 1, axisymmetry (x radial, y axial, z hoop) F_33 = r / R.
struct FinitePoints {
  std::span<const double> F, state_old;
};
struct FiniteResults {
  std::span<double> piola, stored, dissipated, state_new;
};
/// Evaluates all points, or stops at the first that fails; results are then of no use.
std::optional<PointFailure> respond(const FiniteLaw& law, const PointContext& context, const FinitePoints& points,
                                    const FiniteResults& results);
/// `tangents`: 81 numbers a point, row by row (PiolaTangent).
std::optional<PointFailure> tangents(const FiniteLaw& law, const PointContext& context, const FinitePoints& points,
                                     std::span<double> tangents);

} // namespace amontons
