// Whether frames look textures up at mip levels.
#pragma once

#include "host/render/settings/render_plan.h"

namespace wavepath {

// --mips, of an integrator that supports it: one sample a pixel cannot average the texels that the pixel covers, so
// that a render of one, or a frame of a camera in motion, has levels do it. More samples average by themselves, and
// find the truth; they look textures up exactly.
bool uses_mips(const RenderPlan& settings);

// Whether kernels and scene are to have mip levels: that render uses them, or others of the same window.
bool wants_mips(const RenderPlan& settings);

} // namespace wavepath
