// Short measurements on devices that are slow at first when they were idle, as GPUs are.
#pragma once

#include "host/base/clock.h"
#include "host/gpu/device_info.h"

namespace wavepath {

// Seconds that `measure` returned: on a CPU once, elsewhere in the last of as many rounds as keep the
// device busy until it has clocked up.
template <class Measure>
double seconds_when_warm(const DeviceInfo& info, const Measure& measure) {
  constexpr double kUntilAwake = 0.1; // seconds
  const Clock::time_point start = Clock::now();
  double seconds = measure();
  while (info.type != "cpu" && seconds_since(start) < kUntilAwake) seconds = measure();
  return seconds;
}

} // namespace wavepath
