#include "host/render/settings/path_reuse.h"

#include "host/render/settings/cover.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/light_groups.h"

namespace wavepath {

bool may_reuse_paths(const RenderPlan& settings) {
  return supports(*settings.integrator, "reuse") && settings.max_depth > 1 && !settings.guide && !settings.moving &&
         settings.hemisphere == gpu::kHemisphereCosine && !records_groups(settings) && !has_cover(settings);
}

bool reuses_paths(const RenderPlan& settings) { return settings.reuse == kReuseOn && may_reuse_paths(settings); }

bool tries_reuse(const RenderPlan& settings, gpu::Feature scene) {
  const bool trains = scene & (gpu::kFeatureLightTree | gpu::kFeatureEnvironmentMap);
  if (scene & gpu::kFeatureVoxels) return false; // neighbours look through other parts of a volume
  return may_reuse_paths(settings) && settings.kernels.reuse >= (trains ? BearsReuse::anywhere : BearsReuse::untrained);
}

bool kernels_reuse_paths(const RenderPlan& settings, gpu::Feature scene) {
  return reuses_paths(settings) || tries_reuse(settings, scene);
}

} // namespace wavepath
