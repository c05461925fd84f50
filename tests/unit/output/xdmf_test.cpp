#include "output/xdmf.hpp"

#include "math/reference_element.hpp"

#include <algorithm>
#include <doctest/doctest.h>
#include <map>
#include <numeric>

namespace amontons {
namespace {

/// VTK's documentation of its cells (vtkQuadraticTetra, vtkQuadraticHexahedron ...): every node after the corners is
/// the middle of these corners.
const std::map<ElementType, std::vector<std::vector<int>>> vtk_middles = {
    {ElementType::Segment3, {{0, 1}}},
    {ElementType::Triangle6, {{0, 1}, {1, 2}, {2, 0}}},
    {ElementType::Quadrilateral9, {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 1, 2, 3}}},
    {ElementType::Tetrahedron10, {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}},
    // shown as VTK's quadratic hexahedron of 20 nodes
    {ElementType::Hexahedron27,
     {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}}};

TEST_CASE("second-order nodes stand where VTK expects them") {
  for (const auto& [type, middles] : vtk_middles) {
    const auto order = xdmf_order(type);
    const auto reference = reference_nodes(type);
    const int dim = element_dim(type), corners = num_vertices(type);
    REQUIRE(order.size() == corners + middles.size());
    CHECK(int(order.size()) == (type == ElementType::Hexahedron27 ? 20 : num_nodes(type)));
    for (int a = 0; a < corners; ++a)
      CHECK(order[a] == a);
    for (std::size_t k = 0; k < middles.size(); ++k)
      for (int i = 0; i < dim; ++i) {
        double middle = 0.0;
        for (const int corner : middles[k])
          middle += reference[corner * dim + i] / double(middles[k].size());
        CAPTURE(int(type));
        CAPTURE(corners + k);
        CHECK(reference[order[corners + k] * dim + i] == doctest::Approx(middle));
      }
  }
}

TEST_CASE("first-order elements keep their order") {
  for (const auto type : {ElementType::Segment2, ElementType::Triangle3, ElementType::Quadrilateral4,
                          ElementType::Tetrahedron4, ElementType::Hexahedron8}) {
    std::vector<int> counting(num_nodes(type));
    std::iota(counting.begin(), counting.end(), 0);
    CHECK(std::ranges::equal(xdmf_order(type), counting));
  }
}

TEST_CASE("codes of the XDMF model and format page") {
  const std::map<ElementType, std::vector<int>> codes = {
      {ElementType::Segment2, {2, 2}},  {ElementType::Segment3, {34}},      {ElementType::Triangle3, {4}},
      {ElementType::Triangle6, {36}},   {ElementType::Quadrilateral4, {5}}, {ElementType::Quadrilateral9, {35}},
      {ElementType::Tetrahedron4, {6}}, {ElementType::Tetrahedron10, {38}}, {ElementType::Hexahedron8, {9}},
      {ElementType::Hexahedron27, {48}}};
  for (const auto& [type, code] : codes)
    CHECK(std::ranges::equal(xdmf_announcement(type), code));
}

TEST_CASE("the steps up to a time are found again in the file's text") {
  XdmfGrid grid;
  grid.name = "a <b> & \"c\"";
  std::string file = xdmf_head("title");
  for (const double time : {0.1, 0.2, 0.1 + 0.2, 1e-7 + 1.0})
    file += xdmf_step(time, {grid});
  file += xdmf_tail();
  CHECK(file.find("a &lt;b&gt; &amp; &quot;c&quot;") != std::string::npos);
  CHECK(xdmf_steps_until(file, 0.0).count == 0);
  CHECK(xdmf_steps_until(file, 0.3).count == 3); // 0.1 + 0.2 is a rounding error later
  const auto all = xdmf_steps_until(file, 2.0);
  CHECK(all.count == 4);
  CHECK(xdmf_head("title") + all.text + xdmf_tail() == file);
}

} // namespace
} // namespace amontons
