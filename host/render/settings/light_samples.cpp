#include "host/render/settings/light_samples.h"

#include <algorithm>

#include "host/render/settings/integrator_kind.h"

namespace wavepath {
std::uint32_t light_samples_of(const RenderSettings& settings, gpu::Feature scene) {
  if (!takes(*settings.integrator, "light-samples") || settings.direct == gpu::kDirectBsdf) return 1;
  if (settings.light_samples > 0) return settings.light_samples;
  if (!(scene & gpu::kFeatureEnvironmentMap)) return 1;
  return scene & (gpu::kLobesLayered | gpu::kFeatureLightTree) ? kFewLightSamplesOfMaps : kLightSamplesOfMaps;
}

bool may_share_sky(const RenderSettings& settings, gpu::Feature scene) {
  return takes(*settings.integrator, "sky-samples") && settings.direct == gpu::kDirectMis && settings.max_depth > 0 &&
         (scene & gpu::kFeatureEnvironment) && !(scene & (gpu::kFeatureEnvironmentMap | gpu::kFeaturePanes));
}

bool tries_sky_cheaply(gpu::Feature scene) { return !(scene & (gpu::kLobesLayered | gpu::kFeatureLightTree)); }

std::uint32_t sky_samples_of(const RenderSettings& settings, gpu::Feature scene) {
  return may_share_sky(settings, scene) ? std::max(1u, settings.sky_samples) : 1;
}

} // namespace wavepath
