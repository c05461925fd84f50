// Reading: what a .geo or .msh becomes, the same by every way, and what is refused. Serial: every rank does it alone.
#include "mesh_support.hpp"

#include "base/error.hpp"
#include "mesh/geo_script.hpp"
#include "mesh/topology.hpp"

#include "math/reference_element.hpp"

#include <algorithm>
#include <cmath>
#include <gmsh.h>

using namespace amontons;
using namespace amontons::test;
using doctest::Approx;

namespace {

/// The messages with which read_mesh refuses a file, joined; empty when it does not.
std::string refusal(const MeshSource& source) {
  try {
    read_mesh(source);
  } catch (const UserError& error) {
    return error.what();
  }
  return {};
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

const std::string quarter_disc =
    "DefineConstant[ n = 4 ]; h = 2 / n;\n"
    "Point(1) = {0, 0, 0, h}; Point(2) = {1, 0, 0, h}; Point(3) = {0, 1, 0, h};\n"
    "Line(1) = {1, 2}; Circle(2) = {2, 1, 3}; Line(3) = {3, 1}; Transfinite Curve{2} = n + 1;\n"
    "Curve Loop(1) = {1, 2, 3}; Plane Surface(1) = {1};\n"
    "Physical Surface(\"disc\") = {1}; Physical Curve(\"arc\") = {2};\n";

/// A .msh 2.2 text of one body "b" with the given nodes ("x y z" each) and elements ("type nodes...").
std::string msh2(const std::vector<std::string>& nodes, const std::vector<std::string>& elements, int dim = 2) {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n" + std::to_string(dim) +
                     " 1 \"b\"\n$EndPhysicalNames\n$Nodes\n" + std::to_string(nodes.size()) + "\n";
  for (std::size_t i = 0; i < nodes.size(); ++i)
    text += std::to_string(i + 1) + " " + nodes[i] + "\n";
  text += "$EndNodes\n$Elements\n" + std::to_string(elements.size()) + "\n";
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const auto space = elements[i].find(' ');
    text += std::to_string(i + 1) + " " + elements[i].substr(0, space) + " 2 1 1" + elements[i].substr(space) + "\n";
  }
  return text + "$EndElements\n";
}

double raw_volume(const RawMesh& raw) { return volume(distribute_mesh(PETSC_COMM_SELF, raw, {}, 0), -1); }

double raw_volume_on_self(const RawMesh& raw) {
  int ranks = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  return raw_volume(raw) / ranks; // volume() sums over the ranks, each of which has the whole
}

/// Centre of each cell, sorted (to 1e-9: text files round): cells irrespective of their order.
std::vector<std::array<double, 3>> centres(const RawMesh& raw) {
  std::vector<std::array<double, 3>> result;
  for (std::int64_t cell = 0; cell < raw.num_cells(); ++cell) {
    std::array<double, 3> centre{};
    const auto begin = raw.cell_offsets[cell], end = raw.cell_offsets[cell + 1];
    for (auto a = begin; a < end; ++a)
      for (int i = 0; i < 3; ++i)
        centre[i] += raw.coordinates[3 * raw.cell_nodes[a] + i] / static_cast<double>(end - begin);
    result.push_back(centre);
  }
  const auto rounded = [](const std::array<double, 3>& x) {
    return std::array<long, 3>{std::lround(1e9 * x[0]), std::lround(1e9 * x[1]), std::lround(1e9 * x[2])};
  };
  std::sort(result.begin(), result.end(), [&](const auto& a, const auto& b) { return rounded(a) < rounded(b); });
  return result;
}

} // namespace

