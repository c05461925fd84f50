#include "material/mooney_rivlin.hpp"

#include "deck/rule.hpp"
#include "material/piola_terms.hpp"

#include <Eigen/LU>

namespace amontons {
namespace {

// With A = F^-T: ∂J/∂F = J A, ∂tr C/∂F = 2 F, ∂I2/∂F = 2 B with B = I1 F − F C.
struct Parts {
  Tensor A, C, B;
  double I1, I2, J;
  Tensor first_slope, second_slope; // ∂Ī1/∂F and ∂Ī2/∂F without their factors J^(-2/3), J^(-4/3)
};

Parts parts(const Tensor& F) {
  Parts p;
  p.A = F.inverse().transpose();
  p.C = F.transpose() * F;
  p.I1 = p.C.trace();
  p.I2 = 0.5 * (p.I1 * p.I1 - p.C.squaredNorm());
  p.B = p.I1 * F - F * p.C;
  p.J = F.determinant();
  p.first_slope = 2 * F - 2.0 / 3 * p.I1 * p.A;
  p.second_slope = 2 * p.B - 4.0 / 3 * p.I2 * p.A;
  return p;
}

} // namespace

double MooneyRivlin::energy(const Tensor& F) const {
  const auto [c, log_ratio] = small_invariants(F);
  const double trace = c.trace(), I1 = 3 + trace;                                             // I1 − 3 = tr c
  const double second = 2 * trace + 0.5 * (trace * trace - c.squaredNorm()), I2 = 3 + second; // I2 − 3
  const double first_bar = I1 * std::expm1(-2.0 / 3 * log_ratio) + trace;
  const double second_bar = I2 * std::expm1(-4.0 / 3 * log_ratio) + second;
  return C_10 * first_bar + C_01 * second_bar + K / 4 * (std::expm1(2 * log_ratio) - 2 * log_ratio);
}

Tensor MooneyRivlin::piola(const Tensor& F) const {
  const Parts p = parts(F);
  const double a = C_10 * std::pow(p.J, -2.0 / 3), b = C_01 * std::pow(p.J, -4.0 / 3);
  return a * p.first_slope + b * p.second_slope + 0.5 * K * std::expm1(2 * small_invariants(F).log_ratio) * p.A;
}

PiolaTangent MooneyRivlin::tangent(const Tensor& F) const {
  const Parts p = parts(F);
  const double a = C_10 * std::pow(p.J, -2.0 / 3), b = C_01 * std::pow(p.J, -4.0 / 3), square = p.J * p.J;
  PiolaTangent tangent = 2 * a * PiolaTangent::Identity();
  // a ∂Ī1/∂F
  add_dyad(tangent, -2.0 / 3 * a, p.first_slope, p.A);
  add_dyad(tangent, -4.0 / 3 * a, p.A, F);
  add_transposed(tangent, 2.0 / 3 * a * p.I1, p.A, p.A);
  // b ∂Ī2/∂F; dB = 2 F (F : dF) + I1 dF − dF C − F dF^T F − F F^T dF
  add_dyad(tangent, -4.0 / 3 * b, p.second_slope, p.A);
  add_dyad(tangent, 4 * b, F, F);
  add_right(tangent, 2 * b, p.I1 * Tensor::Identity() - p.C);
  add_transposed(tangent, -2 * b, F, F);
  add_left(tangent, -2 * b, F * F.transpose());
  add_dyad(tangent, -8.0 / 3 * b, p.A, p.B);
  add_transposed(tangent, 4.0 / 3 * b * p.I2, p.A, p.A);
  // U' J F^-T = K/2 (J² − 1) F^-T
  add_dyad(tangent, K * square, p.A, p.A);
  add_transposed(tangent, -0.5 * K * (square - 1), p.A, p.A);
  return tangent;
}

Lame MooneyRivlin::lame() const {
  const double G = 2 * (C_10 + C_01);
  return {K - 2.0 / 3 * G, G};
}

Rule<MooneyRivlin> mooney_rivlin_rule() {
  using Law = MooneyRivlin;
  return ObjectRule<Law>()
      .required("C10", &Law::C_10, number("stress", Range::above(0)), "Coefficient of the first invariant.")
      .optional("C01", &Law::C_01, number("stress", Range::at_least(0)), "Coefficient of the second invariant.")
      .required("K", &Law::K, number("stress", Range::above(0)),
                "Bulk modulus; 1000 times C10 + C01 is nearly incompressible.");
}

} // namespace amontons
