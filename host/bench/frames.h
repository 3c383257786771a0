// Times whole renders, made as `render` makes them.
#pragma once

#include <memory>
#include <vector>

#include "host/render/loop/render_loop.h"
#include "host/render/workspace/kernel_compiler.h"

namespace wavepath {

// A render loop that is begun again and again, its kernels compiled and its scene uploaded.
struct WarmLoop {
  std::unique_ptr<KernelCompiler> kernels;
  std::unique_ptr<RenderLoop> loop;
  View view;
  double compile_seconds = 0.0;
};

WarmLoop make_loop(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings);

struct RenderTime {
  double seconds = 0.0; // wall
  std::vector<StageTime> stages;
  RayCounts rays;
};

// Renders `spp` samples of every pixel and takes the time. What was on the film is lost.
RenderTime time_render(WarmLoop& warm, std::uint32_t spp);

// The samples a pixel of a render that takes long enough for the clock.
std::uint32_t choose_spp(WarmLoop& warm);

} // namespace wavepath
