#include "material/st_venant_kirchhoff.hpp"

#include "material/elastic_rule.hpp"
#include "material/piola_terms.hpp"

namespace amontons {
namespace {

Tensor second_piola(const Lame& lame, const Tensor& E) {
  return lame.lambda * E.trace() * Tensor::Identity() + 2 * lame.G * E;
}

} // namespace

double StVenantKirchhoff::energy(const Tensor& F) const {
  const Tensor E = 0.5 * small_invariants(F).c;
  return 0.5 * contract(second_piola(lame(), E), E);
}

Tensor StVenantKirchhoff::piola(const Tensor& F) const { return F * second_piola(lame(), 0.5 * small_invariants(F).c); }

PiolaTangent StVenantKirchhoff::tangent(const Tensor& F) const {
  const auto [lambda, G] = lame();
  PiolaTangent A = PiolaTangent::Zero();
  add_right(A, 1, second_piola({lambda, G}, 0.5 * small_invariants(F).c));
  add_dyad(A, lambda, F, F);
  add_transposed(A, G, F, F);
  add_left(A, G, F * F.transpose());
  return A;
}

Rule<StVenantKirchhoff> st_venant_kirchhoff_rule() {
  return elastic_rule<StVenantKirchhoff>(&StVenantKirchhoff::elastic);
}

} // namespace amontons
