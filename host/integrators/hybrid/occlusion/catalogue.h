// The occlusion technique that settings name, and what it refuses.
#pragma once

#include <span>
#include <string_view>

#include "host/integrators/hybrid/occlusion/technique.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

// All but tracing, in the order of kOcclusionNames.
std::span<const OcclusionKind* const> occlusion_kinds();
// Null for tracing.
const OcclusionKind* occlusion_kind(const RenderPlan& settings);

// Whether a setting of occlusion means something to the technique chosen.
bool takes_occlusion_setting(const RenderPlan& settings, std::string_view setting);
// Throws UsageError if the settings name something that the technique does not take.
void check_occlusion_settings(const RenderPlan& settings);

} // namespace wavepath
