// Shadow volumes counted between the eye and what it sees (Crow 1977; in a stencil buffer Heidmann 1991): false where
// the eye itself is in shadow.
#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/shadow_volumes.h"
#include "host/integrators/hybrid/shadows/volume_pieces.h"

namespace wavepath {

constinit const ShadowKind kShadowZpass = {
    .name = "zpass",
    .summary =
        "shadow volumes of closed meshes, counted up to what is seen (Crow 1977): alpha counts only where a "
        "whole triangle is hole, and the eye is in no shadow",
    .sources = kPunctualSources,
    .program = &kVolumeProgram,
    .make = [](const ShadowContext& context) { return make_shadow_volumes(context, VolumeCount::in_front); },
    .refusal = open_mesh,
};

} // namespace wavepath
