// Seconds that pass on the wall, for what runs say of their own cost.
#pragma once

#include <chrono>

namespace amontons {

/// Since an arbitrary moment that is the same all run.
inline double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

} // namespace amontons
