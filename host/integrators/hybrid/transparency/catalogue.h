// The technique of transparency that settings name, and what it refuses.
#pragma once

#include <string_view>

#include "host/integrators/hybrid/transparency/technique.h"

namespace wavepath {

// Null for passing through at random.
const TransparencyKind* transparency_kind(const RenderPlan& settings);

// Whether a setting of transparency means something to the technique chosen; any other setting does.
bool takes_transparency_setting(const RenderPlan& settings, std::string_view setting);
// Throws UsageError if the settings name something that the technique does not take.
void check_transparency_settings(const RenderPlan& settings);

} // namespace wavepath
