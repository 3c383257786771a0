// Hybrid rendering and ambient occlusion as integrators.
#pragma once

#include "host/render/settings/integrator_kind.h"

namespace wavepath {

// First hits, rasterized or traced, traced direct light, and an ambient term, dimmed by traced ambient occlusion, for
// all further bounces.
extern const IntegratorKind kHybrid;
// That occlusion alone, as a picture of the unoccluded fraction.
extern const IntegratorKind kAo;

} // namespace wavepath
