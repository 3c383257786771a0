// Calls that a render makes besides rendering: they tell how far it is, and hand out pictures and states on its way.
#pragma once

#include <cstdint>
#include <functional>

#include "host/film/error.h"
#include "host/picture/picture.h"

namespace wavepath {

struct RenderState; // host/render/loop/render_state.h

struct Progress {
  std::uint32_t spp_done = 0, spp_planned = 0;
  double fraction = 0.0; // of the samples planned
  double seconds = 0.0;  // rendering so far
  double mrays_per_second = 0.0;
  ErrorEstimate error; // zero until known
  double slope = -0.5; // of log error against log time so far
};

// Called after every wave (at most about every 100 ms); return false to stop with what there is.
using ProgressCallback = std::function<bool(const Progress&)>;

// Calls that a render makes besides rendering. None of them counts as rendering time.
struct RenderHooks {
  ProgressCallback progress{};
  // At every checkpoint, with the picture so far.
  std::function<void(const Checkpoint&, const Picture&)> checkpoint{};
  // Soon after the first samples, then every second or more seldom, so that it takes a twentieth of the time at most;
  // with the picture so far; on several devices, after every round.
  std::function<void(const Picture&)> show{};
  // About every save_interval seconds and at the end, with all that a later render needs to go on from there.
  std::function<void(const RenderState&)> save{};
  double save_interval = 30.0;
  bool salvages = false; // a device that is lost ends the render with what there is, instead of by DeviceLost
  const RenderState* resume = nullptr; // goes on from there; of the same scene, view and settings
};

} // namespace wavepath
