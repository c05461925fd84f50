#include "mesh/size_field.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

namespace {

constexpr std::int32_t samples_in_leaf = 8;

} // namespace

double equilateral_edge(int dim, double volume) {
  return dim == 2 ? std::sqrt(4.0 / std::sqrt(3.0) * volume) : std::cbrt(6.0 * std::sqrt(2.0) * volume);
}

SizeField::SizeField(std::vector<SizeSample> samples, double growth) : samples_(std::move(samples)), growth_(growth) {
  plant(0, 0, static_cast<std::int32_t>(samples_.size()));
}

void SizeField::plant(std::size_t node, std::int32_t first, std::int32_t last) {
  Node made{.low = {1e300, 1e300, 1e300},
            .high = {-1e300, -1e300, -1e300},
            .least_size = 1e300,
            .largest_radius = 0.0,
            .first = first,
            .last = last};
  for (auto i = first; i < last; ++i) {
    for (int c = 0; c < 3; ++c) {
      made.low[c] = std::min(made.low[c], samples_[i].place[c]);
      made.high[c] = std::max(made.high[c], samples_[i].place[c]);
    }
    made.least_size = std::min(made.least_size, samples_[i].size);
    made.largest_radius = std::max(made.largest_radius, samples_[i].radius);
  }
  if (nodes_.size() <= node) nodes_.resize(node + 1);
  nodes_[node] = made;
  if (last - first <= samples_in_leaf) return;
  int longest = 0;
  for (int c = 1; c < 3; ++c)
    if (made.high[c] - made.low[c] > made.high[longest] - made.low[longest]) longest = c;
  const auto middle = (first + last) / 2;
  std::nth_element(samples_.begin() + first, samples_.begin() + middle, samples_.begin() + last,
                   [longest](const SizeSample& a, const SizeSample& b) { return a.place[longest] < b.place[longest]; });
  plant(2 * node + 1, first, middle);
  plant(2 * node + 2, middle, last);
}

/// No sample of the node asks for less at `place`.
double SizeField::bound(const Node& node, const std::array<double, 3>& place) const {
  double square = 0.0;
  for (int c = 0; c < 3; ++c)
    square += std::pow(std::max({0.0, node.low[c] - place[c], place[c] - node.high[c]}), 2);
  return node.least_size + growth_ * std::max(0.0, std::sqrt(square) - node.largest_radius);
}

void SizeField::search(std::size_t node, const std::array<double, 3>& place, double& best) const {
  const Node& here = nodes_[node];
  if (here.last - here.first <= samples_in_leaf) {
    for (auto i = here.first; i < here.last; ++i) {
      const auto& s = samples_[i];
      const double distance = std::hypot(place[0] - s.place[0], place[1] - s.place[1], place[2] - s.place[2]);
      best = std::min(best, s.size + growth_ * std::max(0.0, distance - s.radius));
    }
    return;
  }
  std::size_t near = 2 * node + 1, far = near + 1;
  double near_bound = bound(nodes_[near], place), far_bound = bound(nodes_[far], place);
  if (far_bound < near_bound) {
    std::swap(near, far);
    std::swap(near_bound, far_bound);
  }
  if (near_bound < best) search(near, place, best);
  if (far_bound < best) search(far, place, best);
}

double SizeField::operator()(const std::array<double, 3>& place) const {
  double best = 1e300;
  search(0, place, best);
  return best;
}

} // namespace amontons
