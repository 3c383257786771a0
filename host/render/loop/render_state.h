// State of a render: enough to go on from there as if it had never stopped.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host/film/error.h"
#include "host/film/film.h"
#include "host/render/loop/render_result.h"
#include "host/render/settings/render_plan.h"
#include "host/render/workspace/totals.h"

namespace wavepath {

// A pass gives every pixel the same samples. `segment` and `pixels_done` say how far the one in progress is.
struct RenderCursor {
  std::uint32_t sample = 0;       // the first that the pass in progress adds
  std::uint32_t pass_samples = 0; // of that pass; 0 = none is in progress
  std::uint32_t segment = 0, pixels_done = 0;
};

struct RenderState {
  RenderCursor cursor;
  std::uint32_t first_sample = 0; // the first that it holds
  double seconds = 0.0, estimate_seconds = 0.0;
  std::vector<StageTime> stages;
  RayCounts rays;
  Nonfinite nonfinite;
  std::vector<Checkpoint> checkpoints;
  std::vector<std::int8_t> levels; // of an adaptive render, see adaptive.h
  std::optional<NoisePilot> noise; // of which they come, or that nothing is shared out
  std::uint32_t next_check = 0;    // sample at which to look at the error next; 0 = at checkpoints only
  Film film;
};

} // namespace wavepath
