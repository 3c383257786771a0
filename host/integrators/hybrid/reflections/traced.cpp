// Reflections by rays: the truth that the other techniques are measured by.
#include "host/integrators/hybrid/reflections/kinds.h"
#include "host/integrators/hybrid/reflections/rays.h"

namespace wavepath {

constinit const ReflectionKind kReflectionTraced = {
    .name = "traced",
    .summary = "found by rays",
    .program = &kRayProgram,
    .nested_stages = kNestedRayStages,
    .depth = 2,
    .traces = true,
    .make = [](const ReflectionContext& context) -> std::unique_ptr<ReflectionTechnique> {
      return std::make_unique<RayReflections>(context);
    },
};

} // namespace wavepath
