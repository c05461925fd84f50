// Meshes of every kind of cell, order and refinement on the ranks of the run: sizes, normals, names of nodes, groups.
#include "mesh_support.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace amontons;
using namespace amontons::test;
using doctest::Approx;

namespace {

/// Calls check(mesh, shape, order, refine) for every kind of mesh.
template <class Check>
void for_all_kinds(Check&& check) {
  for (const auto& shape : all_shapes())
    for (const int order : {1, 2})
      for (const int refine : {0, 1}) {
        CAPTURE(shape);
        CAPTURE(order);
        CAPTURE(refine);
        check(mesh_from_geo(two_blocks(shape), order, refine), shape, order, refine);
      }
}

int body_index(const Mesh& mesh, const std::string& name) {
  return static_cast<int>(std::find(mesh.bodies.begin(), mesh.bodies.end(), name) - mesh.bodies.begin());
}

std::vector<std::uint64_t> keys_of(const Mesh& mesh, const std::vector<std::int32_t>& nodes) {
  std::vector<std::uint64_t> keys;
  for (const auto node : nodes)
    keys.push_back(mesh.keys[node]);
  return keys;
}

/// The same mesh on this process alone: what it must be on any number of ranks.
Mesh on_one_rank(const std::string& geo, int order, int refine) {
  RawMesh raw;
  const TemporaryFolder folder;
  raw = read_mesh({folder.write("mesh.geo", geo), {}, order});
  return distribute_mesh(PETSC_COMM_SELF, raw, {}, refine);
}

} // namespace

TEST_CASE("cells fill the blocks and have positive Jacobians") {
  for_all_kinds([](const Mesh& mesh, const std::string&, int, int) {
    REQUIRE(mesh.bodies == std::vector<std::string>{"lower", "upper"});
    double smallest = 0.0;
    CHECK(volume(mesh, -1, &smallest) == Approx(4.0).epsilon(1e-12));
    CHECK(smallest > 0.0);
    CHECK(volume(mesh, 0) == Approx(2.0).epsilon(1e-12));
    CHECK(volume(mesh, 1) == Approx(2.0).epsilon(1e-12));
  });
}

TEST_CASE("the exterior is closed and its normals point out of each body") {
  for_all_kinds([](const Mesh& mesh, const std::string&, int, int) {
    const double outside = mesh.dim == 2 ? 12.0 : 20.0;
    CHECK(area(mesh, mesh.exterior) == Approx(outside).epsilon(1e-12));
    for (const int body : {0, 1})
      CHECK(flux_of_position(mesh, mesh.exterior, body) == Approx(mesh.dim * 2.0).epsilon(1e-12));
  });
}

TEST_CASE("named surfaces have their area, side and body") {
  for_all_kinds([](const Mesh& mesh, const std::string&, int, int) {
    REQUIRE(mesh.surfaces.size() == 2);
    const auto& top = mesh.surfaces.at("lower_top");
    const auto& bottom = mesh.surfaces.at("upper_bottom");
    CHECK(area(mesh, top) == Approx(2.0).epsilon(1e-12));
    CHECK(total_normal(mesh, top)[1] == Approx(2.0).epsilon(1e-12));
    CHECK(total_normal(mesh, bottom)[1] == Approx(-2.0).epsilon(1e-12));
    for (const auto body : top.bodies)
      CHECK(body == body_index(mesh, "lower"));
    for (const auto body : bottom.bodies)
      CHECK(body == body_index(mesh, "upper"));
  });
}

TEST_CASE("nodes are numbered once, owners and ghosts agree on number, key and place") {
  for_all_kinds([](const Mesh& mesh, const std::string&, int, int) {
    CHECK(sum_over_ranks(std::int64_t(mesh.num_owned)) == mesh.num_global);
    CHECK(mesh.coordinates.size() == std::size_t(mesh.num_local()) * mesh.dim);
    // Owned nodes of all ranks, rank by rank, are in the order of their global numbers.
    const std::vector<std::uint64_t> owned(mesh.keys.begin(), mesh.keys.begin() + mesh.num_owned);
    const auto keys = gathered(owned);
    std::vector<std::uint64_t> places;
    for (std::int32_t i = 0; i < mesh.num_owned * mesh.dim; ++i) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, &mesh.coordinates[i], sizeof bits);
      places.push_back(bits);
    }
    const auto all_places = gathered(places);
    REQUIRE(std::int64_t(keys.size()) == mesh.num_global);
    CHECK(std::set<std::uint64_t>(keys.begin(), keys.end()).size() == keys.size());
    int rank = 0;
    MPI_Comm_rank(mesh.comm, &rank);
    for (std::int32_t node = mesh.num_owned; node < mesh.num_local(); ++node) {
      const auto global = mesh.global_node(node);
      REQUIRE(global >= 0);
      REQUIRE(global < mesh.num_global);
      CHECK((global < mesh.first_global || global >= mesh.first_global + mesh.num_owned));
      CHECK(mesh.ghost_owners[node - mesh.num_owned] != rank);
      CHECK(keys[global] == mesh.keys[node]);
      CHECK(std::memcmp(&all_places[global * mesh.dim], mesh.position(node).data(), mesh.dim * sizeof(double)) == 0);
    }
  });
}

