// Is a point inside a cell? By inverting the map of the cell. For lib/accuracy only.
#pragma once

#include "math/element_type.hpp"

#include <span>

namespace amontons::accuracy {

/// `nodes`: num_nodes(type) x dim positions of a cell of full dimension. Points on the border count as inside. A point
/// for which Newton's method does not converge counts as outside.
bool is_inside(ElementType type, std::span<const double> nodes, std::span<const double> x);

} // namespace amontons::accuracy
