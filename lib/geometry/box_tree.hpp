// Finding boxes near boxes: axis-aligned bounding boxes in an R-tree (Boost.Geometry, hidden in the source file).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace amontons {

struct Box {
  std::array<double, 3> low{+1e300, +1e300, +1e300};
  std::array<double, 3> high{-1e300, -1e300, -1e300};
  /// Grows to hold a point of 2 or 3 coordinates (a missing one counts as 0).
  void include(std::span<const double> point);
  void include(const Box& other);
  void inflate(double margin);
  bool empty() const { return low[0] > high[0]; }
  bool meets(const Box& other) const;
  double diagonal() const;
};

/// Immutable after construction.
class BoxTree {
 public:
  BoxTree();
  explicit BoxTree(std::span<const Box> boxes);
  ~BoxTree();
  BoxTree(BoxTree&&) noexcept;
  BoxTree& operator=(BoxTree&&) noexcept;

  /// Indices of the boxes that meet `box`, ascending, into `found` (cleared first).
  void query(const Box& box, std::vector<std::int32_t>& found) const;
  /// Indices of the `count` boxes nearest to `point`, nearest first.
  void nearest(std::span<const double> point, int count, std::vector<std::int32_t>& found) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

} // namespace amontons
