// Contacts that were not declared: bodies that overlap are found, bodies that touch or are welded are not.
#include "blocks.hpp"

#include "accuracy/inside_cell.hpp"
#include "math/reference_element.hpp"

#include <Eigen/Core>
#include <doctest/doctest.h>
#include <random>

using namespace amontons;
using namespace amontons::testing;

namespace {

/// Two blocks of unit sides, the second beside the first and moved by `by`; nothing declared.
Case neighbours(int dim, const std::array<double, 3>& by, bool welded = false) {
  Case scene;
  std::array<double, 3> one{1, 1, 1}, beside{1, 0, 0}, end{2, 1, 1};
  scene.mesh =
      block_mesh(MPI_COMM_WORLD, dim, {{"left", {0, 0, 0}, one, {4, 4, 4}}, {"right", beside, end, {3, 3, 3}}}, welded);
  scene.space = dim == 2 ? Space::PlaneStrain : Space::Solid;
  displace(scene, [&](const auto& x) { return x[0] > 1.0 + 1e-9 && !welded ? by : std::array<double, 3>{}; });
  // Nodes of the right block at x = 1 move with it, those of the left block do not.
  for (const auto& block : scene.mesh.blocks)
    if (block.body == 1 && !welded)
      for (const auto node : block.nodes)
        for (int c = 0; c < dim; ++c)
          scene.displacement[std::size_t(node) * dim + c] = by[c];
  scene.external.assign(scene.displacement.size(), 0.0);
  return scene;
}

} // namespace

TEST_CASE("overlap: bodies that touch, or almost, or are welded, pass") {
  for (const int dim : {2, 3}) {
    CHECK(neighbours(dim, {0, 0, 0}).certify().passed());
    CHECK(neighbours(dim, {1, 0, 0}).certify().passed());
    CHECK(neighbours(dim, {0, 0, 0}, true).certify().passed());
    const Case close = neighbours(dim, {-0.01, 0, 0}); // facet size 1/3 and 1/4
    CHECK(item(close.certify(), "missed_contact").value == doctest::Approx(0.01 / (1.0 / 3.0)).epsilon(1e-9));
    CHECK(close.certify().passed());
  }
}

TEST_CASE("overlap: undeclared and deep is found, with names and depth") {
  for (const int dim : {2, 3}) {
    const Certificate shallow = neighbours(dim, {-0.1, 0, 0}).certify();
    CHECK(item(shallow, "missed_contact").value == doctest::Approx(0.1 / (1.0 / 3.0)).epsilon(1e-9));
    CHECK(failures(shallow) == std::vector<std::string>{"missed_contact"});
    const std::string& where = item(shallow, "missed_contact").where;
    CHECK(where.find("body 'left'") != std::string::npos);
    CHECK(where.find("body 'right'") != std::string::npos);
    CHECK(where.find("no contact is declared") != std::string::npos);
    // Several cells deep.
    CHECK(item(neighbours(dim, {-0.5, 0, 0}).certify(), "missed_contact").value > 0.9);
  }
}

TEST_CASE("overlap: a small body inside a single cell of a large one") {
  Case scene;
  scene.mesh =
      block_mesh(MPI_COMM_WORLD, 2,
                 {{"large", {0, 0, 0}, {1, 1, 0}, {1, 1, 1}}, {"small", {0.4, 0.45, 0}, {0.5, 0.55, 0}, {1, 1, 1}}});
  scene.space = Space::PlaneStrain;
  displace(scene, [](const auto&) { return std::array<double, 3>{}; });
  scene.external.assign(scene.displacement.size(), 0.0);
  const auto found = item(scene.certify(), "missed_contact");
  CHECK(found.value == doctest::Approx(0.45)); // depth 0.45 to the top or bottom, size of the large facet 1
  CHECK(found.where.find("body 'small' inside body 'large'") != std::string::npos);
}

TEST_CASE("is_inside: agrees with the map of the cell") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-1.3, 1.3);
  for (const auto type :
       {ElementType::Triangle3, ElementType::Triangle6, ElementType::Quadrilateral4, ElementType::Quadrilateral9,
        ElementType::Tetrahedron4, ElementType::Tetrahedron10, ElementType::Hexahedron8, ElementType::Hexahedron27}) {
    const int dim = element_dim(type);
    const bool simplex = num_vertices(type) == dim + 1;
    const auto reference = reference_nodes(type);
    // A smooth map, one to one on the cell: x = 2 ξ + 0.1 (a polynomial that the element represents).
    std::vector<double> nodes;
    for (int a = 0; a < num_nodes(type); ++a)
      for (int c = 0; c < dim; ++c) {
        const double xi = reference[std::size_t(a) * dim + c], other = reference[std::size_t(a) * dim + (c + 1) % dim];
        nodes.push_back(2.0 * xi + 0.1 * (simplex && element_order(type) == 1 ? other : xi * other));
      }
    int inside = 0, outside = 0;
    for (int repeat = 0; repeat < 300; ++repeat) {
      std::array<double, 3> xi{number(random), number(random), number(random)}, x{};
      if (simplex) // as many points inside
        for (double& coordinate : xi)
          coordinate = 0.3 + 0.4 * coordinate;
      std::vector<double> values(num_nodes(type));
      shape_values(type, std::span(xi).first(dim), values);
      for (int a = 0; a < num_nodes(type); ++a)
        for (int c = 0; c < dim; ++c)
          x[c] += values[a] * nodes[std::size_t(a) * dim + c];
      double violation = -1e300, sum = 0.0;
      for (int c = 0; c < dim; ++c) {
        violation = std::max(violation, simplex ? -xi[c] : std::abs(xi[c]) - 1.0);
        sum += xi[c];
      }
      if (simplex) violation = std::max(violation, sum - 1.0);
      if (std::abs(violation) < 1e-9) continue;
      CHECK(accuracy::is_inside(type, nodes, std::span(x).first(dim)) == (violation < 0.0));
      (violation < 0.0 ? inside : outside) += 1;
    }
    CHECK(inside > 5);
    CHECK(outside > 5);
  }
}
