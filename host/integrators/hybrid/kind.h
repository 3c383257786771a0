// Hybrid rendering and ambient occlusion as integrators.
#pragma once

#include "host/render/integrator.h"

namespace wavepath {

// A rasterized first hit, traced direct light, and an ambient term, dimmed by traced ambient occlusion, for all further
// bounces.
extern const IntegratorKind kHybrid;
// That occlusion alone, as a picture of the unoccluded share.
extern const IntegratorKind kAo;

// Metres from which on nothing occludes; 0 = unlimited. What settings.ao_radius says, or what is usual.
double occlusion_radius(const PackedScene& scene, const RenderSettings& settings);

} // namespace wavepath
