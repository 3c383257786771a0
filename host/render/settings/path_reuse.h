// Whether neighbouring pixels share the light that their paths find (kernels/path/reuse.glsl).
#pragma once

#include "host/render/settings/render_plan.h"

namespace wavepath {

// Whether a render with these settings can. Not where directions are drawn otherwise than by the cosine, where paths of
// neighbours see the scene at other times, or where no path scatters twice.
bool may_reuse_paths(const RenderPlan& settings);

// Whether it does: auto does once a pilot has found that it pays, which makes it on.
bool reuses_paths(const RenderPlan& settings);

// Whether kernels for a scene of these kFeature bits are to support both, since pilots try it
// (KernelCapacity::reuse).
bool tries_reuse(const RenderPlan& settings, gpu::Feature scene);

} // namespace wavepath
