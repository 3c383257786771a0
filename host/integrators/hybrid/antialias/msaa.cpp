// Multisampling (Akeley 1993): visibility at four places of a pixel, shading once a pixel and triangle, at the centre
// of the pixel, even where the triangle does not cover that.
#include "host/integrators/hybrid/antialias/grid.h"
#include "host/integrators/hybrid/antialias/kinds.h"
#include "kernels/hybrid/hybrid_types.h"

namespace wavepath {

constinit const AntialiasKind kAntialiasMsaa = {
    .name = "msaa",
    .summary = "four places in the pixel, which share shading where they see one triangle",
    .place = [](std::uint32_t sample, std::uint32_t) { return place_in_grid(sample % gpu::kSharingPlaces, 2); },
    .shares_shading = true};

} // namespace wavepath
