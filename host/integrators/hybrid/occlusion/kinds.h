// The techniques there are, one constant a file of this folder.
#pragma once

#include "host/integrators/hybrid/occlusion/technique.h"

namespace wavepath {

extern const OcclusionKind kOcclusionSsao; // ssao.cpp
extern const OcclusionKind kOcclusionHbao; // hbao.cpp
extern const OcclusionKind kOcclusionGtao; // gtao.cpp

} // namespace wavepath
