// The largest of many numbers and where it was found, across ranks. For lib/accuracy only.
#pragma once

#include <array>
#include <mpi.h>
#include <span>
#include <string>

namespace amontons::accuracy {

/// Stands for infinity and for what is not a number.
constexpr double no_value = 1e300;

/// The largest value offered on this rank.
struct Worst {
  double value = 0.0;
  std::string where;

  /// `describe` is called only when the value is the largest so far. What is not a number is larger than any number.
  template <class Describe>
  void offer(double candidate, Describe&& describe) {
    if (!(candidate <= no_value)) candidate = no_value;
    if (candidate <= value) return;
    value = candidate;
    where = describe();
  }
};

/// The largest over all ranks, on every rank. Collective.
Worst over_ranks(MPI_Comm comm, Worst mine);

/// "(1, 2.5)".
std::string place_text(std::span<const double> place);

} // namespace amontons::accuracy
