#include "output/fields.hpp"

#include "base/error.hpp"
#include "hand_mesh.hpp"
#include "output/text_file.hpp"
#include "scratch.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <fstream>
#include <hdf5.h>
#include <limits>
#include <regex>
#include <sstream>

namespace amontons {
namespace {

const MPI_Comm world = MPI_COMM_WORLD;

struct Dataset {
  std::vector<std::int64_t> dims;
  bool is_integer = false;
  std::size_t bytes = 0;
  std::vector<double> values;
};

/// Reads with HDF5 alone, on one rank.
Dataset read_dataset(const std::string& file, const std::string& path) {
  const hid_t h5 = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  REQUIRE(h5 >= 0);
  const hid_t data = H5Dopen2(h5, path.c_str(), H5P_DEFAULT);
  CAPTURE(path);
  REQUIRE(data >= 0);
  Dataset result;
  const hid_t space = H5Dget_space(data), type = H5Dget_type(data);
  std::vector<hsize_t> dims(H5Sget_simple_extent_ndims(space));
  H5Sget_simple_extent_dims(space, dims.data(), nullptr);
  result.dims.assign(dims.begin(), dims.end());
  result.is_integer = H5Tget_class(type) == H5T_INTEGER;
  result.bytes = H5Tget_size(type);
  result.values.resize(H5Sget_simple_extent_npoints(space));
  H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, result.values.data());
  H5Tclose(type);
  H5Sclose(space);
  H5Dclose(data);
  H5Fclose(h5);
  return result;
}

/// Every dataset that the XDMF text names exists, with the shape and type that it says. The paths, in order.
std::vector<std::string> check_references(const std::string& directory, const std::string& xdmf) {
  const std::regex item(
      "Dimensions=\"([0-9 ]+)\" NumberType=\"(Int|Float)\" Precision=\"([0-9])\">fields.h5:([^<]+)</DataItem>");
  std::vector<std::string> paths;
  for (std::sregex_iterator it(xdmf.begin(), xdmf.end(), item), end; it != end; ++it) {
    const auto data = read_dataset(directory + "/fields.h5", (*it)[4]);
    std::istringstream text((*it)[1].str());
    std::vector<std::int64_t> dims;
    for (std::int64_t n; text >> n;)
      dims.push_back(n);
    CAPTURE((*it)[4].str());
    CHECK(data.dims == dims);
    CHECK(data.is_integer == ((*it)[2] == "Int"));
    CHECK(std::to_string(data.bytes) == (*it)[3].str());
    paths.push_back((*it)[4]);
  }
  std::size_t items = 0;
  for (auto at = xdmf.find("<DataItem"); at != std::string::npos; at = xdmf.find("<DataItem", at + 1))
    ++items;
  CHECK(paths.size() == items);
  CHECK(xdmf.ends_with("</Xdmf>\n"));
  return paths;
}

/// Twice the area, or six times the volume, of the elements of a Mixed topology by their corners (parallelograms,
/// parallelepipeds and simplices), and how many there are. Unknown codes fail.
std::pair<int, double> measure(const Dataset& topology, const Dataset& coordinates) {
  struct Kind {
    int nodes, dim;
    std::array<int, 4> frame; // corners that span it
    double share;
  };
  const std::map<int, Kind> kinds = {{2, {2, 1, {0, 1, 0, 0}, 1}}, {34, {3, 1, {0, 1, 0, 0}, 1}},
                                     {4, {3, 2, {0, 1, 2, 0}, 1}}, {36, {6, 2, {0, 1, 2, 0}, 1}},
                                     {5, {4, 2, {0, 1, 3, 0}, 2}}, {35, {9, 2, {0, 1, 3, 0}, 2}},
                                     {6, {4, 3, {0, 1, 2, 3}, 1}}, {38, {10, 3, {0, 1, 2, 3}, 1}},
                                     {9, {8, 3, {0, 1, 3, 4}, 6}}, {48, {20, 3, {0, 1, 3, 4}, 6}}};
  int count = 0;
  double sum = 0.0;
  for (std::size_t i = 0; i < topology.values.size(); ++count) {
    const int code = int(topology.values[i++]);
    REQUIRE(kinds.contains(code));
    if (code == 2) CHECK(topology.values[i++] == 2.0);
    const auto& kind = kinds.at(code);
    Eigen::Matrix3d edges = Eigen::Matrix3d::Identity();
    const auto corner = [&](int k) {
      return Eigen::Map<const Eigen::Vector3d>(
          &coordinates.values[3 * std::size_t(topology.values[i + kind.frame[k]])]);
    };
    for (int k = 0; k < kind.dim; ++k)
      edges.col(k) = corner(k + 1) - corner(0);
    if (kind.dim == 1) sum += edges.col(0).norm();
    if (kind.dim == 2) sum += kind.share * edges.col(0).cross(edges.col(1)).norm();
    if (kind.dim == 3) sum += kind.share * edges.determinant();
    i += kind.nodes;
  }
  return {count, sum};
}

double linear(std::span<const double> x, int k) {
  double value = 1.0 + k;
  for (std::size_t i = 0; i < x.size(); ++i)
    value += double(i + 2 + k) * x[i];
  return value;
}

/// A step whose every number is a linear function of place; keeps the arrays that the step refers to.
struct Sample {
  Sample(const Mesh& mesh, double time) {
    const int tensor_size = mesh.dim == 2 ? 4 : 6;
    for (std::int32_t node = 0; node < mesh.num_local(); ++node) {
      const auto x = mesh.position(node);
      mises.push_back(linear(x, 0));
      for (int k = 0; k < mesh.dim; ++k)
        displacement.push_back(linear(x, k));
      for (int k = 0; k < tensor_size; ++k)
        stress.push_back(linear(x, k));
      // As contact knows them: the multipliers of owned corners of the surface, and no others.
      if (node < mesh.num_owned && mesh.is_vertex[node] && std::abs(x[mesh.dim - 1] - top(mesh)) < 1e-12 &&
          x[0] < 2.1) {
        nodes.push_back(node);
        pressure.push_back(linear(x, 3));
      }
    }
    step.time = time;
    step.nodal = {{"displacement", FieldKind::Vector, displacement},
                  {"stress", FieldKind::SymmetricTensor, stress},
                  {"von_mises", FieldKind::Scalar, mises}};
    step.surfaces = {{"pair 1/a", "top", {{"pressure", nodes, pressure}}}};
    PointFields points{"pair 1/a", {}, {{"gap", 1, {}}, {"normal", 3, {}}}};
    const FacetSet& facets = mesh.surfaces.at("top");
    for (std::int32_t f = 0; f < facets.size(); ++f) {
      std::array<double, 3> place{};
      const auto x = mesh.position(facets.facet(f)[0]);
      std::copy(x.begin(), x.end(), place.begin());
      points.places.push_back(place);
      points.fields[0].values.push_back(place[0]);
      points.fields[1].values.insert(points.fields[1].values.end(), {0.0, 0.0, 1.0});
    }
    step.points = {points};
  }
  static double top(const Mesh& mesh) { return mesh.dim == 2 ? 3.0 : 2.0; }
  std::vector<double> displacement, stress, mises, pressure;
  std::vector<std::int32_t> nodes;
  FieldsStep step;
};

void check_values(const std::string& h5, int dim) {
  const auto places = read_dataset(h5, "/run0/mesh/coordinates");
  const auto displacement = read_dataset(h5, "/run0/step_000000/displacement");
  const auto stress = read_dataset(h5, "/run0/step_000000/stress");
  const auto mises = read_dataset(h5, "/run0/step_000000/von_mises");
  const int tensor_size = dim == 2 ? 4 : 6;
  for (std::size_t node = 0; node < mises.values.size(); ++node) {
    const auto x = std::span(places.values).subspan(3 * node, std::size_t(dim));
    CHECK(mises.values[node] == linear(x, 0));
    for (int k = 0; k < 3; ++k)
      CHECK(displacement.values[3 * node + k] == (k < dim ? linear(x, k) : 0.0));
    for (int k = 0; k < 6; ++k)
      CHECK(stress.values[6 * node + k] == (k < tensor_size ? linear(x, k) : 0.0));
  }
  const std::string fixed = "/run0/surfaces/pair_1_a", step = "/run0/step_000000/surfaces/pair_1_a";
  const auto on_surface = read_dataset(h5, fixed + "/coordinates");
  const auto pressure = read_dataset(h5, step + "/pressure");
  const auto moved = read_dataset(h5, step + "/displacement");
  for (std::size_t node = 0; node < pressure.values.size(); ++node) {
    const auto x = std::span(on_surface.values).subspan(3 * node, std::size_t(dim));
    CHECK(pressure.values[node] == doctest::Approx(linear(x, 3)).epsilon(1e-14));
    for (int k = 0; k < dim; ++k)
      CHECK(moved.values[3 * node + k] == linear(x, k));
  }
}

TEST_CASE("what the XDMF says is in the HDF5 file, for every element, order and partition") {
  const int ranks = world_size();
  const std::vector<std::function<int(int)>> partitions = {
      [=](int c) { return c % ranks; }, [=](int c) { return ranks - 1 - (c / 3) % ranks; }, [](int) { return 0; }};
  for (const int dim : {2, 3})
    for (const int order : {1, 2})
      for (const auto& partition : partitions) {
        const Scratch scratch("fields");
        const Mesh mesh = HandMesh{dim, order, {4, 3, 2}, 2}.distribute(world, partition);
        FieldsWriter writer(mesh, scratch.path(), "title");
        const Sample sample(mesh, 0.5);
        writer.write(sample.step);
        writer.write(sample.step);
        if (world_rank() != 0) continue;
        const auto xdmf = read_text(scratch / "fields.xdmf", "xdmf");
        // Two steps of: topology, geometry, body, rank, 3 nodal; topology, geometry, 2 of the surface; places, 2 of
        // points.
        CHECK(check_references(scratch.path(), xdmf).size() == 2 * (7 + 4 + 4));
        const std::string h5 = scratch / "fields.h5";
        const auto volume =
            measure(read_dataset(h5, "/run0/mesh/topology"), read_dataset(h5, "/run0/mesh/coordinates"));
        CHECK(volume.first == (dim == 2 ? 6 + 6 * 2 : 12 + 12 * 6));
        CHECK(volume.second == doctest::Approx(dim == 2 ? 2.0 * 12.0 : 6.0 * 24.0));
        const auto surface = measure(read_dataset(h5, "/run0/surfaces/pair_1_a/topology"),
                                     read_dataset(h5, "/run0/surfaces/pair_1_a/coordinates"));
        CHECK(surface.first == (dim == 2 ? 2 : 6));
        CHECK(surface.second == doctest::Approx(dim == 2 ? 2.0 : 2.0 * 6.0));
        const auto body = read_dataset(h5, "/run0/mesh/body");
        CHECK(std::count(body.values.begin(), body.values.end(), 0.0) == (dim == 2 ? 6 : 12));
        check_values(h5, dim);
      }
}

TEST_CASE("the files are complete after every step, and a restart goes on in its own partition") {
  const Scratch scratch("fields_restart");
  const int ranks = world_size();
  const HandMesh hand{2, 1, {4, 3, 1}, 2};
  const Mesh first = hand.distribute(world, [](int) { return 0; });
  {
    FieldsWriter writer(first, scratch.path(), "title");
    int steps = 0;
    for (const double time : {0.1, 0.2, 0.3}) {
      writer.write(Sample(first, time).step);
      ++steps;
      if (world_rank() == 0)
        CHECK(check_references(scratch.path(), read_text(scratch / "fields.xdmf", "xdmf")).size() == 15u * steps);
    }
  }
  const Mesh second = hand.distribute(world, [=](int c) { return c % ranks; });
  {
    FieldsWriter writer(second, scratch.path(), "title", 0.2);
    writer.write(Sample(second, 0.25).step);
  }
  if (world_rank() == 0) {
    const auto xdmf = read_text(scratch / "fields.xdmf", "xdmf");
    const auto paths = check_references(scratch.path(), xdmf);
    CHECK(paths.size() == 3 * 15);
    CHECK(std::ranges::count_if(paths, [](const auto& path) { return path.starts_with("/run1/"); }) == 15);
    CHECK(xdmf.find("<Time Value=\"0.2\"/>") < xdmf.find("<Time Value=\"0.25\"/>"));
    CHECK(xdmf.find("<Time Value=\"0.3\"/>") == std::string::npos);
  }
  // Into a directory without fields a restart starts new ones; with damaged ones it is refused.
  std::filesystem::path empty = scratch / "empty";
  if (world_rank() == 0) std::filesystem::create_directory(empty);
  MPI_Barrier(world);
  { FieldsWriter(second, empty, "title", 0.2).write(Sample(second, 0.25).step); }
  if (world_rank() == 0) CHECK(check_references(empty, read_text(empty / "fields.xdmf", "xdmf")).size() == 15);
  MPI_Barrier(world);
  if (world_rank() == 0) std::filesystem::resize_file(scratch / "fields.h5", 1000);
  MPI_Barrier(world);
  CHECK_THROWS_WITH_AS(FieldsWriter(second, scratch.path(), "title", 0.2), doctest::Contains("damaged"), UserError);
}

TEST_CASE("a surface value that nobody gives is not a number, not an invention") {
  const Scratch scratch("fields_missing");
  const Mesh mesh = HandMesh{2, 2, {4, 3, 1}, 2}.distribute(world, [](int) { return 0; });
  FieldsWriter writer(mesh, scratch.path(), "title");
  FieldsStep step;
  step.surfaces = {{"pair", "top", {{"pressure", {}, {}}}}};
  writer.write(step);
  if (world_rank() != 0) return;
  const auto pressure = read_dataset(scratch / "fields.h5", "/run0/step_000000/surfaces/pair/pressure");
  CHECK(pressure.values.size() == 5);
  CHECK(std::ranges::all_of(pressure.values, [](double value) { return std::isnan(value); }));
}

TEST_CASE("names for datasets") { CHECK(dataset_name("a b/c-d_1.2é") == "a_b_c-d_1.2__"); }

} // namespace
} // namespace amontons
