// No anti-aliasing: what lies in the middle of a pixel is the pixel.
#include "host/integrators/hybrid/antialias/kinds.h"

namespace wavepath {

constinit const AntialiasKind kAntialiasNone = {
    .name = "none", .summary = "pixels seen at their centres alone", .position = pixel_centre};

} // namespace wavepath
