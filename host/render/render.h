// Renders a scene: takes settings, returns a picture and what it cost. The loop itself is render_loop.h.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/film/error.h"
#include "host/film/picture.h"
#include "host/render/nonfinite.h"
#include "host/render/settings.h"

namespace wavepath {

class Device;
class KernelCompiler; // host/render/kernel_compiler.h
struct PackedScene;
struct RenderState; // host/render/render_state.h
struct View;        // host/scene/view.h: the resolved camera

// Seconds on the device by kernel, and how often it was dispatched.
struct StageTime {
  std::string name;
  double seconds = 0.0;
  std::uint64_t dispatches = 0;
};

struct MemoryUse { // bytes on the device
  std::uint64_t scene = 0, bvh = 0, paths = 0, film = 0;
  std::uint64_t total() const { return scene + bvh + paths + film; }
};

enum class StopReason { samples, time, target_error, interrupted };

struct RenderResult {
  Picture picture;
  std::shared_ptr<const Film> film; // the exact sums that it was developed from
  std::uint32_t spp = 0;            // samples a pixel that the picture holds
  StopReason stop = StopReason::samples;
  double compile_seconds = 0.0; // of the kernels it began with; loading may have gone on meanwhile
  double upload_seconds = 0.0;
  double seconds = 0.0, gpu_seconds = 0.0; // rendering alone
  double first_pixel_seconds = 0.0;        // from the start of the process until every pixel had its first sample
  RayCounts rays;
  ErrorEstimate error;
  double slope = -0.5;           // of log error against log time, fitted over the last checkpoints
  double estimate_seconds = 0.0; // that reading the film back and estimating its error took, besides `seconds`
  bool even = true; // every pixel holds exactly its samples up to spp; false where the render was stopped within a pass
  std::vector<Checkpoint> checkpoints;
  std::vector<StageTime> stages;
  MemoryUse memory;
  Nonfinite nonfinite;
  glm::vec3 ambient{0.0f}; // radiance that a hybrid render used
};

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

// What a render does besides rendering. None of it counts as rendering time.
struct RenderHooks {
  ProgressCallback progress{};
  // At every checkpoint, with the picture so far.
  std::function<void(const Checkpoint&, const Picture&)> checkpoint{};
  // About every save_interval seconds and at the end, with all that a later render needs to go on from there.
  std::function<void(const RenderState&)> save{};
  double save_interval = 30.0;
  const RenderState* resume = nullptr; // goes on from there; of the same scene, view and settings
};

// Renders `scene` as seen by `view`. Throws Error if the device cannot hold it or fails. The result depends on the
// device, the scene, the view and the settings alone, not on wave_slots or timing (save where time_limit or
// target_error ends it), nor on how often it was stopped and resumed.
RenderResult render(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
                    const ProgressCallback& progress = {});

// The same with kernels that may have been begun before the scene was known.
RenderResult render(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
                    const RenderHooks& hooks, KernelCompiler& kernels);

} // namespace wavepath
