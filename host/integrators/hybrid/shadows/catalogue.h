// The shadow technique that settings name, what it covers of a scene, and what it refuses.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/integrators/hybrid/shadows/technique.h"

namespace wavepath {

// All but tracing, in the order of kShadowNames.
std::span<const ShadowKind* const> shadow_kinds();
// Null for tracing.
const ShadowKind* shadow_kind(const RenderPlan& settings);

// The lights of a scene, under a technique.
struct LightCover {
  std::vector<ShadowSource> covered;
  std::string traced; // the others, in words; empty if there are none
};
LightCover light_cover(const ShadowKind& kind, const PackedScene& scene);
// Why the technique has nothing to do in this scene; empty if it has.
std::string unfit(const ShadowKind& kind, const PackedScene& scene);
// Throws Error if there are none.
std::vector<ShadowSource> covered_sources(const ShadowKind& kind, const PackedScene& scene);

// Whether a setting of shadows means something to the technique chosen.
bool takes_shadow_setting(const RenderPlan& settings, std::string_view setting);
// Throws UsageError if the settings name something that the technique does not take.
void check_shadow_settings(const RenderPlan& settings);

} // namespace wavepath
