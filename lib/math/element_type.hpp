// The names of the finite elements that a mesh can hold. Node order is gmsh's for all of them.
#pragma once

#include <cstdint>

namespace amontons {

enum class ElementType : std::uint8_t {
  Segment2,
  Segment3,
  Triangle3,
  Triangle6,
  Quadrilateral4,
  Quadrilateral9,
  Tetrahedron4,
  Tetrahedron10,
  Hexahedron8,
  Hexahedron27,
};

constexpr int element_dim(ElementType type) {
  switch (type) {
  case ElementType::Segment2:
  case ElementType::Segment3:
    return 1;
  case ElementType::Triangle3:
  case ElementType::Triangle6:
  case ElementType::Quadrilateral4:
  case ElementType::Quadrilateral9:
    return 2;
  default:
    return 3;
  }
}

constexpr int num_nodes(ElementType type) {
  switch (type) {
  case ElementType::Segment2:
    return 2;
  case ElementType::Segment3:
  case ElementType::Triangle3:
    return 3;
  case ElementType::Triangle6:
    return 6;
  case ElementType::Quadrilateral4:
  case ElementType::Tetrahedron4:
    return 4;
  case ElementType::Quadrilateral9:
    return 9;
  case ElementType::Tetrahedron10:
    return 10;
  case ElementType::Hexahedron8:
    return 8;
  case ElementType::Hexahedron27:
    return 27;
  }
  return 0;
}

/// Corner nodes come first in every element.
constexpr int num_vertices(ElementType type) {
  switch (type) {
  case ElementType::Segment2:
  case ElementType::Segment3:
    return 2;
  case ElementType::Triangle3:
  case ElementType::Triangle6:
    return 3;
  case ElementType::Quadrilateral4:
  case ElementType::Quadrilateral9:
  case ElementType::Tetrahedron4:
  case ElementType::Tetrahedron10:
    return 4;
  case ElementType::Hexahedron8:
  case ElementType::Hexahedron27:
    return 8;
  }
  return 0;
}

constexpr int element_order(ElementType type) { return num_nodes(type) == num_vertices(type) ? 1 : 2; }

} // namespace amontons
