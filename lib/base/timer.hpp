// Where the time and the memory of a run go: wall-clock seconds per named phase, nested phases counted once (a phase's
// own time), and by how much the peak of memory rose in each.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace amontons {

/// Phase times of this process. One instance lives for a run; phases open and close like scopes. Opening an inner phase
/// stops the outer one's clock, so the figures add up to the total.
class PhaseTimer {
 public:
  class Scope {
   public:
    Scope(PhaseTimer& timer, const char* phase);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    PhaseTimer& timer_;
  };

  const std::map<std::string, double>& seconds() const { return seconds_; }
  /// Bytes by which the largest resident memory of this process rose while the phase was on; their sum is the peak but
  /// for what was there before the first phase. A phase that uses again what another has freed counts as nothing.
  const std::map<std::string, double>& memory_growth() const { return growth_; }
  static PhaseTimer& of_run();

 private:
  void switch_clock();
  std::map<std::string, double> seconds_, growth_;
  std::vector<std::string> open_;
  double since_ = 0.0, peak_ = 0.0;
};

/// Times the enclosing scope as `phase` of the run.
class Phase : public PhaseTimer::Scope {
 public:
  explicit Phase(const char* phase) : Scope(PhaseTimer::of_run(), phase) {}
};

/// Seconds of CPU time used by this process, and the largest resident memory so far in bytes.
double cpu_seconds();
double peak_memory();

} // namespace amontons
