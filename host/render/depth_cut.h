// What --max-depth costs: the fraction of the light that longer paths would have found.
#pragma once

#include "host/render/render.h"

namespace wavepath {

struct DepthCut {
  double fraction = 0.0;       // of all light, missing
  double standard_error = 0.0; // of that
  std::uint32_t deeper = 0;    // bounces up to which it was measured
};

// Renders a pilot twice, with the depth of `settings` and with a larger one, by the same random numbers: the
// paths are the same up to the cut, so that the difference is all that lies behind it and nearly free of noise. Uses
// the kernels that are there. `progress` may end it: then, and where the device fails, it throws Error.
DepthCut measure_depth_cut(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                           KernelCompiler& kernels, SceneOnDevice& shared, const ProgressCallback& progress = {});

} // namespace wavepath
