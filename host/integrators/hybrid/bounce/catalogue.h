// The registry of techniques of one diffuse bounce, what they refuse, and their row in the table of settings. They are
// of the same type as techniques of reflections and take their place: both fill kBindReflections. Light of a bounce
// takes the place of the ambient term as well.
#pragma once

#include <vector>

#include "host/integrators/hybrid/reflections/technique.h"
#include "host/render/settings/registry.h"

namespace wavepath {

// The name that the time of cones is counted under.
inline constexpr const char* kBounceConesStage = "bounce by cones";

// No bounce is built in.
extern const Registry<ReflectionKind> kBounceTechniques;

std::vector<Setting> bounce_rows();

// Throws UsageError if settings do not go with the technique that they name.
void check_bounce_settings(const RenderPlan& settings);

// The technique that fills kBindReflections, of a bounce or of mirrors; null = none.
const ReflectionKind* reflecting_technique(const RenderPlan& settings);

} // namespace wavepath
