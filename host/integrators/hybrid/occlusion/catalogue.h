// The registry of occlusion techniques, what they refuse, and their rows in the table of settings.
#pragma once

#include <vector>

#include "host/integrators/hybrid/occlusion/technique.h"
#include "host/render/settings/registry.h"

namespace wavepath {

// Rays are built in.
extern const Registry<OcclusionKind> kOcclusionTechniques;

std::vector<Setting> occlusion_rows();

// Throws UsageError if settings do not go with the technique that they name.
void check_occlusion_settings(const RenderPlan& settings);

} // namespace wavepath
