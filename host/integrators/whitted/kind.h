// Whitted's ray tracer as an integrator.
#pragma once

#include "host/render/settings/integrator_kind.h"

namespace wavepath {

// Camera rays, a shadow ray to every light (to 16 of more emissive triangles), mirror and glass branches, an ambient
// term (Whitted 1980).
extern const IntegratorKind kWhitted;

} // namespace wavepath
