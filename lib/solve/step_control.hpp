// Which time comes next: equal or automatic increments, smaller after a failure, larger again when Newton finds it
// easy. Pure logic, the same on every rank.
#pragma once

#include <vector>

namespace amontons {

struct StepPlan {
  double begin = 0.0, end = 1.0;
  int equal_increments = 1; // 0: automatic
  double first = 0.1;       // automatic: fractions of the step
  double smallest = 1e-4;   // below this fraction (for equal increments: of one increment) the run gives up
  double largest = 1.0;
  int target_iterations = 8; // automatic: Newton iterations at which the increment stays as it is
};

class StepControl {
 public:
  /// `now`: where in the step to start, begin or the time of a restart; `increment` overrides the first one if
  /// positive.
  StepControl(const StepPlan& plan, double now, double increment = 0.0);

  bool finished() const { return next_stop_ >= stops_.size(); }
  /// The end of the increment to try; not when finished(), nor accepted() and rejected().
  double target() const;
  /// The increment to target() was solved in this many Newton iterations; the next one is at most `limit` times as
  /// long.
  void accepted(int newton_iterations, double limit = 2.0);
  /// It was not: tries half of it next. False when the increment is too small to go on.
  [[nodiscard]] bool rejected();
  /// It was, but a shorter one is wanted: tries `factor` of it next, not less than the smallest. False, and nothing
  /// changes, when it is at the smallest already.
  [[nodiscard]] bool shortened(double factor);
  double now() const { return now_; }
  double increment() const { return increment_; }

 private:
  StepPlan plan_;
  std::vector<double> stops_; // times to land on exactly
  std::size_t next_stop_ = 0;
  double now_, increment_, smallest_, largest_;
};

} // namespace amontons