TEST_CASE("nodes, keys and groups are those of the mesh on one rank") {
  for_all_kinds([](const Mesh& mesh, const std::string& shape, int order, int refine) {
    const auto alone = on_one_rank(two_blocks(shape), order, refine);
    CHECK(mesh.num_global == alone.num_global);
    CHECK(gathered_set(mesh.keys) == std::set<std::uint64_t>(alone.keys.begin(), alone.keys.end()));
    REQUIRE(mesh.node_groups.size() == alone.node_groups.size());
    std::map<std::uint64_t, std::int32_t> node_of_key;
    for (std::int32_t node = 0; node < alone.num_local(); ++node)
      node_of_key[alone.keys[node]] = node;
    for (const auto& [name, nodes] : alone.node_groups) {
      CAPTURE(name);
      CHECK(!nodes.empty());
      const auto expected = keys_of(alone, nodes);
      const std::set<std::uint64_t> in_group(expected.begin(), expected.end());
      CHECK(gathered_set(keys_of(mesh, mesh.node_groups.at(name))) == in_group);
      // Every rank that has a node of the group lists it, also where it has no element of the group.
      std::vector<std::int32_t> here;
      for (std::int32_t node = 0; node < mesh.num_local(); ++node)
        if (in_group.contains(mesh.keys[node])) here.push_back(node);
      auto listed = mesh.node_groups.at(name);
      std::sort(listed.begin(), listed.end());
      CHECK(listed == here);
    }
    double farthest = 0.0;
    for (std::int32_t node = 0; node < mesh.num_local(); ++node) {
      const auto twin = node_of_key.at(mesh.keys[node]);
      CHECK(mesh.is_vertex[node] == alone.is_vertex[twin]);
      for (int i = 0; i < mesh.dim; ++i)
        farthest = std::max(farthest, std::abs(mesh.position(node)[i] - alone.position(twin)[i]));
    }
    CHECK(farthest < 1e-14);
  });
}

TEST_CASE("groups hold the nodes that lie where they were drawn") {
  for_all_kinds([](const Mesh& mesh, const std::string&, int, int) {
    const auto on = [&](const std::string& name, auto&& lies_there) {
      std::vector<std::int32_t> expected;
      for (std::int32_t node = 0; node < mesh.num_local(); ++node)
        if (lies_there(mesh.position(node))) expected.push_back(node);
      auto listed = mesh.node_groups.at(name);
      std::sort(listed.begin(), listed.end());
      CHECK(listed == expected);
    };
    on("lower", [](auto x) { return x[1] < 1.05; });
    on("upper", [](auto x) { return x[1] > 1.05; });
    on("lower_top", [](auto x) { return std::abs(x[1] - 1.0) < 1e-9; });
    on("upper_bottom", [](auto x) { return std::abs(x[1] - 1.1) < 1e-9; });
    on("corner", [&](auto x) { return std::abs(x[1]) < 1e-9 && std::abs(mesh.dim == 2 ? x[0] : x[2]) < 1e-9; });
  });
}

TEST_CASE("refinement multiplies cells and facets") {
  for (const auto& shape : all_shapes()) {
    CAPTURE(shape);
    const auto coarse = mesh_from_geo(two_blocks(shape), 1, 0), fine = mesh_from_geo(two_blocks(shape), 1, 2);
    const auto cells = [](const Mesh& mesh) {
      std::int64_t count = 0;
      for (const auto& block : mesh.blocks)
        count += block.size();
      return sum_over_ranks(count);
    };
    const int children = coarse.dim == 2 ? 16 : 64;
    CHECK(cells(fine) == children * cells(coarse));
    CHECK(sum_over_ranks(std::int64_t(fine.exterior.size())) ==
          children / 4 * sum_over_ranks(std::int64_t(coarse.exterior.size())));
    CHECK(volume(fine, -1) == Approx(4.0).epsilon(1e-12));
  }
}

TEST_CASE("more ranks than cells leave some without any") {
  const std::string geo = "Point(1) = {0, 0, 0, 1}; Point(2) = {1, 0, 0, 1}; Line(1) = {1, 2};\n"
                          "Transfinite Curve{1} = 3;\n"
                          "s[] = Extrude{0, 1, 0}{ Curve{1}; Layers{1}; Recombine; };\n"
                          "Physical Surface(\"strip\") = {s[1]}; Physical Curve(\"bottom\") = {1};\n";
  for (const int order : {1, 2})
    for (const int refine : {0, 1}) {
      const auto mesh = mesh_from_geo(geo, order, refine);
      CHECK(mesh.bodies == std::vector<std::string>{"strip"});
      CHECK(mesh.surfaces.contains("bottom"));
      CHECK(volume(mesh, -1) == Approx(1.0).epsilon(1e-12));
      const int n = order * (1 + refine);
      CHECK(mesh.num_global == (2 * n + 1) * (n + 1));
    }
}

TEST_CASE("triangles and quadrilaterals share edges in one body") {
  const std::string geo = "h = 0.25; Point(1) = {0, 0, 0, h}; Point(2) = {1, 0, 0, h}; Line(1) = {1, 2};\n"
                          "q[] = Extrude{0, 1, 0}{ Curve{1}; Layers{4}; Recombine; };\n"
                          "t[] = Extrude{0, 1, 0}{ Curve{q[0]}; };\n"
                          "Physical Surface(\"body\") = {q[1], t[1]};\n";
  for (const int order : {1, 2})
    for (const int refine : {0, 1}) {
      const auto mesh = mesh_from_geo(geo, order, refine);
      CHECK(sum_over_ranks(std::int64_t(mesh.blocks.size())) >= 2);
      CHECK(volume(mesh, -1) == Approx(2.0).epsilon(1e-12));
      CHECK(area(mesh, mesh.exterior) == Approx(6.0).epsilon(1e-12)); // nothing along the shared edges
      CHECK(flux_of_position(mesh, mesh.exterior, 0) == Approx(4.0).epsilon(1e-12));
      CHECK(gathered_set(mesh.keys).size() == std::size_t(mesh.num_global));
    }
}
