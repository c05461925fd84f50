#include "material/finite_plastic.hpp"

#include "material/radial_return.hpp"

#include <algorithm>

namespace amontons {
namespace {

constexpr std::size_t gradient_at = 1, strain_at = 10;

/// The increment up to the stress in rotated axes.
struct Increment {
  Tensor G_old; // F_p^-1
  LogStrain strain;
  Trial trial;
  RadialReturn end;
};

Increment advance(const ElasticPlastic& material, const PointContext& context, const Tensor& F,
                  std::span<const double> state_old) {
  const Tensor G_old = unflat(&state_old[gradient_at]);
  const LogStrain strain = log_strain(F * G_old);
  Trial trial{.elastic_strain = strain.E, .p = state_old[0]};
  if (material.kinematic) trial.plastic_strain = strain_tensor(Eigen::Map<const Strain<3>>(&state_old[strain_at]));
  return {G_old, strain, trial, radial_return(material, context, trial)};
}

} // namespace

std::span<const std::string_view> FinitePlastic::names() const {
  return std::span(all_state_names).first(material.kinematic ? all_state_names.size() : strain_at);
}

void FinitePlastic::initial_state(std::span<double> state) const {
  std::fill(state.begin(), state.end(), 0.0);
  for (std::size_t i = 0; i < 3; ++i)
    state[gradient_at + 4 * i] = 1;
}

FiniteResponse FinitePlastic::respond(const PointContext& context, const Tensor& F, std::span<const double> state_old,
                                      std::span<double> state_new) const {
  const auto [G_old, strain, trial, end] = advance(material, context, F, state_old);
  if (!end.is_converged) return {.outcome = PointOutcome::NotConverged};
  std::copy(state_old.begin(), state_old.end(), state_new.begin());
  if (end.p_increment > 0) {
    state_new[0] = trial.p + end.p_increment;
    const Tensor G = G_old * strain.inverse_stretch * exp_symmetric(strain.E - end.flow);
    Eigen::Map<Eigen::Matrix<double, 9, 1>>{&state_new[gradient_at]} = flat(G);
    if (material.kinematic)
      Eigen::Map<Strain<3>>{&state_new[strain_at]} = strain_vector(trial.plastic_strain + end.flow);
  }
  return {.piola = piola_stress(strain, end.stress) * G_old.transpose(),
          .stored = end.stored,
          .dissipated = end.dissipated};
}

PointOutcome FinitePlastic::tangent(const PointContext& context, const Tensor& F, std::span<const double> state_old,
                                    PiolaTangent& tangent) const {
  const auto [G_old, strain, trial, end] = advance(material, context, F, state_old);
  if (!end.is_converged) return PointOutcome::NotConverged;
  tangent = piola_tangent(strain, end.stress, end.moduli, G_old);
  return PointOutcome::Solved;
}

} // namespace amontons
