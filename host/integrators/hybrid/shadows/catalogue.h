// The registry of shadow techniques, the lights and scenes that they support, and their rows in the table of settings.
#pragma once

#include <string>
#include <vector>

#include "host/integrators/hybrid/shadows/technique.h"
#include "host/render/settings/registry.h"

namespace wavepath {

// The built-in value is traced shadow rays.
extern const Registry<ShadowKind> kShadowTechniques;

std::vector<Setting> shadow_rows();

// The lights of a scene that a technique covers, and the others.
struct LightCover {
  std::vector<ShadowSource> covered;
  std::string traced; // names of the lights that are traced; empty if there are none
};
LightCover light_cover(const ShadowKind& kind, const PackedScene& scene);
// Reason why the technique has nothing to do in this scene; empty if it has.
std::string unsupported_reason(const ShadowKind& kind, const PackedScene& scene);
// The lights that the technique covers. Throws Error if there are none.
std::vector<ShadowSource> covered_sources(const ShadowKind& kind, const PackedScene& scene);

// Throws UsageError if settings contradict the technique that they name.
void check_shadow_settings(const RenderPlan& settings);

} // namespace wavepath
