// The registry of techniques of reflections, what they refuse, and their rows in the table of settings.
#pragma once

#include <vector>

#include "host/integrators/hybrid/reflections/technique.h"
#include "host/render/settings/registry.h"

namespace wavepath {

// No reflections of lit surfaces are built in.
extern const Registry<ReflectionKind> kReflectionTechniques;

std::vector<Setting> reflection_rows();

// Throws UsageError if settings do not go with the technique that they name.
void check_reflection_settings(const RenderPlan& settings);

} // namespace wavepath
