// Work that the device has done for a render: rays, seconds by stage, non-finite samples.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/film/error.h"
#include "host/render/workspace/nonfinite.h"

namespace wavepath {

// Seconds on the device and number of dispatches of a stage.
struct StageTime {
  std::string name;
  double seconds = 0.0;
  std::uint64_t dispatches = 0;
};

// Totals of all work so far.
struct Totals {
  RayCounts rays;
  Nonfinite nonfinite;
  std::vector<StageTime> stages;
  double busy_seconds = 0.0; // time that the device was busy, as far as the host can tell
};

} // namespace wavepath