TEST_CASE("facets of every cell point outwards and hold the nodes that lie on them") {
  for (const auto type :
       {ElementType::Triangle3, ElementType::Triangle6, ElementType::Quadrilateral4, ElementType::Quadrilateral9,
        ElementType::Tetrahedron4, ElementType::Tetrahedron10, ElementType::Hexahedron8, ElementType::Hexahedron27}) {
    CAPTURE(static_cast<int>(type));
    const int dim = element_dim(type);
    const auto nodes = reference_nodes(type);
    const auto place = [&](int node) { return nodes.subspan(std::size_t(node) * dim, dim); };
    std::vector<double> centre(dim, 0.0);
    for (int a = 0; a < num_vertices(type); ++a)
      for (int i = 0; i < dim; ++i)
        centre[i] += place(a)[i] / num_vertices(type);
    std::vector<double> flux(dim, 0.0);
    for (const auto& facet : topology(type).facets) {
      const auto facet_nodes = reference_nodes(facet.type);
      REQUIRE(int(facet.nodes.size()) == num_nodes(facet.type));
      std::vector<double> values(num_vertices(facet.type));
      for (int b = 0; b < num_nodes(facet.type); ++b) { // straight facets: each node where the corners put it
        shape_values(linear_element(facet.type), facet_nodes.subspan(std::size_t(b) * (dim - 1), dim - 1), values);
        for (int i = 0; i < dim; ++i) {
          double expected = 0.0;
          for (int corner = 0; corner < num_vertices(facet.type); ++corner)
            expected += values[corner] * place(facet.nodes[corner])[i];
          CHECK(place(facet.nodes[b])[i] == Approx(expected).epsilon(1e-14));
        }
      }
      std::array<double, 3> u{}, v{0, 0, 1}, from_centre{};
      for (int i = 0; i < dim; ++i) {
        u[i] = place(facet.nodes[1])[i] - place(facet.nodes[0])[i];
        if (dim == 3) v[i] = place(facet.nodes[2])[i] - place(facet.nodes[0])[i];
        from_centre[i] = place(facet.nodes[0])[i] - centre[i];
      }
      const double outwards = from_centre[0] * (u[1] * v[2] - u[2] * v[1]) +
                              from_centre[1] * (u[2] * v[0] - u[0] * v[2]) +
                              from_centre[2] * (u[0] * v[1] - u[1] * v[0]);
      CHECK(outwards > 0.1);
    }
  }
}

TEST_CASE("names of a script's parameters are found in its text") {
  const TemporaryFolder folder;
  folder.write("common.geo", "DefineConstant[ depth = 3 ];");
  const auto file = folder.write("a.geo", "// DefineConstant[ no = 1 ];\n/* DefineConstant[ nor = 1 ]; */\n"
                                          "DefineConstant[ h = 0.1, L = {1, Min 0, Name \"a,b]\"}, n ];\n"
                                          "Include \"common.geo\";\nIf (!Exists( w )) w = 2; EndIf\nvalue = 7;\n");
  CHECK(geo_parameters(file) == std::vector<std::string>{"h", "L", "n", "depth", "w"});
  CHECK(geo_parameters(folder.path("absent.geo")).empty());
}

TEST_CASE("parameters reach a script, also those with an ONELAB name") {
  const TemporaryFolder folder;
  const auto file = folder.write("a.geo", "DefineConstant[ L = {1, Name \"Geometry/length\"}, H = 1, h = 0.5 ];\n"
                                          "Point(1) = {0, 0, 0, h}; Point(2) = {L, 0, 0, h}; Line(1) = {1, 2};\n"
                                          "s[] = Extrude{0, H, 0}{ Curve{1}; };\nPhysical Surface(\"b\") = {s[1]};\n");
  CHECK(raw_volume_on_self(read_mesh({file, {}, 1})) == Approx(1.0));
  CHECK(raw_volume_on_self(read_mesh({file, {{"L", 2.5}, {"H", 1e-3}}, 1})) == Approx(2.5e-3));
  const auto message = refusal({file, {{"Length", 1.0}, {"k", 2.0}}, 1});
  CHECK(has(message, "no parameter 'Length'"));
  CHECK(has(message, "no parameter 'k'"));
  CHECK(has(message, "L, H and h"));
}

TEST_CASE("versions and encodings of .msh give the same mesh, at either order") {
  const TemporaryFolder folder;
  for (const auto& shape : {"mixed_2d", "mixed_3d"}) {
    for (const int order : {1, 2}) {
      CAPTURE(shape);
      CAPTURE(order);
      const auto geo = folder.write("a.geo", two_blocks(shape));
      const auto expected = read_mesh({geo, {}, order});
      for (const double version : {2.2, 4.1})
        for (const int binary : {0, 1}) {
          CAPTURE(version);
          CAPTURE(binary);
          const auto file = folder.path("a.msh");
          gmsh::initialize(0, nullptr, false);
          gmsh::option::setNumber("General.Terminal", 0);
          gmsh::open(geo);
          gmsh::model::mesh::generate(expected.dim);
          if (order == 2) gmsh::model::mesh::setOrder(2);
          gmsh::option::setNumber("Mesh.MshFileVersion", version);
          gmsh::option::setNumber("Mesh.Binary", binary);
          gmsh::write(file);
          gmsh::finalize();
          const auto raw = read_mesh({file, {}, {}});
          CHECK(raw.dim == expected.dim);
          CHECK(raw.order == order);
          CHECK(raw.group_names(-1) == expected.group_names(-1));
          CHECK(raw.subs.size() == expected.subs.size());
          REQUIRE(raw.coordinates.size() == expected.coordinates.size());
          const auto found = centres(raw), wanted = centres(expected);
          REQUIRE(found.size() == wanted.size());
          double farthest = 0.0;
          for (std::size_t c = 0; c < found.size(); ++c)
            for (int i = 0; i < 3; ++i)
              farthest = std::max(farthest, std::abs(found[c][i] - wanted[c][i]));
          CHECK(farthest < 1e-14);
        }
    }
  }
}

