// State of a render: everything needed to continue it as if it had never stopped.
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

// Position within the render. A pass gives every pixel the same samples; `segment` and `pixels_done` locate the next
// wave of the pass in progress.
struct RenderCursor {
  std::uint32_t sample = 0;       // first sample of the pass in progress
  std::uint32_t pass_samples = 0; // samples of that pass; 0 = no pass is in progress
  std::uint32_t segment = 0, pixels_done = 0;
};

struct RenderState {
  RenderCursor cursor;
  std::uint32_t first_sample = 0; // first sample of the film
  double seconds = 0.0, estimate_seconds = 0.0;
  std::vector<StageTime> stages;
  RayCounts rays;
  Nonfinite nonfinite;
  std::vector<Checkpoint> checkpoints;
  std::vector<std::int8_t> levels; // levels of an adaptive render (adaptive.h); empty without
  std::optional<NoisePilot> noise; // report of the pilot that chose `levels`, or that chose even samples
  std::uint32_t next_check = 0;    // sample at which to check the error next (target.h); 0 = at checkpoints only
  Film film;
};

} // namespace wavepath
