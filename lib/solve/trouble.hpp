// Why a solve did not converge, as plain data and in words: what went on in the iterations, which points and bodies,
// the likely cause and what to do.
#pragma once

#include "solve/free_motions.hpp"
#include "solve/status_watch.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace amontons {

struct Trouble {
  std::string solver;                // what SNES says
  int cycle = 0;                     // length of the cycle of branches, 0: none
  bool rests = false;                // the residual stays where it is with the branches at rest
  double residual = 0.0;             // relative to the forces in play
  double largest_change = 0.0;       // part of the points that changed their branch in one iteration near the end
  std::int64_t num_flipping = 0;     // points that flip, on all ranks,
  std::vector<FlippingPoint> points; // and the first few of them
  std::vector<FreeMotion> free;      // bodies that the last tangent did not hold
};

/// Part of all points from which a change in one iteration counts as too many at once.
constexpr double too_many_at_once = 0.25;

/// One or more sentences without a full stop at the end, joined by semicolons.
std::string in_words(const Trouble& trouble);

} // namespace amontons
