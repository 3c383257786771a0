// Radiosity as an integrator.
#pragma once

#include "host/render/settings/integrator_kind.h"

namespace wavepath {

// Diffuse light of all bounces between patches of the scene's surfaces (Goral et al. 1984; Cohen et al. 1988).
extern const IntegratorKind kRadiosity;

} // namespace wavepath
