// Short measurements on devices that are slow at first when they were idle, as GPUs are.
#pragma once

#include <cstdint>

#include "host/gpu/device_info.h"

namespace wavepath {

// Rounds of a measurement that is short.
inline std::uint32_t rounds_to_warm(const DeviceInfo& info) { return info.type == "cpu" ? 1 : 8; }

// What the last round of `measure`, which returns seconds, took.
template <class Measure>
double seconds_when_warm(const DeviceInfo& info, const Measure& measure) {
  constexpr double kShort = 0.02;
  double seconds = measure();
  for (std::uint32_t round = 1; round < rounds_to_warm(info) && seconds < kShort; ++round) seconds = measure();
  return seconds;
}

} // namespace wavepath
