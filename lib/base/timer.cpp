#include "base/timer.hpp"

#include <chrono>
#include <sys/resource.h>

namespace amontons {

namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

} // namespace

PhaseTimer& PhaseTimer::of_run() {
  static PhaseTimer timer;
  return timer;
}

void PhaseTimer::switch_clock() {
  const double time = now();
  const double peak = peak_memory();
  if (!open_.empty()) {
    seconds_[open_.back()] += time - since_;
    if (peak > peak_) growth_[open_.back()] += peak - peak_;
  }
  since_ = time;
  peak_ = peak;
}

PhaseTimer::Scope::Scope(PhaseTimer& timer, const char* phase) : timer_(timer) {
  timer_.switch_clock();
  timer_.open_.emplace_back(phase);
}

PhaseTimer::Scope::~Scope() {
  timer_.switch_clock();
  timer_.open_.pop_back();
}

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * double(usage.ru_maxrss);
}

} // namespace amontons
