#include "host/render/lost_light.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/small_picture.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kLostLightSide = 64, kLostLightSamples = 16;

} // namespace

bool has_smooth_surface(const PackedScene& scene) {
  return std::ranges::any_of(scene.materials, [](const gpu::Material& m) {
    return m.roughness * m.roughness < gpu::kMinAlpha &&
           (m.transmission > 0.0f || m.metallic > 0.0f || m.specular > 0.0f);
  });
}

bool may_lose_light(const PackedScene& scene) {
  return has_smooth_surface(scene) && (scene.features & gpu::kFeaturePunctualLights) != 0;
}

std::optional<LostLight> measure_lost_light(Device& device, const PackedScene& scene, const View& view,
                                            const RenderSettings& settings, KernelCompiler& kernels,
                                            SceneOnDevice& shared, const ProgressCallback& progress) {
  const auto finder = std::ranges::find_if(integrators(), &IntegratorKind::splats);
  const IntegratorKind& kind = *settings.integrator; // of those that claim all light up to their depth
  if (!kind.measures_depth_cut || kind.splats || finder == integrators().end() || !may_lose_light(scene))
    return std::nullopt;
  if (const std::string problem = (*finder)->unfit ? (*finder)->unfit(settings, scene) : ""; !problem.empty())
    throw Error(fmt::format("--integrator {}", (*finder)->name), problem, "nothing else finds such light");
  RenderSettings small = small_picture(settings, kLostLightSide, kLostLightSamples);
  small.light_shares = shared.light_shares;
  const PictureLight found = light_of(*render_whole(device, scene, view, small, progress, kernels, shared).film);
  small.integrator = *finder;
  small.added_features = settings.added_features;
  small.aovs.clear(); // of which it cannot give all
  const PictureLight all = light_of(*render_whole(device, scene, view, small, progress, kernels, shared).film);
  if (!(all.sum > 0.0)) return LostLight{};
  return LostLight{std::max(0.0, all.sum - found.sum) / all.sum, std::sqrt(all.variance + found.variance) / all.sum};
}

} // namespace wavepath
