#include "material/hencky.hpp"

namespace amontons {
namespace {

Tensor rotated_stress(const Lame& lame, const Tensor& E) {
  return lame.lambda * E.trace() * Tensor::Identity() + 2 * lame.G * E;
}

} // namespace

double Hencky::energy(const Tensor& F) const {
  const Tensor E = log_strain(F).E;
  return 0.5 * contract(rotated_stress(lame(), E), E);
}

Tensor Hencky::piola(const Tensor& F) const {
  const LogStrain strain = log_strain(F);
  return piola_stress(strain, rotated_stress(lame(), strain.E));
}

PiolaTangent Hencky::tangent(const Tensor& F) const {
  const LogStrain strain = log_strain(F);
  const auto [lambda, G] = lame();
  const FlowModuli moduli{.bulk = lambda + 2.0 / 3 * G, .shear = 2 * G};
  return piola_tangent(strain, rotated_stress({lambda, G}, strain.E), moduli, Tensor::Identity());
}

} // namespace amontons
