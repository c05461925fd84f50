#include "solve/step_control.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

StepControl::StepControl(const StepPlan& plan, double now, double increment) : plan_(plan), now_(now) {
  const double length = plan.end - plan.begin;
  const int stops = std::max(1, plan.equal_increments);
  for (int i = 1; i <= stops; ++i)
    stops_.push_back(i == stops ? plan.end : plan.begin + length * i / stops);
  const double scale = plan.equal_increments > 0 ? length / stops : length;
  smallest_ = plan.smallest * scale;
  largest_ = plan.equal_increments > 0 ? scale : plan.largest * length;
  increment_ = plan.equal_increments > 0 ? scale : plan.first * length;
  if (increment > 0.0) increment_ = std::clamp(increment, smallest_, largest_);
  while (!finished() && stops_[next_stop_] <= now_ + 1e-12 * length)
    ++next_stop_;
}

double StepControl::target() const {
  const double stop = stops_[next_stop_];
  const double left = stop - now_;
  // No tiny last increment: what is left is taken whole or in two halves.
  if (increment_ >= left * (1.0 - 1e-9)) return stop;
  if (2.0 * increment_ > left) return now_ + 0.5 * left;
  return now_ + increment_;
}

void StepControl::accepted(int newton_iterations, double limit) {
  const double reached = target();
  const double taken = reached - now_;
  now_ = reached;
  if (reached >= stops_[next_stop_]) ++next_stop_;
  double factor = 2.0; // equal increments: back to the nominal size after a cutback
  if (plan_.equal_increments == 0) {
    const double ratio = static_cast<double>(plan_.target_iterations) / std::max(1, newton_iterations);
    factor = std::clamp(std::sqrt(ratio), 0.5, 2.0);
  }
  factor = std::min(factor, limit);
  // A short increment that only landed on a stop does not shrink the next one.
  increment_ = std::clamp(std::max(taken * factor, std::min(increment_, increment_ * factor)), smallest_, largest_);
}

bool StepControl::rejected() {
  increment_ = 0.5 * (target() - now_);
  return increment_ >= smallest_;
}

bool StepControl::shortened(double factor) {
  const double tried = target() - now_;
  if (tried <= smallest_ * (1.0 + 1e-9)) return false;
  increment_ = std::max(factor * tried, smallest_);
  return true;
}

} // namespace amontons
