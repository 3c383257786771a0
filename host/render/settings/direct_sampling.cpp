#include "host/render/settings/direct_sampling.h"

#include <algorithm>

#include "host/render/settings/integrator_kind.h"
#include "kernels/path/path_types.h"

namespace wavepath {
namespace {

std::uint32_t lights_of(const RenderPlan& settings, gpu::Feature scene) {
  if (!supports(*settings.integrator, "light-samples") || settings.direct == gpu::kDirectBsdf) return 1;
  if (settings.light_samples > 0) return settings.light_samples;
  if (!(scene & gpu::kFeatureEnvironmentMap)) return 1;
  return scene & (gpu::kLobesLayered | gpu::kFeatureLightTree) ? kFewLightSamplesOfMaps : kLightSamplesOfMaps;
}

} // namespace

std::uint32_t DirectSampling::sky_that_fits() const { return gpu::kMostLightSamples + 1 - lights; }

std::uint32_t DirectSampling::light_rays_at(std::uint32_t bounce) const {
  return gpu::light_samples_at(lights, bounce);
}

std::uint32_t DirectSampling::sky_rays_at(std::uint32_t bounce, bool learned) const {
  return gpu::sky_rays_at(sky - 1, learned, bounce);
}

std::uint32_t DirectSampling::most_rays(std::uint32_t vertices) const {
  return 2 * lights + vertices * (sky - 1); // 1 + 1/2 + 1/4 + ... of the lights
}

DirectSampling direct_sampling(const RenderPlan& settings, gpu::Feature scene) {
  DirectSampling sampling{.lights = lights_of(settings, scene)};
  if (!may_sample_sky(settings, scene)) return sampling;
  sampling.sky = std::clamp(settings.sky_samples, 1u, sampling.sky_that_fits());
  sampling.kernels_see_sky = sampling.sky > 1 || (settings.kernels.shared_sky && tries_sky_cheaply(scene));
  return sampling;
}

RenderPlan with_most_sky(RenderPlan settings, gpu::Feature scene) {
  if (settings.sky_samples == 0 && settings.kernels.shared_sky)
    settings.sky_samples = direct_sampling(settings, scene).sky_that_fits();
  return settings;
}

bool may_sample_sky(const RenderPlan& settings, gpu::Feature scene) {
  return supports(*settings.integrator, "sky-samples") && settings.direct == gpu::kDirectMis &&
         settings.max_depth > 0 && (scene & gpu::kFeatureEnvironment) &&
         !(scene & (gpu::kFeatureEnvironmentMap | gpu::kFeaturePanes | gpu::kLobeScattering | gpu::kFeatureVoxels));
}

bool tries_sky_cheaply(gpu::Feature scene) { return !(scene & (gpu::kLobesLayered | gpu::kFeatureLightTree)); }

} // namespace wavepath
