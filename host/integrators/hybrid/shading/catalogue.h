// The model of local illumination that settings name, and what it refuses.
#pragma once

#include <string_view>

#include "host/integrators/hybrid/shading/local_shading.h"

namespace wavepath {

// Null for the materials' own.
const ShadingKind* shading_kind(const RenderPlan& settings);

// Whether a setting of local illumination means something to the model chosen; any other setting does.
bool takes_shading_setting(const RenderPlan& settings, std::string_view setting);
// Throws UsageError if the settings name something that the model does not take.
void check_shading_settings(const RenderPlan& settings);

} // namespace wavepath
