#include "mesh_support.hpp"

#include "base/error.hpp"
#include "math/reference_element.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <atomic>
#include <fstream>
#include <limits>
#include <unistd.h>

namespace amontons::test {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::MatrixXd places(const Mesh& mesh, std::span<const std::int32_t> nodes) {
  Eigen::MatrixXd result(mesh.dim, nodes.size());
  for (std::size_t a = 0; a < nodes.size(); ++a)
    for (int i = 0; i < mesh.dim; ++i)
      result(i, static_cast<Eigen::Index>(a)) = mesh.position(nodes[a])[i];
  return result;
}

/// Calls visit(place, normal times area times weight) at the quadrature points of a facet.
template <class Visit>
void integrate_facet(const Mesh& mesh, const FacetSet& facets, std::int32_t f, Visit&& visit) {
  const auto& table = tabulation(facets.types[f], 6);
  const Eigen::MatrixXd x = places(mesh, facets.facet(f));
  for (int q = 0; q < table.rule->size(); ++q) {
    const Eigen::MatrixXd tangents = x * Eigen::Map<const Matrix>(table.gradient(q).data(), x.cols(), mesh.dim - 1);
    const Eigen::VectorXd place = x * Eigen::Map<const Eigen::VectorXd>(table.value(q).data(), x.cols());
    Eigen::VectorXd normal(mesh.dim);
    if (mesh.dim == 2)
      normal << tangents(1, 0), -tangents(0, 0);
    else
      normal = Eigen::Vector3d(tangents.col(0)).cross(Eigen::Vector3d(tangents.col(1)));
    visit(place, Eigen::VectorXd(normal * table.rule->weights[q]));
  }
}

std::string rectangle(int first, const std::string& y, const std::string& divisions) {
  const auto n = [&](int i) { return std::to_string(first + i); };
  return "Point(" + n(0) + ") = {0, " + y + ", 0, h}; Point(" + n(1) + ") = {2, " + y + ", 0, h};\n" + "Point(" + n(2) +
         ") = {2, " + y + " + 1, 0, h}; Point(" + n(3) + ") = {0, " + y + " + 1, 0, h};\n" + "Line(" + n(0) + ") = {" +
         n(0) + ", " + n(1) + "}; Line(" + n(1) + ") = {" + n(1) + ", " + n(2) + "}; Line(" + n(2) + ") = {" + n(2) +
         ", " + n(3) + "}; Line(" + n(3) + ") = {" + n(3) + ", " + n(0) + "};\n" + "Curve Loop(" + n(0) + ") = {" +
         n(0) + ":" + n(3) + "}; Plane Surface(" + n(0) + ") = {" + n(0) + "};\n" + divisions;
}

std::string structured(int first) {
  const auto n = [&](int i) { return std::to_string(first + i); };
  return "Transfinite Curve{" + n(0) + "," + n(2) + "} = 2/h + 1; Transfinite Curve{" + n(1) + "," + n(3) +
         "} = 1/h + 1; Transfinite Surface{" + n(0) + "}; Recombine Surface{" + n(0) + "};\n";
}

std::string plane_blocks(bool lower_quadrilateral, bool upper_quadrilateral) {
  return "DefineConstant[ h = {0.5, Name \"Parameters/h\"} ];\n" +
         rectangle(1, "0", lower_quadrilateral ? structured(1) : "") +
         rectangle(11, "1.1", upper_quadrilateral ? structured(11) : "") +
         "Physical Surface(\"lower\") = {1}; Physical Surface(\"upper\") = {11};\n"
         "Physical Curve(\"lower_top\") = {3}; Physical Curve(\"upper_bottom\") = {11};\n"
         "Physical Point(\"corner\") = {1};\n";
}

std::string solid_blocks(bool lower_hexahedra, bool upper_hexahedra) {
  const std::string layers = " Layers{Round(1/h)}; Recombine; ";
  return "DefineConstant[ h = 0.5 ];\n" + rectangle(1, "0", lower_hexahedra ? structured(1) : "") +
         rectangle(11, "1.1", upper_hexahedra ? structured(11) : "") + "a[] = Extrude{0, 0, 1}{ Surface{1};" +
         (lower_hexahedra ? layers : "") + "};\n" + "b[] = Extrude{0, 0, 1}{ Surface{11};" +
         (upper_hexahedra ? layers : "") + "};\n" +
         "Physical Volume(\"lower\") = {a[1]}; Physical Volume(\"upper\") = {b[1]};\n"
         "Physical Surface(\"lower_top\") = {a[4]}; Physical Surface(\"upper_bottom\") = {b[2]};\n"
         "Physical Curve(\"corner\") = {1};\n";
}

} // namespace

