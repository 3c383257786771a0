// The technique of anti-aliasing that settings name, and what it refuses.
#pragma once

#include <span>

#include "host/integrators/hybrid/antialias/technique.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

// In the order of kAntialiasNames.
std::span<const AntialiasKind* const> antialias_kinds();
const AntialiasKind& antialias_kind(const RenderPlan& settings);

// Samples that the whole render is to have of every pixel.
std::uint32_t whole_samples(const RenderPlan& settings);
// Throws UsageError if other settings do not go with it.
void check_antialias_settings(const RenderPlan& settings);

} // namespace wavepath
