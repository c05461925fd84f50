// The dual basis of a slave facet, and the basis of its displacements that it is dual to. Pure functions of numbers.
//
// Dual to N: functions ψ_i with ∫ ψ_i N_j = δ_ij ∫ N_j over the part of the facet that a master covers (B. I. Wohlmuth,
// SIAM J. Numer. Anal. 38 (2000) 989-1012; on the covered part only: T. Cichosz, M. Bischoff, Comput. Methods Appl.
// Mech. Engrg. 200 (2011) 1317-1332, "consistent modification"). They sum to one there, and reproduce what N does.
//
// Facets of order 2 are taken in their Bernstein basis: it spans the same displacements, but its functions are not
// negative anywhere, so that ∫ N_i > 0 on any covered part (the demand of B. Wohlmuth, A. Popp, M. Gee, W. Wall,
// Comput. Mech. 49 (2012) 735-747, who shift less and get it on whole facets).
#pragma once

#include "math/element_type.hpp"

#include <Eigen/Core>
#include <optional>
#include <span>

namespace amontons {

/// One row a point, one column a node of the facet.
using PointTable = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// B with u_a = Σ_k B_ak c_k: nodal values from control values of the facet's non-negative basis; the identity for
/// order 1. The values of that basis are N_nodal B.
const Eigen::MatrixXd& nodes_from_controls(ElementType type);
/// Its inverse.
const Eigen::MatrixXd& controls_from_nodes(ElementType type);

struct DualBasis {
  PointTable values;        // ψ_i at the points
  Eigen::VectorXd integral; // ∫ ψ_i = ∫ N_i, area
};

/// `shape`: values of non-negative functions at the covered points, `weights`: area of each. Nothing when the points
/// cover so little of the facet that they cannot tell its nodes apart.
std::optional<DualBasis> dual_basis(const PointTable& shape, std::span<const double> weights);

} // namespace amontons
