// Whole frames through all kernels, timed: what the kernels make of each other.
#pragma once

#include <vector>

#include "host/integrators/path/path_tracer.h"

namespace wavepath {

struct FrameTime {
  double seconds = 0.0; // wall
  std::vector<StageTime> stages;
  RayCounts rays;
};

// Renders samples [0, spp) of every pixel onto an empty film.
FrameTime render_frame(PathTracer& tracer, std::uint32_t spp);

// Samples a pixel that take about a third of a second, from 1 up to 64.
std::uint32_t choose_frame_spp(PathTracer& tracer);

} // namespace wavepath