TEST_CASE("a .msh of one order is brought to the other with straight edges") {
  const TemporaryFolder folder;
  const auto geo = folder.write("disc.geo", quarter_disc);
  const auto linear = read_mesh({geo, {}, 1}), curved = read_mesh({geo, {}, 2});
  const double straight_area = raw_volume_on_self(linear);
  CHECK(raw_volume_on_self(curved) - straight_area > 0.01); // the arc bulges
  for (const int order : {1, 2}) {
    const auto file = folder.path("disc.msh");
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::open(geo);
    gmsh::model::mesh::generate(2);
    gmsh::model::mesh::setOrder(order);
    gmsh::write(file);
    gmsh::finalize();
    const auto other = read_mesh({file, {}, 3 - order});
    CHECK(other.order == 3 - order);
    CHECK(other.num_cells() == linear.num_cells());
    CHECK(other.coordinates.size() == (order == 1 ? curved : linear).coordinates.size());
    CHECK(raw_volume_on_self(other) == Approx(straight_area).epsilon(1e-12));
  }
}

TEST_CASE("thin cells of order 2 under a curved boundary do not turn over: those inside follow it") {
  // A 1 x 0.6 block with a round dent in its top, 0.134 deep, in one column of cells that are 0.05 high; extruded in
  // 3D.
  const std::string block =
      "DefineConstant[ solid = 0 ];\n"
      "Point(1) = {-0.5, -0.6, 0}; Point(2) = {0.5, -0.6, 0}; Point(3) = {0.5, 0, 0}; Point(4) = {-0.5, 0, 0};\n"
      "Point(5) = {0, Sqrt(0.75), 0};\n"
      "Line(1) = {1, 2}; Line(2) = {2, 3}; Circle(3) = {3, 5, 4}; Line(4) = {4, 1};\n"
      "Curve Loop(1) = {1:4}; Plane Surface(1) = {1};\n"
      "Transfinite Curve{1, 3} = 2; Transfinite Curve{2, 4} = 13; Transfinite Surface{1}; Recombine Surface{1};\n"
      "If (solid)\n v[] = Extrude{0, 0, 1}{ Surface{1}; Layers{1}; Recombine; };\n Physical Volume(\"block\") = "
      "{v[1]};\n"
      "Else\n Physical Surface(\"block\") = {1};\nEndIf\n";
  const double dent = 1.0 - std::sqrt(0.75);
  const TemporaryFolder folder;
  const auto file = folder.write("block.geo", block);
  for (const double solid : {0.0, 1.0}) {
    CAPTURE(solid);
    const auto raw = read_mesh({file, {{"solid", solid}}, 2}); // refuses cells that are turned over
    CHECK(raw.num_cells() == 12);
    CHECK(raw_volume_on_self(raw) == Approx(0.6 - 2.0 / 3.0 * dent).epsilon(1e-9)); // the arc is a parabola
    double lowest = 1.0;
    for (std::size_t i = 0; i + 2 < raw.coordinates.size(); i += 3)
      if (std::abs(raw.coordinates[i]) < 1e-6) lowest = std::min(lowest, std::abs(raw.coordinates[i + 1] + dent));
    CHECK(lowest < 1e-9); // its middle is where it was
  }
}

TEST_CASE("second-order geometry keeps its accuracy under refinement") {
  // An arc of angle a replaced by the parabola through its ends and middle: the area is wrong by O(a^5), so that of n
  // arcs together falls by 16 when n is doubled. Refinement keeps the shape that the coarse cells describe.
  std::vector<double> errors;
  for (const double n : {4.0, 8.0, 16.0}) {
    const auto mesh = mesh_from_geo(quarter_disc, 2, 0, {{"n", n}});
    const auto fine = mesh_from_geo(quarter_disc, 2, 2, {{"n", n}});
    const double found = volume(mesh, -1);
    errors.push_back(std::abs(found - std::atan(1.0)));
    CHECK(errors.back() < 0.1 / std::pow(n, 4));
    CHECK(std::abs(volume(fine, -1) - found) < 1e-3 * errors.back() + 1e-12);
  }
  CHECK(errors[0] / errors[1] == Approx(16.0).epsilon(0.05));
  CHECK(errors[1] / errors[2] == Approx(16.0).epsilon(0.05));
}

