// The registry of shadow techniques, what they cover of a scene, what they refuse, and their rows in the table of
// settings.
#pragma once

#include <string>
#include <vector>

#include "host/integrators/hybrid/shadows/technique.h"
#include "host/render/settings/registry.h"

namespace wavepath {

// Rays are built in.
extern const Registry<ShadowKind> kShadowTechniques;

std::vector<Setting> shadow_rows();

// The lights of a scene, under a technique.
struct LightCover {
  std::vector<ShadowSource> covered;
  std::string traced; // the others, in words; empty if there are none
};
LightCover light_cover(const ShadowKind& kind, const PackedScene& scene);
// Why the technique has nothing to do in this scene; empty if it has.
std::string unsupported_reason(const ShadowKind& kind, const PackedScene& scene);
// Throws Error if there are none.
std::vector<ShadowSource> covered_sources(const ShadowKind& kind, const PackedScene& scene);

// Throws UsageError if settings do not go with the technique that they name.
void check_shadow_settings(const RenderPlan& settings);

} // namespace wavepath
