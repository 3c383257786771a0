// Callbacks of a render: progress, pictures and states on its way.
#pragma once

#include <cstdint>
#include <functional>

#include "host/film/error.h"
#include "host/picture/picture.h"

namespace wavepath {

struct RenderResult; // host/render/loop/render_result.h
struct RenderState;  // host/render/loop/render_state.h

struct Progress {
  std::uint32_t spp_done = 0, spp_planned = 0;
  double fraction = 0.0; // of the planned samples that are done
  double seconds = 0.0;  // of rendering so far
  double mrays_per_second = 0.0;
  ErrorEstimate error; // zero until known
  double slope = -0.5; // d log(error) / d log(time), fitted to the checkpoints so far
};

// Called after waves, at most about every 100 ms. Returns false to stop the render with what it has.
using ProgressCallback = std::function<bool(const Progress&)>;

// Callbacks of a render. Their time does not count as rendering.
struct RenderHooks {
  ProgressCallback progress{};
  // Called at every checkpoint with the picture so far.
  std::function<void(const Checkpoint&, const Picture&)> checkpoint{};
  // Called with the picture so far: soon after the first samples, then every second or more seldom, so that it takes at
  // most a twentieth of the time. On several devices, called after every round.
  std::function<void(const Picture&)> show{};
  // Called about every save_interval seconds and at the end, with everything that a later render needs to continue.
  std::function<void(const RenderState&)> save{};
  double save_interval = 30.0;
  // Called about every publish_interval seconds, when all pixels have the same samples; with several devices, after a
  // round. The argument is what an interrupt would give at this moment.
  std::function<void(const RenderResult&)> publish{};
  double publish_interval = 0.0;
  bool salvages = false; // true: after a lost device the render ends with what it has; false: it throws DeviceLost
  const RenderState* resume = nullptr; // state to continue from, of the same scene, view and settings; null = begin
};

} // namespace wavepath
