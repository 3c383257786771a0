// Temporal anti-aliasing (Karis 2014): the filter is host/integrators/hybrid/taa.h, which windows use in motion as
// well.
#include "host/integrators/hybrid/antialias/kinds.h"

namespace wavepath {

constinit const AntialiasKind kAntialiasTaa = {
    .name = "taa", .summary = "frames joined to those before them (TAA, Karis 2014)", .over_time = true};

} // namespace wavepath
