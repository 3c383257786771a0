// Whether the pixels of a render keep their nets of samples whole.
#pragma once

#include "host/render/settings/render_plan.h"

namespace wavepath {

// False: halved nets, two to a pixel, whose difference measures the error of every pixel. True: whole nets, and a
// second one on one pixel of each block (kernels/base/error_probes.h). That takes a picture large enough for an error
// that is measured on so few, and an integrator whose samples of a pixel stand for themselves; the variance of every
// single pixel is not known then.
bool has_error_probes(const RenderPlan& settings);

} // namespace wavepath
