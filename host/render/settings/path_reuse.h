// Decides whether neighbouring pixels reuse each other's paths (kernels/path/reuse.glsl).
#pragma once

#include "host/render/settings/render_plan.h"

namespace wavepath {

// True if a render with these settings can reuse paths. It cannot if directions are not drawn by the cosine, if
// neighbouring paths see the scene at different times, if no path scatters twice, or with groups of lights: light that
// neighbours found is not told apart.
bool may_reuse_paths(const RenderPlan& settings);

// True if the render reuses paths: --reuse on. The plan has replaced `auto` by `on` or `off`.
bool reuses_paths(const RenderPlan& settings);

// True if kernels for a scene of these kFeature bits must support both modes, since a pilot compares them
// (KernelCapacity::reuse).
bool tries_reuse(const RenderPlan& settings, gpu::Feature scene);
// Whether they support it for either reason.
bool kernels_reuse_paths(const RenderPlan& settings, gpu::Feature scene);

} // namespace wavepath
