#include "host/render/settings/light_samples.h"

#include "host/render/settings/integrator_kind.h"

namespace wavepath {

std::uint32_t light_samples_of(const RenderSettings& settings, gpu::Feature scene) {
  if (!takes(*settings.integrator, "light-samples") || settings.direct == gpu::kDirectBsdf) return 1;
  if (settings.light_samples > 0) return settings.light_samples;
  if (!(scene & gpu::kFeatureEnvironmentMap)) return 1;
  return scene & (gpu::kLobesLayered | gpu::kFeatureLightTree) ? kFewLightSamplesOfMaps : kLightSamplesOfMaps;
}

} // namespace wavepath
