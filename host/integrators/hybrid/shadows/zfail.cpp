// Shadow volumes counted behind what is seen, where they have caps (Everitt and Kilgard 2002): right wherever the eye
// is, and for open meshes too (Kim et al. 2008).
#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/shadow_volumes.h"

namespace wavepath {

constinit const ShadowKind kShadowZfail = {
    .name = "zfail",
    .summary =
        "shadow volumes with caps, counted behind what is seen (Everitt and Kilgard 2002), in which alpha counts "
        "only where a whole triangle is hole",
    .sources = kPunctualSources,
    .program = &kVolumeProgram,
    .make = [](const ShadowContext& context) { return make_shadow_volumes(context, VolumeCount::behind); },
};

} // namespace wavepath
