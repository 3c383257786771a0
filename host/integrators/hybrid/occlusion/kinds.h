// The occlusion techniques there are, in the order of --occlusion. Each is a constant in a file of its own in this
// folder: kOcclusionSsao in ssao.cpp.
#pragma once

#include "host/integrators/hybrid/occlusion/technique.h"
#include "host/render/settings/registry.h"

namespace wavepath {

WAVEPATH_ROWS(OcclusionKind, kOcclusionKinds, kOcclusionSsao, kOcclusionHbao, kOcclusionGtao, kOcclusionCones);

} // namespace wavepath
