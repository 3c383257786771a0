// Fast approximate anti-aliasing (Lottes 2009).
#include <array>

#include "host/integrators/hybrid/antialias/kinds.h"
#include "kernels/hybrid/antialias/fxaa.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kFxaaPasses = {{{"fxaa", wavepath_fxaa_spv}}};

} // namespace

const AntialiasKind kAntialiasFxaa = {.name = "fxaa",
                                      .summary = "edges blurred along their contrast (FXAA, Lottes 2009)",
                                      .position = pixel_centre,
                                      .passes = kFxaaPasses};

} // namespace wavepath
