// Follows the branches of all switching forms from iterate to iterate: a fingerprint for each, and which points flip.
#pragma once

#include "form/switching.hpp"

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <mpi.h>
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

/// Points of this rank that are followed, of one kind: what they belong to, the branch of each as of the last residual
/// (0: off), in an order and number that do not change while they are watched, and where they are.
struct WatchedPoints {
  std::string name;
  std::function<std::vector<std::uint8_t>()> branches;
  std::function<std::array<double, 3>(std::size_t point)> place;
};
/// Of forms that outlive what is returned.
std::vector<WatchedPoints> watched(const std::vector<Switching*>& forms);

class StatusWatch {
 public:
  static constexpr std::size_t most_looks = 13; // remembered: one more than the longest cycle

  /// Collective.
  StatusWatch(MPI_Comm comm, std::vector<WatchedPoints> forms);

  /// Are there any points? Without any, look() costs nothing.
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

  MPI_Comm comm_;
  std::vector<WatchedPoints> forms_;
  std::int64_t num_points_ = 0;
  std::deque<Branches> seen_; // the last looks
};

} // namespace amontons
