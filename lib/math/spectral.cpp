#include "math/spectral.hpp"

#include <Eigen/Eigenvalues>
#include <limits>

namespace amontons {

Spectrum spectrum(const Tensor& symmetric) {
  if (!symmetric.allFinite())
    return {Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()), Tensor::Identity()};
  const Eigen::SelfAdjointEigenSolver<Tensor> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Tensor exp_symmetric(const Tensor& A) {
  const auto [values, vectors] = spectrum(A);
  return vectors * values.array().exp().matrix().asDiagonal() * vectors.transpose();
}

double log_quotient(double a, double b) {
  const double r = (a - b) / b;
  return r == 0 ? 1 / b : std::log1p(r) / (a - b);
}

Tensor strain_tensor(const Strain<3>& e) {
  Tensor E;
  E << e[0], e[3] / 2, e[5] / 2, e[3] / 2, e[1], e[4] / 2, e[5] / 2, e[4] / 2, e[2];
  return E;
}

Strain<3> strain_vector(const Tensor& E) { return {E(0, 0), E(1, 1), E(2, 2), 2 * E(0, 1), 2 * E(1, 2), 2 * E(2, 0)}; }

Stress<3> stress_vector(const Tensor& S) { return {S(0, 0), S(1, 1), S(2, 2), S(0, 1), S(1, 2), S(2, 0)}; }

Tensor deviator(const Tensor& A) { return A - A.trace() / 3 * Tensor::Identity(); }

} // namespace amontons
