// How large cells should be, as a function of place: what adaptive remeshing hands to gmsh. Plain geometry; knows
// neither gmsh nor errors.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace amontons {

/// Edge of the equilateral triangle or tetrahedron of this area or volume: A = √3/4 e², V = e³ / (6 √2).
double equilateral_edge(int dim, double volume);

/// How fast sizes may change with place. Steeper: fewer cells, but worse shapes, and sizes that gmsh does not follow.
inline constexpr double usual_growth = 0.35;

/// A ball in which cells should have edges of about `size`.
struct SizeSample {
  std::array<double, 3> place{};
  double radius = 0.0;
  double size = 0.0;
};

/// The largest sizes that respect all samples and grow with the distance x by at most `growth` x:
/// h(x) = min_i (size_i + growth max(0, |x - place_i| - radius_i)). Such a field is continuous with slope <= growth,
/// whatever the samples, and is defined everywhere: also where a new mesh reaches out of the old one on curved sides.
class SizeField {
 public:
  /// `samples`: at least one.
  SizeField(std::vector<SizeSample> samples, double growth);
  /// In O(log n) for n samples that lie apart.
  double operator()(const std::array<double, 3>& place) const;

 private:
  /// Samples first .. last - 1; the children of node k split them in halves and are 2 k + 1 and 2 k + 2.
  struct Node {
    std::array<double, 3> low, high;
    double least_size, largest_radius;
    std::int32_t first, last;
  };
  void plant(std::size_t node, std::int32_t first, std::int32_t last);
  void search(std::size_t node, const std::array<double, 3>& place, double& best) const;
  double bound(const Node& node, const std::array<double, 3>& place) const;

  std::vector<SizeSample> samples_;
  double growth_;
  std::vector<Node> nodes_;
};

} // namespace amontons
