// The techniques there are, one constant a file of this folder.
#pragma once

#include "host/integrators/shadows/technique.h"

namespace wavepath {

extern const ShadowKind kShadowMap;   // map.cpp
extern const ShadowKind kShadowMapId; // map_id.cpp
extern const ShadowKind kShadowPcf;   // pcf.cpp
extern const ShadowKind kShadowPcss;  // pcss.cpp

} // namespace wavepath
