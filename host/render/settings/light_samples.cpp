#include "host/render/settings/light_samples.h"

#include <algorithm>

#include "host/render/settings/integrator_kind.h"

namespace wavepath {
std::uint32_t light_samples_of(const RenderPlan& settings, gpu::Feature scene) {
  if (!supports(*settings.integrator, "light-samples") || settings.direct == gpu::kDirectBsdf) return 1;
  if (settings.light_samples > 0) return settings.light_samples;
  if (!(scene & gpu::kFeatureEnvironmentMap)) return 1;
  return scene & (gpu::kLobesLayered | gpu::kFeatureLightTree) ? kFewLightSamplesOfMaps : kLightSamplesOfMaps;
}

bool may_sample_sky(const RenderPlan& settings, gpu::Feature scene) {
  return supports(*settings.integrator, "sky-samples") && settings.direct == gpu::kDirectMis &&
         settings.max_depth > 0 && (scene & gpu::kFeatureEnvironment) &&
         !(scene & (gpu::kFeatureEnvironmentMap | gpu::kFeaturePanes | gpu::kLobeScattering));
}

bool tries_sky_cheaply(gpu::Feature scene) { return !(scene & (gpu::kLobesLayered | gpu::kFeatureLightTree)); }

std::uint32_t sky_samples_of(const RenderPlan& settings, gpu::Feature scene) {
  if (!may_sample_sky(settings, scene)) return 1;
  return std::clamp(settings.sky_samples, 1u, sky_samples_that_fit(settings, scene));
}

std::uint32_t sky_samples_that_fit(const RenderPlan& settings, gpu::Feature scene) {
  return gpu::kMostLightSamples + 1 - light_samples_of(settings, scene);
}

std::uint32_t learned_sky_samples(const RenderPlan& settings, gpu::Feature scene) {
  constexpr std::uint32_t kBest = 7;
  return std::min(kBest, sky_samples_that_fit(settings, scene));
}

std::uint32_t most_sky_samples_of(const RenderPlan& settings, gpu::Feature scene) {
  const bool chooses = settings.sky_samples == 0 && settings.kernels.sky_samples && may_sample_sky(settings, scene);
  return chooses ? sky_samples_that_fit(settings, scene) : sky_samples_of(settings, scene);
}

std::uint32_t shadow_queues(std::uint32_t light_samples, std::uint32_t sky_samples) {
  return light_samples + sky_samples - 1;
}

} // namespace wavepath
