// Shape values of a facet with their derivatives, in one table.
#pragma once

#include "math/element_type.hpp"

#include <Eigen/Core>

#include <span>

namespace amontons {

/// Nodes on which the place of a contact point's projection may depend: those of a smoothed quadrilateral.
constexpr int most_stencil_nodes = 16;

/// Shape values of a facet for its place (row 0), tangents (1, 2) and second derivatives (3, 4, 5), node by node.
using ShapeTable = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, most_stencil_nodes>;

ShapeTable shape_table(ElementType type, std::span<const double> xi);

} // namespace amontons
