// Screen-door transparency: surfaces have holes in a fixed pattern of pixels, as many as their opacity leaves open.
// Surfaces of one opacity have the same holes, and hide each other.
#include "host/integrators/hybrid/transparency/kinds.h"
#include "kernels/hybrid/hybrid_types.h"

namespace wavepath {

constinit const TransparencyKind kTransparencyScreendoor = {
    .name = "screendoor",
    .summary = "seen through holes in an ordered pattern of 8x8 pixels (Bayer 1973)",
    .flag = gpu::kHybridScreendoor,
};

} // namespace wavepath
