// Decides whether frames look textures up at mip levels.
#pragma once

#include "host/render/settings/render_plan.h"

namespace wavepath {

// True if a render uses mip levels (--mips). One sample a pixel cannot average the texels that the pixel covers. So a
// render of one sample, or a frame of a moving camera, uses mip levels. Several samples average by themselves without
// bias, and look textures up exactly.
bool uses_mips(const RenderPlan& settings);

// True if kernels and scene must have mip levels: for this render, or for another one in the same window.
bool wants_mips(const RenderPlan& settings);

} // namespace wavepath
