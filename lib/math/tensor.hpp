// Small vectors and tensors of fixed size. Symmetric tensors are stored as vectors with engineering shear strains:
// 2D: xx, yy, zz, xy (zz: out of plane or hoop); 3D: xx, yy, zz, xy, yz, zx.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>

namespace amontons {

template <int dim>
using Point = Eigen::Matrix<double, dim, 1>;

/// Number of stored components of a symmetric tensor.
template <int dim>
inline constexpr int strain_size = dim == 2 ? 4 : 6;

template <int dim>
using Strain = Eigen::Matrix<double, strain_size<dim>, 1>;
template <int dim>
using Stress = Eigen::Matrix<double, strain_size<dim>, 1>;
template <int dim>
using Moduli = Eigen::Matrix<double, strain_size<dim>, strain_size<dim>>;

/// sqrt(3/2 s : s), s the deviator of a stress with 4 or 6 stored components.
inline double von_mises(std::span<const double> stress) {
  double shear = 0;
  for (std::size_t i = 3; i < stress.size(); ++i)
    shear += stress[i] * stress[i];
  const double a = stress[0] - stress[1], b = stress[1] - stress[2], c = stress[2] - stress[0];
  return std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * shear);
}

} // namespace amontons
