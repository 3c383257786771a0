// The pixel filter (--filter), importance-sampled: each frame sees all pixels at another position.
#include "host/integrators/hybrid/antialias/kinds.h"

namespace wavepath {

constinit const AntialiasKind kAntialiasFilter = {
    .name = "filter", .summary = "the pixel filter, over all samples", .is_biased = false};

} // namespace wavepath
