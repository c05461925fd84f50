// The four kinds of term of which dP/dF of an isotropic hyperelastic law is a sum, named by what they do to dF.
#pragma once

#include "material/point.hpp"

#include <Eigen/LU>

namespace amontons {

/// A += a X (Y : dF)
inline void add_dyad(PiolaTangent& A, double a, const Tensor& X, const Tensor& Y) {
  A += (a * flat(X)) * flat(Y).transpose();
}

/// A += a X dF^T Y, entry X_iL Y_kJ
inline void add_transposed(PiolaTangent& A, double a, const Tensor& X, const Tensor& Y) {
  for (int i = 0; i < 3; ++i)
    for (int J = 0; J < 3; ++J)
      for (int k = 0; k < 3; ++k)
        for (int L = 0; L < 3; ++L)
          A(3 * i + J, 3 * k + L) += a * X(i, L) * Y(k, J);
}

/// A += a X dF, entry X_ik δ_JL
inline void add_left(PiolaTangent& A, double a, const Tensor& X) {
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      for (int J = 0; J < 3; ++J)
        A(3 * i + J, 3 * k + J) += a * X(i, k);
}

/// A += a dF X, entry δ_ik X_LJ
inline void add_right(PiolaTangent& A, double a, const Tensor& X) {
  for (int i = 0; i < 3; ++i)
    for (int J = 0; J < 3; ++J)
      for (int L = 0; L < 3; ++L)
        A(3 * i + J, 3 * i + L) += a * X(L, J);
}

/// tr C − 3 and ln J of F, without cancellation near F = 1.
struct SmallInvariants {
  Tensor c;         // C − 1
  double log_ratio; // ln J
};
inline SmallInvariants small_invariants(const Tensor& F) {
  const Tensor H = F - Tensor::Identity();
  const double trace = H.trace(), second = 0.5 * (trace * trace - (H * H).trace());
  return {H + H.transpose() + H.transpose() * H, std::log1p(trace + second + H.determinant())};
}

} // namespace amontons
