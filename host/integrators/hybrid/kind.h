// Hybrid rendering and ambient occlusion as integrators.
#pragma once

#include "host/render/settings/integrator_kind.h"

namespace wavepath {

// Rasterized or traced first hits, traced direct light, and an ambient term for further bounces, dimmed by traced
// ambient occlusion.
extern const IntegratorKind kHybrid;
// The occlusion alone, as a picture of the unoccluded fraction.
extern const IntegratorKind kAo;

} // namespace wavepath
