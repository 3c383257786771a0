// The clock that all durations are measured with: it never runs backwards.
#pragma once

#include <chrono>

namespace wavepath {

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

} // namespace wavepath
