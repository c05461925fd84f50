// Node order and shape functions against gmsh's own tables (the form room links gmsh, the math room does not).
#include "math/reference_element.hpp"

#include <doctest/doctest.h>
#include <gmsh.h>

using namespace amontons;

TEST_CASE("reference nodes are gmsh's, in gmsh's order") {
  struct Pair {
    ElementType type;
    int gmsh_type;
  };
  const Pair pairs[] = {{ElementType::Segment2, 1},       {ElementType::Segment3, 8},
                        {ElementType::Triangle3, 2},      {ElementType::Triangle6, 9},
                        {ElementType::Quadrilateral4, 3}, {ElementType::Quadrilateral9, 10},
                        {ElementType::Tetrahedron4, 4},   {ElementType::Tetrahedron10, 11},
                        {ElementType::Hexahedron8, 5},    {ElementType::Hexahedron27, 12}};
  gmsh::initialize();
  for (const auto& [type, gmsh_type] : pairs) {
    CAPTURE(int(type));
    std::string name;
    int dim, order, nodes, vertices;
    std::vector<double> coordinates;
    gmsh::model::mesh::getElementProperties(gmsh_type, name, dim, order, nodes, coordinates, vertices);
    CHECK(dim == element_dim(type));
    CHECK(order == element_order(type));
    CHECK(vertices == num_vertices(type));
    REQUIRE(nodes == num_nodes(type));
    REQUIRE(int(coordinates.size()) == nodes * dim);
    for (std::size_t i = 0; i < coordinates.size(); ++i)
      CHECK(reference_nodes(type)[i] == doctest::Approx(coordinates[i]).epsilon(1e-14));
  }
  gmsh::finalize();
}
