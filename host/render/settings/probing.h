// Decides whether a render estimates its error by error probes.
#pragma once

#include "host/render/settings/render_plan.h"

namespace wavepath {

// False: the samples of every pixel are split between two replicates, whose difference measures the pixel's error.
// True: all samples of a pixel are in one replicate, and one pixel of each block has a second replicate, the error
// probe (kernels/base/error_probes.h). That needs a picture large enough that few probed pixels suffice, and an
// integrator whose samples do not depend on other pixels. It gives no variance of every single pixel.
bool has_error_probes(const RenderPlan& settings);

} // namespace wavepath
