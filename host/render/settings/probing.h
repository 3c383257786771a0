// Whether a render has error probes.
#pragma once

#include "host/render/settings/render_plan.h"

namespace wavepath {

// False: samples of every pixel are split between two replicates, whose difference measures the error of the pixel.
// True: all samples of a pixel are in one replicate, and one pixel of each block has a second one, an error probe
// (kernels/base/error_probes.h). Probes need a picture that is large enough for an error measured on so few pixels, and
// an integrator whose samples of a pixel stand for themselves. They do not tell the variance of every single pixel.
bool has_error_probes(const RenderPlan& settings);

} // namespace wavepath
