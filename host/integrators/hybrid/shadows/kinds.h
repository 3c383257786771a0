// The shadow techniques there are, in the order of --shadows. Each is a constant of this folder, in a file of its own:
// kShadowMapId in map_id.cpp. Those that average over a map share filterable.cpp.
#pragma once

#include "host/integrators/hybrid/shadows/technique.h"
#include "host/render/settings/registry.h"

namespace wavepath {

WAVEPATH_ROWS(ShadowKind, kShadowKinds, kShadowMap, kShadowMapId, kShadowPcf, kShadowPcss, kShadowVsm, kShadowEsm,
              kShadowEvsm, kShadowMoment, kShadowVssm, kShadowAverage, kShadowLeak, kShadowCascades, kShadowSdsm,
              kShadowLispsm, kShadowTsm, kShadowPsm, kShadowCube, kShadowParaboloid, kShadowVirtual, kShadowIzb,
              kShadowPlanar, kShadowLightmap, kShadowProjected, kShadowZpass, kShadowZfail, kShadowCones);

} // namespace wavepath
