#include "mesh/contact_pairs.hpp"

#include "mesh/raw_checks.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace amontons {
namespace {

using Place = Eigen::Vector3d;

struct Facet {
  Place centre;
  double size; // largest distance of a corner from the centre, twice
  std::int64_t cell;
};

std::vector<Facet> facets_of(const RawMesh& raw, const std::string& name, const FacetUses& uses) {
  std::vector<Facet> facets;
  for (const auto& sub : raw.subs) {
    const auto& group = raw.groups[sub.group];
    if (group.name != name || group.dim != raw.dim - 1) continue;
    Facet facet{Place::Zero(), 0.0, uses.at(corner_set<4>(sub.nodes)).cells[0]};
    const auto corner = [&](std::int64_t node) { return Place(raw.coordinates.data() + 3 * node); };
    for (const auto node : sub.nodes)
      facet.centre += corner(node) / static_cast<double>(sub.nodes.size());
    for (const auto node : sub.nodes)
      facet.size = std::max(facet.size, 2.0 * (corner(node) - facet.centre).norm());
    facets.push_back(facet);
  }
  return facets;
}

/// Facets sorted into cubes, so that those near a place are found in the 27 cubes round it.
class FacetGrid {
 public:
  FacetGrid(const std::vector<Facet>& facets, double width) : facets_(facets), width_(width) {
    for (std::size_t i = 0; i < facets.size(); ++i)
      cubes_[cube(facets[i].centre)].push_back(i);
  }

  /// The facet with the nearest centre among those within the width of a cube; nullptr when there is none.
  const Facet* nearest(const Place& place) const {
    const Facet* best = nullptr;
    double best_distance = width_;
    const auto middle = cube(place);
    for (std::int64_t n = 0; n < 27; ++n) {
      const FacetCorners neighbour = {middle[0] + n % 3 - 1, middle[1] + n / 3 % 3 - 1, middle[2] + n / 9 - 1, 0};
      const auto found = cubes_.find(neighbour);
      if (found == cubes_.end()) continue;
      for (const auto i : found->second) {
        const double distance = (facets_[i].centre - place).norm();
        if (distance >= best_distance) continue;
        best_distance = distance;
        best = &facets_[i];
      }
    }
    return best;
  }

 private:
  FacetCorners cube(const Place& place) const {
    // What an integer does not hold (far outliers, sizes that overflow) shares a cube: distances decide there, too.
    constexpr double most = 1e15;
    const auto index = [&](int i) {
      const double at = std::floor(place[i] / width_);
      return std::abs(at) < most ? static_cast<std::int64_t>(at) : std::int64_t(0);
    };
    return {index(0), index(1), index(2), 0};
  }

  const std::vector<Facet>& facets_;
  double width_;
  std::unordered_map<FacetCorners, std::vector<std::size_t>, CornerSetHash> cubes_;
};

double largest_size(const std::vector<Facet>& facets) {
  double size = 0.0;
  for (const auto& facet : facets)
    size = std::max(size, facet.size);
  return size;
}

void add_nearest(const std::vector<Facet>& from, const std::vector<Facet>& to,
                 std::vector<std::array<std::int64_t, 2>>& pairs) {
  const double width = largest_size(from) + largest_size(to);
  if (!(width > 0.0)) return;
  const FacetGrid grid(to, width);
  for (const auto& facet : from) {
    const Facet* near = grid.nearest(facet.centre);
    if (near && (near->centre - facet.centre).norm() < facet.size + near->size)
      pairs.push_back({facet.cell, near->cell});
  }
}

} // namespace

std::vector<std::array<std::int64_t, 2>> facing_cells(const RawMesh& raw, const ContactHints& hints) {
  std::vector<std::array<std::int64_t, 2>> pairs;
  if (hints.empty()) return pairs;
  const auto uses = group_facet_uses(raw);
  for (const auto& [first, second] : hints) {
    const auto facets = facets_of(raw, first, uses), others = facets_of(raw, second, uses);
    add_nearest(facets, others, pairs);
    add_nearest(others, facets, pairs);
  }
  return pairs;
}

} // namespace amontons
