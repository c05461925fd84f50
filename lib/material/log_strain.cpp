#include "material/log_strain.hpp"

namespace amontons {

// With C − 1 = H + H^T + H^T H instead of C, ln λ = ½ ln(1 + c) does not lose the digits of small strains.
LogStrain log_strain(const Tensor& F) {
  const Tensor H = F - Tensor::Identity();
  const auto [c, N] = spectrum(H + H.transpose() + H.transpose() * H);
  LogStrain strain{.F = F, .stretch = (1 + c.array()).sqrt(), .directions = N, .E = {}, .inverse_stretch = {}};
  strain.E = N * c.unaryExpr([](double value) { return 0.5 * std::log1p(value); }).asDiagonal() * N.transpose();
  strain.inverse_stretch = N * strain.stretch.cwiseInverse().asDiagonal() * N.transpose();
  return strain;
}

Tensor piola_stress(const LogStrain& strain, const Tensor& T) {
  return strain.F * strain.inverse_stretch * T * strain.inverse_stretch;
}

// In the mixed basis n_a = R N_a (rows), N_b (columns) let X = R^T dF and dR = R Ω with Ω skew. From dF = dR U + R dU:
//   X_ab = Ω_ab λ_b + dU_ab  =>  Ω_ab = (X_ab − X_ba) / (λ_a + λ_b),  dU_ab = (λ_a X_ab + λ_b X_ba) / (λ_a + λ_b),
//   dE_ab = dU_ab (ln λ_a − ln λ_b) / (λ_a − λ_b)   (1 / λ_a for a = b),   d(U^-1)_ab = −dU_ab / (λ_a λ_b),
//   R^T dP = Ω T U^-1 + dT U^-1 + T d(U^-1),   dT by the moduli.
// Done for the nine unit X, then turned back: dP_iJ = Σ n_a,i m_b,J (R^T dP)_ab and X_kl = n_k · dF m_l, m_b = G N_b.
PiolaTangent piola_tangent(const LogStrain& strain, const Tensor& T, const FlowModuli& moduli, const Tensor& G) {
  const auto& stretch = strain.stretch;
  const Tensor& N = strain.directions;
  const Tensor stress = N.transpose() * T * N, flow = N.transpose() * moduli.flow * N;
  const Eigen::Vector3d inverse = stretch.cwiseInverse();
  PiolaTangent local;
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) {
      Tensor spin = Tensor::Zero(), d_stretch = Tensor::Zero(), d_strain = Tensor::Zero();
      const double sum = stretch[k] + stretch[l];
      if (k != l) {
        spin(k, l) = 1 / sum;
        spin(l, k) = -1 / sum;
      }
      d_stretch(k, l) = d_stretch(l, k) = k == l ? 1 : stretch[k] / sum;
      d_strain(k, l) = d_strain(l, k) = d_stretch(k, l) * log_quotient(stretch[k], stretch[l]);
      const Tensor d_stress = moduli.bulk * d_strain.trace() * Tensor::Identity() + moduli.shear * deviator(d_strain) -
                              moduli.drop * contract(flow, d_strain) * flow;
      const Tensor d_piola =
          (spin * stress + d_stress - stress * inverse.asDiagonal() * d_stretch) * inverse.asDiagonal();
      local.col(3 * k + l) = flat(d_piola);
    }
  const Tensor n = strain.F * strain.inverse_stretch * N, m = G * N;
  PiolaTangent turn; // column 3 a + b: n_a m_b^T
  for (int i = 0; i < 3; ++i)
    for (int J = 0; J < 3; ++J)
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          turn(3 * i + J, 3 * a + b) = n(i, a) * m(J, b);
  return turn * local * turn.transpose();
}

} // namespace amontons
