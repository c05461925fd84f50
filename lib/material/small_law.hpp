// All laws for small strain as one type, and what callers ask of any of them. The list below is the registry. The
// variant is visited once a batch of points.
#pragma once

#include "material/elastic.hpp"
#include "material/small_plastic.hpp"

#include <optional>
#include <variant>

namespace amontons {

using SmallLaw = std::variant<Elastic, SmallPlastic>;

/// The first point of a batch that could not be evaluated.
struct PointFailure {
  std::size_t point;
  PointOutcome outcome;
};

/// "det F is not positive" and so on: the reason as the end of a sentence, for messages.
std::string_view outcome_text(PointOutcome outcome);

/// Names of the state variables at a point, in their order; empty for a law without memory.
std::span<const std::string_view> state_names(const SmallLaw& law);
/// The state of the virgin material; `state` has as many entries as there are names.
void initial_state(const SmallLaw& law, std::span<double> state);
/// Isotropic moduli at zero strain, for scales and preconditioners.
Lame initial_lame(const SmallLaw& law);

/// Stress, energies and new state at the end of the increment. The states have as many entries as there are names and
/// must not overlap.
SmallResponse respond(const SmallLaw& law, const PointContext& context, const Strain<3>& strain,
                      std::span<const double> state_old, std::span<double> state_new);
/// dσ/dε at the end of the increment, consistent with `respond`; zero when not Solved.
PointOutcome tangent(const SmallLaw& law, const PointContext& context, const Strain<3>& strain,
                     std::span<const double> state_old, Moduli<3>& moduli);

/// Arrays run point by point: strain_size<dim> components, states, one number. In two dimensions (plane strain,
/// axisymmetry) the components that are not stored are zero.
struct SmallPoints {
  std::span<const double> strain, state_old;
};
struct SmallResults {
  std::span<double> stress, stored, dissipated, state_new;
};
/// Evaluates all points, or stops at the first that fails; results are then of no use.
template <int dim>
std::optional<PointFailure> respond(const SmallLaw& law, const PointContext& context, const SmallPoints& points,
                                    const SmallResults& results);
/// `moduli`: strain_size<dim> squared numbers a point, symmetric.
template <int dim>
std::optional<PointFailure> tangents(const SmallLaw& law, const PointContext& context, const SmallPoints& points,
                                     std::span<double> moduli);

} // namespace amontons
