#include "geometry/box_tree.hpp"

#include <algorithm>
#include <boost/geometry/algorithms/comparable_distance.hpp>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <boost/geometry/strategies/strategies.hpp>
#include <cmath>
#include <utility>

namespace amontons {

namespace {

namespace bg = boost::geometry;
using TreePoint = bg::model::point<double, 3, bg::cs::cartesian>;
using TreeBox = bg::model::box<TreePoint>;
using Entry = std::pair<TreeBox, std::int32_t>;

TreeBox tree_box(const Box& box) {
  return TreeBox(TreePoint(box.low[0], box.low[1], box.low[2]), TreePoint(box.high[0], box.high[1], box.high[2]));
}

} // namespace

void Box::include(std::span<const double> point) {
  for (std::size_t i = 0; i < 3; ++i) {
    const double value = i < point.size() ? point[i] : 0.0;
    low[i] = std::min(low[i], value);
    high[i] = std::max(high[i], value);
  }
}

void Box::include(const Box& other) {
  for (std::size_t i = 0; i < 3; ++i) {
    low[i] = std::min(low[i], other.low[i]);
    high[i] = std::max(high[i], other.high[i]);
  }
}

void Box::inflate(double margin) {
  if (empty()) return;
  for (std::size_t i = 0; i < 3; ++i) {
    low[i] -= margin;
    high[i] += margin;
  }
}

bool Box::meets(const Box& other) const {
  for (std::size_t i = 0; i < 3; ++i)
    if (low[i] > other.high[i] || high[i] < other.low[i]) return false;
  return true;
}

double Box::diagonal() const {
  return empty() ? 0.0 : std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
}

struct BoxTree::Tree {
  bg::index::rtree<Entry, bg::index::quadratic<16>> index;
};

BoxTree::BoxTree() : tree_(std::make_unique<Tree>()) {}
BoxTree::~BoxTree() = default;
BoxTree::BoxTree(BoxTree&&) noexcept = default;
BoxTree& BoxTree::operator=(BoxTree&&) noexcept = default;

BoxTree::BoxTree(std::span<const Box> boxes) : tree_(std::make_unique<Tree>()) {
  std::vector<Entry> entries;
  entries.reserve(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (!boxes[i].empty()) entries.emplace_back(tree_box(boxes[i]), static_cast<std::int32_t>(i));
  // Construction from a range packs the tree: fast to build, and its shape depends on the boxes alone.
  tree_->index = decltype(tree_->index)(entries);
}

void BoxTree::query(const Box& box, std::vector<std::int32_t>& found) const {
  found.clear();
  if (box.empty()) return;
  for (auto it = tree_->index.qbegin(bg::index::intersects(tree_box(box))); it != tree_->index.qend(); ++it)
    found.push_back(it->second);
  std::sort(found.begin(), found.end());
}

void BoxTree::nearest(std::span<const double> point, int count, std::vector<std::int32_t>& found) const {
  found.clear();
  if (count <= 0) return;
  const TreePoint at(point[0], point[1], point.size() > 2 ? point[2] : 0.0);
  std::vector<std::pair<double, std::int32_t>> nearest;
  for (auto it = tree_->index.qbegin(bg::index::nearest(at, static_cast<unsigned>(count))); it != tree_->index.qend();
       ++it)
    nearest.emplace_back(bg::comparable_distance(at, it->first), it->second);
  std::sort(nearest.begin(), nearest.end());
  for (const auto& [distance, index] : nearest)
    found.push_back(index);
}

} // namespace amontons
