// The registry of techniques of transparency, what they refuse, and their rows in the table of settings.
#pragma once

#include <vector>

#include "host/integrators/hybrid/transparency/technique.h"
#include "host/render/settings/registry.h"

namespace wavepath {

// Passing through at random is built in.
extern const Registry<TransparencyKind> kTransparencyTechniques;

std::vector<Setting> transparency_rows();

// Throws UsageError if settings do not go with the technique that they name.
void check_transparency_settings(const RenderPlan& settings);

} // namespace wavepath
