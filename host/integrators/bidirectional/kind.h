// Bidirectional path tracing as an integrator.
#pragma once

#include "host/render/settings/integrator_kind.h"

namespace wavepath {

// Paths from the camera and from the lights, joined in every way, each weighted against all others (Veach 1997).
extern const IntegratorKind kBidirectional;

} // namespace wavepath
