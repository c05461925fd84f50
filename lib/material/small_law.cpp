#include "material/small_law.hpp"

#include <algorithm>

namespace amontons {
namespace {

template <class Law>
constexpr std::size_t num_state = 0;
template <>
constexpr std::size_t num_state<SmallPlastic> = SmallPlastic::state_names.size();

SmallResponse evaluate(const Elastic& law, const PointContext&, const Strain<3>& strain, std::span<const double>,
                       std::span<double>) {
  const Lame lame = lame_constants(law, Space::Solid);
  return {.stress = elastic_stress<3>(lame, Space::Solid, strain),
          .stored = elastic_energy<3>(lame, Space::Solid, strain)};
}
SmallResponse evaluate(const SmallPlastic& law, const PointContext& context, const Strain<3>& strain,
                       std::span<const double> state_old, std::span<double> state_new) {
  return law.respond(context, strain, state_old, state_new);
}

PointOutcome linearize(const Elastic& law, const PointContext&, const Strain<3>&, std::span<const double>,
                       Moduli<3>& moduli) {
  moduli = elastic_moduli<3>(lame_constants(law, Space::Solid), Space::Solid);
  return PointOutcome::Solved;
}
PointOutcome linearize(const SmallPlastic& law, const PointContext& context, const Strain<3>& strain,
                       std::span<const double> state_old, Moduli<3>& moduli) {
  return law.tangent(context, strain, state_old, moduli);
}

/// `evaluate` with every failure as a value.
template <class Law>
SmallResponse respond_safely(const Law& law, const PointContext& context, const Strain<3>& strain,
                             std::span<const double> state_old, std::span<double> state_new) {
  SmallResponse response{.outcome = PointOutcome::NotFinite};
  if (strain.allFinite()) response = evaluate(law, context, strain, state_old, state_new);
  if (response.outcome == PointOutcome::Solved && response.stress.allFinite() && std::isfinite(response.stored))
    return response;
  std::copy(state_old.begin(), state_old.end(), state_new.begin());
  return {.outcome = response.outcome == PointOutcome::Solved ? PointOutcome::NotFinite : response.outcome};
}

template <class Law>
PointOutcome tangent_safely(const Law& law, const PointContext& context, const Strain<3>& strain,
                            std::span<const double> state_old, Moduli<3>& moduli) {
  PointOutcome outcome = PointOutcome::NotFinite;
  if (strain.allFinite()) outcome = linearize(law, context, strain, state_old, moduli);
  if (outcome == PointOutcome::Solved && !moduli.allFinite()) outcome = PointOutcome::NotFinite;
  if (outcome != PointOutcome::Solved) moduli.setZero();
  return outcome;
}

template <int dim>
Strain<3> embedded(std::span<const double> strain, std::size_t point) {
  Strain<3> full = Strain<3>::Zero();
  full.template head<strain_size<dim>>() = Eigen::Map<const Strain<dim>>(&strain[point * strain_size<dim>]);
  return full;
}

} // namespace

std::string_view outcome_text(PointOutcome outcome) {
  switch (outcome) {
  case PointOutcome::Solved:
    return "it was solved";
  case PointOutcome::Inverted:
    return "det F is not positive";
  case PointOutcome::NotFinite:
    return "the strain or its stress is not a finite number";
  case PointOutcome::NotConverged:
    return "the local iteration of the flow rule did not converge";
  }
  return "";
}

std::span<const std::string_view> state_names(const SmallLaw& law) {
  if (std::holds_alternative<SmallPlastic>(law)) return SmallPlastic::state_names;
  return {};
}

void initial_state(const SmallLaw&, std::span<double> state) { std::fill(state.begin(), state.end(), 0.0); }

Lame initial_lame(const SmallLaw& law) {
  const auto* plastic = std::get_if<SmallPlastic>(&law);
  return lame_constants(plastic ? plastic->material.elastic : std::get<Elastic>(law), Space::Solid);
}

SmallResponse respond(const SmallLaw& law, const PointContext& context, const Strain<3>& strain,
                      std::span<const double> state_old, std::span<double> state_new) {
  return std::visit([&](const auto& one) { return respond_safely(one, context, strain, state_old, state_new); }, law);
}

PointOutcome tangent(const SmallLaw& law, const PointContext& context, const Strain<3>& strain,
                     std::span<const double> state_old, Moduli<3>& moduli) {
  return std::visit([&](const auto& one) { return tangent_safely(one, context, strain, state_old, moduli); }, law);
}

template <int dim>
std::optional<PointFailure> respond(const SmallLaw& law, const PointContext& context, const SmallPoints& points,
                                    const SmallResults& results) {
  return std::visit(
      [&]<class Law>(const Law& one) -> std::optional<PointFailure> {
        constexpr std::size_t size = strain_size<dim>, states = num_state<Law>;
        for (std::size_t i = 0; i < results.stored.size(); ++i) {
          const auto response = respond_safely(one, context, embedded<dim>(points.strain, i),
                                               points.state_old.subspan(i * states, states),
                                               results.state_new.subspan(i * states, states));
          if (response.outcome != PointOutcome::Solved) return PointFailure{i, response.outcome};
          Eigen::Map<Stress<dim>>{&results.stress[i * size]} = response.stress.template head<strain_size<dim>>();
          results.stored[i] = response.stored;
          results.dissipated[i] = response.dissipated;
        }
        return std::nullopt;
      },
      law);
}

template <int dim>
std::optional<PointFailure> tangents(const SmallLaw& law, const PointContext& context, const SmallPoints& points,
                                     std::span<double> moduli) {
  return std::visit(
      [&]<class Law>(const Law& one) -> std::optional<PointFailure> {
        constexpr int size = strain_size<dim>;
        constexpr std::size_t states = num_state<Law>, entries = size * size;
        Moduli<3> full;
        for (std::size_t i = 0; i < moduli.size() / entries; ++i) {
          const auto outcome = tangent_safely(one, context, embedded<dim>(points.strain, i),
                                              points.state_old.subspan(i * states, states), full);
          if (outcome != PointOutcome::Solved) return PointFailure{i, outcome};
          Eigen::Map<Moduli<dim>>{&moduli[i * entries]} = full.template topLeftCorner<size, size>();
        }
        return std::nullopt;
      },
      law);
}

template std::optional<PointFailure> respond<2>(const SmallLaw&, const PointContext&, const SmallPoints&,
                                                const SmallResults&);
template std::optional<PointFailure> respond<3>(const SmallLaw&, const PointContext&, const SmallPoints&,
                                                const SmallResults&);
template std::optional<PointFailure> tangents<2>(const SmallLaw&, const PointContext&, const SmallPoints&,
                                                 std::span<double>);
template std::optional<PointFailure> tangents<3>(const SmallLaw&, const PointContext&, const SmallPoints&,
                                                 std::span<double>);

} // namespace amontons