TEST_CASE("refinement puts new nodes on the curved cells' own maps") {
  // A bent strip: every node of the refined mesh lies on the image of the coarse cells' quadratic map, here exactly
  // y = x² + eta, where the unrefined cells have their nodes on that surface too.
  std::vector<std::string> nodes;
  for (const double eta : {0.0, 0.5, 1.0})
    for (const double x : {0.0, 0.5, 1.0})
      nodes.push_back(std::to_string(x) + " " + std::to_string(x * x + eta) + " 0");
  const TemporaryFolder folder;
  const auto file = folder.write("bent.msh", msh2(nodes, {"10 1 3 9 7 2 6 8 4 5"}));
  const auto mesh = distribute_mesh(PETSC_COMM_SELF, read_mesh({file, {}, {}}), {}, 2);
  CHECK(mesh.num_local() == 81);
  for (std::int32_t node = 0; node < mesh.num_local(); ++node) {
    const double x = mesh.position(node)[0], eta = mesh.position(node)[1] - x * x;
    CHECK(std::abs(8 * x - std::round(8 * x)) < 1e-13);
    CHECK(std::abs(8 * eta - std::round(8 * eta)) < 1e-13);
  }
}

TEST_CASE("serendipity cells are completed by their own interpolation") {
  // x and y are quadratics that the 8 nodes represent (no x²y²); so are the 20 nodes' functions in 3D.
  const auto bent = [](double x, double y, double z) {
    return std::to_string(x + 0.1 * y * y) + " " + std::to_string(y + 0.125 * x * x) + " " + std::to_string(z);
  };
  const TemporaryFolder folder;
  std::vector<std::string> nodes;
  const auto quadrilateral = reference_nodes(ElementType::Quadrilateral9);
  for (int a = 0; a < 8; ++a)
    nodes.push_back(bent(quadrilateral[2 * a], quadrilateral[2 * a + 1], 0.0));
  const auto plane = read_mesh({folder.write("q8.msh", msh2(nodes, {"16 1 2 3 4 5 6 7 8"})), {}, {}});
  REQUIRE(plane.coordinates.size() == 27);
  CHECK(plane.cell_types.front() == ElementType::Quadrilateral9);
  CHECK(std::abs(plane.coordinates[24]) < 1e-14);
  CHECK(std::abs(plane.coordinates[25]) < 1e-14);

  nodes.clear();
  std::string cell = "17";
  const auto hexahedron = reference_nodes(ElementType::Hexahedron27);
  for (int a = 0; a < 20; ++a) {
    nodes.push_back(bent(hexahedron[3 * a], hexahedron[3 * a + 1], hexahedron[3 * a + 2]));
    cell.append(" ").append(std::to_string(a + 1));
  }
  const auto solid = read_mesh({folder.write("h20.msh", msh2(nodes, {cell}, 3)), {}, {}});
  REQUIRE(solid.coordinates.size() == 81);
  for (int a = 20; a < 27; ++a) {
    const double x = hexahedron[3 * a], y = hexahedron[3 * a + 1], z = hexahedron[3 * a + 2];
    const auto place = std::span(solid.coordinates).subspan(3 * solid.cell_nodes[a], 3);
    CHECK(std::abs(place[0] - (x + 0.1 * y * y)) < 1e-14);
    CHECK(std::abs(place[1] - (y + 0.125 * x * x)) < 1e-14);
    CHECK(std::abs(place[2] - z) < 1e-14);
  }
}

TEST_CASE("cells given the wrong way round are turned") {
  const TemporaryFolder folder;
  const std::vector<std::string> square = {"0 0 0", "1 0 0", "1 1 0", "0 1 0", "2 0 0", "2 1 0"};
  const auto quadrilaterals = folder.write("q.msh", msh2(square, {"3 1 4 3 2", "3 2 5 6 3"}));
  CHECK(raw_volume_on_self(read_mesh({quadrilaterals, {}, 1})) == Approx(2.0));
  CHECK(raw_volume_on_self(read_mesh({quadrilaterals, {}, 2})) == Approx(2.0));
  const auto tetrahedron = folder.write("t.msh", msh2({"0 0 0", "1 0 0", "0 1 0", "0 0 1"}, {"4 1 3 2 4"}, 3));
  CHECK(raw_volume_on_self(read_mesh({tetrahedron, {}, 1})) == Approx(1.0 / 6));
  CHECK(raw_volume_on_self(read_mesh({tetrahedron, {}, 2})) == Approx(1.0 / 6));
}

