// Small meshes for the tests of lib/mesh, and integrals over them.
#pragma once

#include "mesh/build.hpp"

#include <array>
#include <doctest/doctest.h>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace amontons::test {

/// A folder of this test run that is removed with the object; made by each process for itself.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  /// Writes a file and gives its path.
  std::string write(const std::string& name, const std::string& text) const;
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

 private:
  std::filesystem::path folder_;
};

/// The RawMesh of a .geo text; empty but on rank 0.
RawMesh raw_from_geo(const std::string& geo, int order, const std::map<std::string, double>& parameters = {});

/// Collective.
Mesh mesh_from_geo(const std::string& geo, int order, int refine = 0,
                   const std::map<std::string, double>& parameters = {}, const ContactHints& hints = {});

/// Two unit-thickness blocks apart from each other, `lower` [0,2]x[0,1](x[0,1]) and `upper` [0,2]x[1.1,2.1](x[0,1]), of
/// cells named by shape: triangles, quadrilaterals, tetrahedra, hexahedra, or mixed (one of each kind). Surface groups
/// lower_top and upper_bottom, the curve (3D) or point (2D) group `corner`.
std::string two_blocks(const std::string& shape);
inline const std::vector<std::string> shapes_2d = {"triangles", "quadrilaterals", "mixed_2d"};
inline const std::vector<std::string> shapes_3d = {"tetrahedra", "hexahedra", "mixed_3d"};
std::vector<std::string> all_shapes();

double sum_over_ranks(double value);
std::int64_t sum_over_ranks(std::int64_t value);

/// Integral of 1 over the cells of a body (all for -1) on all ranks; with `smallest` the smallest det J over weights'
/// points.
double volume(const Mesh& mesh, int body, double* smallest = nullptr);
/// Integrals over a facet set on all ranks.
double area(const Mesh& mesh, const FacetSet& facets);
/// ∮ x · n over the facets of one body (all for -1): dim times its volume when they are its whole outside.
double flux_of_position(const Mesh& mesh, const FacetSet& facets, int body);
/// The integral of the normal over the facets.
std::array<double, 3> total_normal(const Mesh& mesh, const FacetSet& facets);

/// The values of all ranks together, on every rank.
std::vector<std::uint64_t> gathered(const std::vector<std::uint64_t>& values);
std::set<std::uint64_t> gathered_set(const std::vector<std::uint64_t>& values);

} // namespace amontons::test
