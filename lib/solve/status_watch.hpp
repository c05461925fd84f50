// Follows the branches of all switching forms from iterate to iterate: a fingerprint for each, and which points flip.
#pragma once

#include "form/problem.hpp"

#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <tuple>
#include <vector>

namespace amontons {

/// A point that does not come to rest.
struct FlippingPoint {
  std::string name; // of what it belongs to (a contact pair)
  std::array<double, 3> place{};
  bool operator<(const FlippingPoint& other) const { return std::tie(place, name) < std::tie(other.place, other.name); }
};

class StatusWatch {
 public:
  static constexpr std::size_t most_looks = 13; // remembered: one more than the longest cycle

  explicit StatusWatch(const Problem& problem);

  /// Does any form have branches? Without any, look() costs nothing.
  bool has_points() const { return num_points_ > 0; }
  void clear() { seen_.clear(); }

  struct Look {
    std::uint64_t pattern; // the same on every rank
    double changed;        // part of all points that has another branch than at the last look; 0 at the first
  };
  /// Takes the branches of the last residual. Collective.
  Look look();

  /// Marks the points of this rank, form by form, that have not been on one and the same branch, or not been
  /// only off or only on, over the last `looks` looks.
  enum class Flip { Branch, OffOn };
  std::vector<std::vector<std::uint8_t>> flipping(std::size_t looks, Flip flip) const;
  /// The first `most` of the marked points by their place, and how many there are on all ranks. Collective.
  struct Named {
    std::int64_t count = 0;
    std::vector<FlippingPoint> first;
  };
  Named name(const std::vector<std::vector<std::uint8_t>>& marks, std::size_t most) const;

 private:
  using Branches = std::vector<std::vector<std::uint8_t>>; // [form][point of this rank]

  const Problem& problem_;
  std::vector<Switching*> forms_;
  std::int64_t num_points_ = 0;
  std::deque<Branches> seen_; // the last looks
};

} // namespace amontons
