// What the device has done for a render: rays, seconds by stage, samples that were not finite.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/film/error.h"
#include "host/render/workspace/nonfinite.h"

namespace wavepath {

// Seconds on the device by kernel, and how often it was dispatched.
struct StageTime {
  std::string name;
  double seconds = 0.0;
  std::uint64_t dispatches = 0;
};

// What all work so far came to.
struct Totals {
  RayCounts rays;
  Nonfinite nonfinite;
  std::vector<StageTime> stages;
  double busy_seconds = 0.0; // that the device was busy, as far as the host can tell
};

} // namespace wavepath
