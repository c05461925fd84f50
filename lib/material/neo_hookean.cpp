#include "material/neo_hookean.hpp"

#include "material/elastic_rule.hpp"
#include "material/piola_terms.hpp"

#include <Eigen/LU>

namespace amontons {

double NeoHookean::energy(const Tensor& F) const {
  const auto [lambda, G] = lame();
  const auto [c, log_ratio] = small_invariants(F);
  return 0.5 * G * (c.trace() - 2 * log_ratio) + 0.5 * lambda * log_ratio * log_ratio;
}

Tensor NeoHookean::piola(const Tensor& F) const {
  const auto [lambda, G] = lame();
  const Tensor A = F.inverse().transpose();
  return G * (F - A) + lambda * small_invariants(F).log_ratio * A;
}

// d(F^-T) = −F^-T dF^T F^-T and d ln J = F^-T : dF.
PiolaTangent NeoHookean::tangent(const Tensor& F) const {
  const auto [lambda, G] = lame();
  const Tensor A = F.inverse().transpose();
  PiolaTangent tangent = G * PiolaTangent::Identity();
  add_transposed(tangent, G - lambda * small_invariants(F).log_ratio, A, A);
  add_dyad(tangent, lambda, A, A);
  return tangent;
}

Rule<NeoHookean> neo_hookean_rule() { return elastic_rule<NeoHookean>(&NeoHookean::elastic); }

} // namespace amontons
