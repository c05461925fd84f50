#include "material/finite_law.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace amontons {
namespace {

template <class Law>
concept Hyperelastic = requires(const Law& law, const Tensor& F) {
  law.energy(F);
  law.piola(F);
  law.tangent(F);
};

template <class Law>
std::span<const std::string_view> names_of(const Law& law) {
  if constexpr (Hyperelastic<Law>)
    return {};
  else
    return law.names();
}

PointOutcome check_gradient(const Tensor& F) {
  if (!F.allFinite()) return PointOutcome::NotFinite;
  return F.determinant() > 0 ? PointOutcome::Solved : PointOutcome::Inverted;
}

/// The response with every failure as a value.
template <class Law>
FiniteResponse respond_safely(const Law& law, const PointContext& context, const Tensor& F,
                              std::span<const double> state_old, std::span<double> state_new) {
  FiniteResponse response{.outcome = check_gradient(F)};
  if (response.outcome == PointOutcome::Solved) {
    if constexpr (Hyperelastic<Law>)
      response = {.piola = law.piola(F), .stored = law.energy(F)};
    else
      response = law.respond(context, F, state_old, state_new);
  }
  if (response.outcome == PointOutcome::Solved && response.piola.allFinite() && std::isfinite(response.stored))
    return response;
  std::copy(state_old.begin(), state_old.end(), state_new.begin());
  return {.outcome = response.outcome == PointOutcome::Solved ? PointOutcome::NotFinite : response.outcome};
}

template <class Law>
PointOutcome tangent_safely(const Law& law, const PointContext& context, const Tensor& F,
                            std::span<const double> state_old, PiolaTangent& tangent) {
  PointOutcome outcome = check_gradient(F);
  if (outcome == PointOutcome::Solved) {
    if constexpr (Hyperelastic<Law>)
      tangent = law.tangent(F);
    else
      outcome = law.tangent(context, F, state_old, tangent);
  }
  if (outcome == PointOutcome::Solved && !tangent.allFinite()) outcome = PointOutcome::NotFinite;
  if (outcome != PointOutcome::Solved) tangent.setZero();
  return outcome;
}

} // namespace

std::span<const std::string_view> state_names(const FiniteLaw& law) {
  return std::visit([](const auto& one) { return names_of(one); }, law);
}

void initial_state(const FiniteLaw& law, std::span<double> state) {
  std::visit(
      [&]<class Law>(const Law& one) {
        if constexpr (!Hyperelastic<Law>) one.initial_state(state);
      },
      law);
}

Lame initial_lame(const FiniteLaw& law) {
  return std::visit([](const auto& one) { return one.lame(); }, law);
}

bool has_symmetric_tangent(const FiniteLaw& law) {
  const auto* plastic = std::get_if<FinitePlastic>(&law);
  return !plastic || !plastic->material.kinematic;
}

FiniteResponse respond(const FiniteLaw& law, const PointContext& context, const Tensor& F,
                       std::span<const double> state_old, std::span<double> state_new) {
  return std::visit([&](const auto& one) { return respond_safely(one, context, F, state_old, state_new); }, law);
}

PointOutcome tangent(const FiniteLaw& law, const PointContext& context, const Tensor& F,
                     std::span<const double> state_old, PiolaTangent& tangent) {
  return std::visit([&](const auto& one) { return tangent_safely(one, context, F, state_old, tangent); }, law);
}

std::optional<PointFailure> respond(const FiniteLaw& law, const PointContext& context, const FinitePoints& points,
                                    const FiniteResults& results) {
  return std::visit(
      [&](const auto& one) -> std::optional<PointFailure> {
        const std::size_t states = names_of(one).size();
        for (std::size_t i = 0; i < results.stored.size(); ++i) {
          const auto response =
              respond_safely(one, context, unflat(&points.F[9 * i]), points.state_old.subspan(i * states, states),
                             results.state_new.subspan(i * states, states));
          if (response.outcome != PointOutcome::Solved) return PointFailure{i, response.outcome};
          Eigen::Map<Eigen::Matrix<double, 9, 1>>{&results.piola[9 * i]} = flat(response.piola);
          results.stored[i] = response.stored;
          results.dissipated[i] = response.dissipated;
        }
        return std::nullopt;
      },
      law);
}

std::optional<PointFailure> tangents(const FiniteLaw& law, const PointContext& context, const FinitePoints& points,
                                     std::span<double> tangents) {
  return std::visit(
      [&](const auto& one) -> std::optional<PointFailure> {
        const std::size_t states = names_of(one).size();
        PiolaTangent tangent;
        for (std::size_t i = 0; i < tangents.size() / 81; ++i) {
          const auto outcome = tangent_safely(one, context, unflat(&points.F[9 * i]),
                                              points.state_old.subspan(i * states, states), tangent);
          if (outcome != PointOutcome::Solved) return PointFailure{i, outcome};
          Eigen::Map<PiolaTangent>{&tangents[81 * i]} = tangent;
        }
        return std::nullopt;
      },
      law);
}

} // namespace amontons