TemporaryFolder::TemporaryFolder() {
  static std::atomic<int> count = 0;
  folder_ = std::filesystem::temp_directory_path() /
            ("amontons_test_" + std::to_string(getpid()) + "_" + std::to_string(count++));
  std::filesystem::create_directories(folder_);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::string TemporaryFolder::write(const std::string& name, const std::string& text) const {
  std::ofstream(folder_ / name) << text;
  return path(name);
}

RawMesh raw_from_geo(const std::string& geo, int order, const std::map<std::string, double>& parameters) {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank > 0) return {};
  const TemporaryFolder folder;
  return read_mesh({folder.write("mesh.geo", geo), parameters, order});
}

Mesh mesh_from_geo(const std::string& geo, int order, int refine, const std::map<std::string, double>& parameters,
                   const ContactHints& hints) {
  RawMesh raw;
  on_root(PETSC_COMM_WORLD, [&] { raw = raw_from_geo(geo, order, parameters); });
  return distribute_mesh(PETSC_COMM_WORLD, raw, hints, refine);
}

std::vector<std::string> all_shapes() {
  auto all = shapes_2d;
  all.insert(all.end(), shapes_3d.begin(), shapes_3d.end());
  return all;
}

std::string two_blocks(const std::string& shape) {
  if (shape == "triangles") return plane_blocks(false, false);
  if (shape == "quadrilaterals") return plane_blocks(true, true);
  if (shape == "mixed_2d") return plane_blocks(false, true);
  if (shape == "tetrahedra") return solid_blocks(false, false);
  if (shape == "hexahedra") return solid_blocks(true, true);
  return solid_blocks(false, true);
}

double sum_over_ranks(double value) {
  double sum = 0.0;
  MPI_Allreduce(&value, &sum, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  return sum;
}

std::int64_t sum_over_ranks(std::int64_t value) {
  std::int64_t sum = 0;
  MPI_Allreduce(&value, &sum, 1, MPI_INT64_T, MPI_SUM, PETSC_COMM_WORLD);
  return sum;
}

double volume(const Mesh& mesh, int body, double* smallest) {
  double sum = 0.0, least = std::numeric_limits<double>::max();
  for (const auto& block : mesh.blocks) {
    if (body >= 0 && block.body != body) continue;
    const auto& table = tabulation(block.type, 6);
    for (std::int32_t c = 0; c < block.size(); ++c) {
      const Eigen::MatrixXd x = places(mesh, block.cell(c));
      for (int q = 0; q < table.rule->size(); ++q) {
        const Eigen::MatrixXd jacobian = x * Eigen::Map<const Matrix>(table.gradient(q).data(), x.cols(), mesh.dim);
        least = std::min(least, jacobian.determinant());
        sum += jacobian.determinant() * table.rule->weights[q];
      }
    }
  }
  if (smallest) MPI_Allreduce(&least, smallest, 1, MPI_DOUBLE, MPI_MIN, PETSC_COMM_WORLD);
  return sum_over_ranks(sum);
}

double area(const Mesh& mesh, const FacetSet& facets) {
  double sum = 0.0;
  for (std::int32_t f = 0; f < facets.size(); ++f)
    integrate_facet(mesh, facets, f, [&](const auto&, const auto& normal) { sum += normal.norm(); });
  return sum_over_ranks(sum);
}

double flux_of_position(const Mesh& mesh, const FacetSet& facets, int body) {
  double sum = 0.0;
  for (std::int32_t f = 0; f < facets.size(); ++f)
    if (body < 0 || facets.bodies[f] == body)
      integrate_facet(mesh, facets, f, [&](const auto& place, const auto& normal) { sum += place.dot(normal); });
  return sum_over_ranks(sum);
}

std::array<double, 3> total_normal(const Mesh& mesh, const FacetSet& facets) {
  std::array<double, 3> sum{};
  for (std::int32_t f = 0; f < facets.size(); ++f)
    integrate_facet(mesh, facets, f, [&](const auto&, const auto& normal) {
      for (int i = 0; i < mesh.dim; ++i)
        sum[i] += normal[i];
    });
  for (double& component : sum)
    component = sum_over_ranks(component);
  return sum;
}

std::vector<std::uint64_t> gathered(const std::vector<std::uint64_t>& values) {
  int ranks = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  const int size = static_cast<int>(values.size());
  std::vector<int> sizes(ranks), offsets(ranks + 1, 0);
  MPI_Allgather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, PETSC_COMM_WORLD);
  for (int r = 0; r < ranks; ++r)
    offsets[r + 1] = offsets[r] + sizes[r];
  std::vector<std::uint64_t> all(offsets[ranks]);
  MPI_Allgatherv(values.data(), size, MPI_UINT64_T, all.data(), sizes.data(), offsets.data(), MPI_UINT64_T,
                 PETSC_COMM_WORLD);
  return all;
}

std::set<std::uint64_t> gathered_set(const std::vector<std::uint64_t>& values) {
  const auto all = gathered(values);
  return {all.begin(), all.end()};
}

} // namespace amontons::test
