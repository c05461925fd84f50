// Rigid motions that a tangent does not resist: the bodies that nothing holds, named with the direction they can go.
#pragma once

#include "form/problem.hpp"

#include <string>
#include <vector>

namespace amontons {

/// What one body takes part in.
struct FreeMotion {
  std::string body;
  std::string direction; // "along x", "about z", or "(several directions at once)"
};

/// Applies the rigid motions r of each body to the tangent: those combinations are free whose rᵀ K r is zero against
/// rᵀ diag(K) r, but for the small stiffness of SupportForm. Motions along and about the coordinate axes are named as
/// such when the free ones contain them. dim (dim + 1) / 2 products with the matrix a body: for when something has gone
/// wrong. The same on every rank. Collective.
std::vector<FreeMotion> find_free_motions(const Problem& problem, Mat tangent);

} // namespace amontons
