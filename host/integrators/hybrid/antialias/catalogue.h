// The registry of techniques of anti-aliasing, what they refuse, and their row in the table of settings.
#pragma once

#include <vector>

#include "host/integrators/hybrid/antialias/technique.h"
#include "host/render/settings/registry.h"

namespace wavepath {

extern const Registry<AntialiasKind> kAntialiasTechniques;

std::vector<Setting> antialias_rows();

// Throws UsageError if other settings do not go with it.
void check_antialias_settings(const RenderPlan& settings);

} // namespace wavepath
