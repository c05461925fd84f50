// Functions of symmetric 3x3 tensors through their eigenvalues, safe where eigenvalues coalesce.
#pragma once

#include "math/tensor.hpp"

namespace amontons {

/// A second-order tensor in three dimensions; (i, j) is row i, column j.
using Tensor = Eigen::Matrix3d;

/// values[a] belongs to the unit vector vectors.col(a); values ascend. Vectors of a repeated value are any orthonormal
/// basis of their space.
struct Spectrum {
  Eigen::Vector3d values;
  Tensor vectors;
};

/// Eigenvalues to rounding relative to the largest one, by the implicit QL iteration: closed formulas would lose half
/// of the digits where eigenvalues coalesce. A tensor that is not finite has eigenvalues that are not finite.
Spectrum spectrum(const Tensor& symmetric);

/// e^A = Σ e^a v v^T.
Tensor exp_symmetric(const Tensor& A);

/// (ln a − ln b) / (a − b) for a, b > 0, and its limit 1 / b at a = b: the derivative of a logarithm of a tensor
/// between two of its eigenvectors. Relative error of some roundings for any a and b, however close.
double log_quotient(double a, double b);

/// The tensor of six components in the order of tensor.hpp with engineering shears (γ_xy = 2 ε_xy).
Tensor strain_tensor(const Strain<3>& strain);
Strain<3> strain_vector(const Tensor& strain);
/// The six components of a symmetric tensor as they are.
Stress<3> stress_vector(const Tensor& stress);

/// A − tr(A)/3 1.
Tensor deviator(const Tensor& A);

/// A : B = Σ A_ij B_ij.
inline double contract(const Tensor& A, const Tensor& B) { return A.cwiseProduct(B).sum(); }

} // namespace amontons