TEST_CASE("a file that is none is refused by name") {
  const TemporaryFolder folder;
  CHECK(has(refusal({folder.path("absent.geo"), {}, 1}), "absent.geo' does not exist"));
  CHECK(has(refusal({folder.write("plate.inp", "x"), {}, 1}), "neither in .geo nor in .msh"));
  const auto file = folder.write("a.msh", msh2({"0 0 0", "1 0 0", "0 1 0"}, {"2 1 2 3"}));
  CHECK(refusal({file, {}, 1}).empty());
  CHECK(has(refusal({file, {{"h", 1.0}}, 1}), "takes no parameters"));
}

TEST_CASE("a section that does not say how many entries it has is refused with its line") {
  const TemporaryFolder folder;
  const auto sound = msh2({"0 0 0", "1 0 0", "0 1 0"}, {"2 1 2 3"});
  for (const std::string section : {"$Nodes", "$Elements"}) {
    auto text = sound;
    text.insert(text.find(section) + section.size() + 1, "nts\n");
    const auto line = std::to_string(2 + std::count(sound.begin(), sound.begin() + sound.find(section), '\n'));
    CHECK(has(refusal({folder.write("counts.msh", text), {}, 1}),
              "line " + line + " must say how many entries the section " + section + " has"));
  }
  CHECK(refusal({folder.write("sound.msh", sound), {}, 1}).empty());
}

TEST_CASE("every fault of a mesh is told at once, and a refusal leaves nothing behind for the next") {
  const TemporaryFolder folder;
  const std::vector<std::string> nodes = {"0 0 0", "1 0 0", "1 1 0", "0 1 0", "2 0 0", "2 1 0", "3 0 0"};
  const auto bad = folder.write("bad.msh", msh2(nodes, {"3 1 2 3 4", "3 2 5 3 6", "2 1 2 7"}));
  const auto script = folder.write("bad.geo", "Point(1) = {0, 0, 0, size};\n");
  for (int repeat = 0; repeat < 2; ++repeat) {
    const auto message = refusal({bad, {}, 1});
    CHECK(has(message, "inverted cells (their Jacobian changes sign): 1, the first at nodes 2, 5, 3 and 6"));
    CHECK(has(message, "degenerate cells (no area or volume): 1, the first at nodes 1, 2 and 7"));
    CHECK_FALSE(has(message, "Unknown variable"));
    CHECK(has(refusal({script, {}, 1}), "line 1: Unknown variable 'size'"));
  }
  CHECK(raw_volume_on_self(read_mesh({folder.write("disc.geo", quarter_disc), {}, 2})) ==
        Approx(std::atan(1.0)).epsilon(1e-3));
}

TEST_CASE("boundary groups must be on the outside") {
  const std::string glued = "Point(1) = {0, 0, 0, 1}; Point(2) = {1, 0, 0, 1}; Line(1) = {1, 2};\n"
                            "a[] = Extrude{0, 1, 0}{ Curve{1}; }; b[] = Extrude{0, 1, 0}{ Curve{a[0]}; };\n"
                            "Physical Surface(\"one\") = {a[1]}; Physical Surface(\"two\") = {b[1]};\n"
                            "Physical Curve(\"between\") = {a[0]}; Physical Curve(\"outside\") = {1};\n";
  const TemporaryFolder folder;
  const auto raw = read_mesh({folder.write("a.geo", glued), {}, 1});
  CHECK_NOTHROW(check_boundary_groups(raw, {"outside"}));
  std::string message;
  try {
    check_boundary_groups(raw, {"outside", "between", "one", "outsude"});
  } catch (const UserError& error) {
    message = error.what();
  }
  CHECK(has(message, "'between'"));
  CHECK(has(message, "inside a body"));
  CHECK(has(message, "'one' has dimension 2"));
  CHECK(has(message, "no physical group 'outsude'"));
  CHECK(has(message, "between, one, outside and two"));
  CHECK_FALSE(has(message, "'outside'"));

  // Between the bodies there is no exterior, but the nodes of the group are there. Line length 1, mesh size 1, once
  // refined: 3 nodes.
  const auto mesh = distribute_mesh(PETSC_COMM_SELF, raw, {}, 1);
  CHECK(mesh.surfaces.at("between").size() == 0);
  CHECK(mesh.node_groups.at("between").size() == 3);
  CHECK(mesh.node_groups.at("one").size() + mesh.node_groups.at("two").size() == std::size_t(mesh.num_local()) + 3);
}
