#include "material/small_plastic.hpp"

#include "material/radial_return.hpp"

namespace amontons {
namespace {

Trial trial_state(const Strain<3>& strain, std::span<const double> state_old) {
  const Tensor plastic = strain_tensor(Eigen::Map<const Strain<3>>(&state_old[1]));
  return {.elastic_strain = strain_tensor(strain) - plastic, .plastic_strain = plastic, .p = state_old[0]};
}

} // namespace

SmallResponse SmallPlastic::respond(const PointContext& context, const Strain<3>& strain,
                                    std::span<const double> state_old, std::span<double> state_new) const {
  const Trial trial = trial_state(strain, state_old);
  const RadialReturn end = radial_return(material, context, trial);
  if (!end.is_converged) return {.outcome = PointOutcome::NotConverged};
  state_new[0] = trial.p + end.p_increment;
  Eigen::Map<Strain<3>>{&state_new[1]} = strain_vector(trial.plastic_strain + end.flow);
  return {.stress = stress_vector(end.stress), .stored = end.stored, .dissipated = end.dissipated};
}

PointOutcome SmallPlastic::tangent(const PointContext& context, const Strain<3>& strain,
                                   std::span<const double> state_old, Moduli<3>& moduli) const {
  const RadialReturn end = radial_return(material, context, trial_state(strain, state_old));
  if (!end.is_converged) return PointOutcome::NotConverged;
  const auto& [bulk, shear, drop, flow] = end.moduli;
  moduli.setZero();
  moduli.topLeftCorner<3, 3>().setConstant(bulk - shear / 3);
  for (int i = 0; i < 6; ++i)
    moduli(i, i) += i < 3 ? shear : shear / 2;
  const Stress<3> n = stress_vector(flow); // n : dε = n · dε with engineering shears in dε
  moduli -= drop * n * n.transpose();
  return PointOutcome::Solved;
}

} // namespace amontons
