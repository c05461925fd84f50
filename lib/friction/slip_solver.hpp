// The scalar equation of sliding: which slip s makes the trial traction, relieved by ε s, meet the law's limit.
#pragma once

#include "friction/friction_law.hpp"

namespace amontons {

/// F(s) = r − ε s − τ(p, s), with r = |q| >= 0 the size of the trial traction and ε > 0, stress per length.
struct SlipEquation {
  const FrictionLaw& law;
  const FrictionContext& context;
  double p, r, epsilon;
  const FrictionState& state_old;

  FrictionLimit limit(double s) const { return friction_limit(law, context, p, s, state_old); }
  /// No slip is larger: F <= 0 there, since τ >= 0.
  double largest_slip() const { return r / epsilon; }
};

struct SlipSolution {
  double s = 0.0;
  FrictionLimit limit; // at s
  /// Another slip in 0 < s <= r / ε solves the equation too. Only possible when the law weakens faster than ε.
  bool is_several = false;
};

/// s = 0 if r <= τ(p, 0) (stick), else the smallest s > 0 with F(s) = 0. A solution exists because F(r / ε) <= 0.
///
/// A law that nowhere weakens faster than ε makes F monotone: one solution, bracketed by 0 and r / ε. Otherwise F is
/// looked at from s = 0 upwards on cells that double in size, and in each cell also at the minimum or maximum that its
/// end slopes announce; the first change of sign is taken. The root is then found by Newton's method kept inside the
/// bracket, in s or in ln s, to rounding: |F| <= 1e-15 r or neighbouring numbers.
SlipSolution solve_slip(const SlipEquation& equation);

} // namespace amontons
