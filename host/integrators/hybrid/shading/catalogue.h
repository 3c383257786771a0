// The registry of models of local illumination, what they refuse, and their rows in the table of settings.
#pragma once

#include <vector>

#include "host/integrators/hybrid/shading/local_shading.h"
#include "host/render/settings/registry.h"

namespace wavepath {

// The materials' own reflection is built in.
extern const Registry<ShadingKind> kShadingModels;

std::vector<Setting> shading_rows();

// Throws UsageError if settings do not go with the model that they name.
void check_shading_settings(const RenderPlan& settings);

} // namespace wavepath
