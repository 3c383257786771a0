#include "host/integrators/hybrid/shading/catalogue.h"

#include "host/integrators/hybrid/shading/kinds.h"

namespace wavepath {

constinit const Registry<ShadingKind> kShadingModels = {
    .setting = "shading", .value = &RenderPlan::shading, .rows = kShadingKinds, .built_in = "gltf"};

void check_shading_settings(const RenderPlan& settings) {
  const ShadingKind* kind = kShadingModels.find(settings);
  if (kind && settings.direct == gpu::kDirectBsdf)
    throw UsageError("--direct bsdf", fmt::format("draws directions, which --shading {} does not", kind->name),
                     "leave one of them out");
  kShadingModels.check(settings);
}

} // namespace wavepath
