// Measures the fraction of the light that --max-depth cuts off.
#pragma once

#include "host/render/render.h"

namespace wavepath {

struct DepthCut {
  double fraction = 0.0;       // missing light over all light
  double standard_error = 0.0; // standard error of `fraction`
  std::uint32_t deeper = 0;    // depth limit of the deeper of the two pilots
};

// Renders a pilot twice with the same random numbers: with the depth of `settings`, and deeper. Paths are equal up to
// the cut, so the difference is the light beyond it, with next to no noise. Uses kernels that are compiled already.
// `progress` may stop it. Throws Error if it is stopped or the device fails.
DepthCut measure_depth_cut(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                           KernelCompiler& kernels, SceneOnDevice& shared, const ProgressCallback& progress = {});

} // namespace wavepath
