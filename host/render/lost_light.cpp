#include "host/render/lost_light.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/render/agreement.h"
#include "host/render/pilot_picture.h"
#include "host/render/settings/cover.h"
#include "host/render/settings/integrator_kind.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kLostLightSide = 64, kLostLightSamples = 16;

// Rays never meet lamps without an extent.
bool has_lamps_unseen(const PackedScene& scene) {
  return std::ranges::any_of(scene.lights, [](const gpu::Light& light) {
    return light.kind != gpu::kLightTriangle && light.kind != gpu::kLightEnvironment && light.pdf_area == 0.0f;
  });
}

} // namespace

bool has_smooth_surface(const PackedScene& scene) {
  return std::ranges::any_of(scene.materials, [](const gpu::Material& m) {
    return m.roughness * m.roughness < gpu::kMinAlpha &&
           (m.transmission > 0.0f || m.metallic > 0.0f || m.specular > 0.0f);
  });
}

bool may_lose_light(const PackedScene& scene) { return has_smooth_surface(scene) && has_lamps_unseen(scene); }

std::string unlit_bodies(const PackedScene& scene) {
  const bool lamps = has_lamps_unseen(scene);
  bool dark = false;
  for (std::size_t i = 0; i < scene.layers.size() && lamps; ++i) {
    const gpu::Material& m = scene.materials[i];
    // Shadow rays find lamps through the lobes of rough walls, and of those that let light through diffusely.
    const bool smooth = m.roughness * m.roughness < gpu::kMinAlpha && scene.layers[i].diffuse_transmission == 0.0f;
    dark |= scene.layers[i].scattering != glm::vec3(0.0f) && smooth && m.ior != 1.0f &&
            (m.flags >> gpu::kMaterialPriorityShift) != 0;
  }
  if (!dark) return {};
  return "point, spot and directional lights do not shine into bodies that scatter through smooth walls that refract "
         "(ior other than 1): what they would light there stays dark; emissive surfaces and skies are found by chance";
}

std::optional<LostLight> measure_lost_light(Device& device, const PackedScene& scene, const View& view,
                                            const RenderPlan& settings, KernelCompiler& kernels, SceneOnDevice& shared,
                                            const ProgressCallback& progress) {
  const auto finder = std::ranges::find_if(integrators(), &IntegratorKind::splats);
  const IntegratorKind& kind = *settings.integrator; // only kinds that claim to find all light up to their depth
  if (!kind.measures_depth_cut || kind.splats || finder == integrators().end() || !may_lose_light(scene))
    return std::nullopt;
  if (const std::string problem = (*finder)->unsupported_reason ? (*finder)->unsupported_reason(settings, scene) : "";
      !problem.empty())
    throw Error(fmt::format("--integrator {}", (*finder)->name), problem, "nothing else finds such light");
  RenderPlan small = without_cover(pilot_settings(settings, kLostLightSide, kLostLightSamples));
  small.clamp = 0.0; // the other integrator does not know it
  small.training.found = shared.light_probabilities;
  const PictureLight found = light_of(*render_pilot(device, scene, view, small, progress, kernels, shared).film);
  small.integrator = *finder;
  small.kernels.added = settings.kernels.added;
  small.aovs.clear(); // the other integrator does not support all of them
  const PictureLight all = light_of(*render_pilot(device, scene, view, small, progress, kernels, shared).film);
  if (!(all.sum > 0.0)) return LostLight{};
  LostLight lost{std::max(0.0, all.sum - found.sum) / all.sum, std::sqrt(all.variance + found.variance) / all.sum};
  constexpr double kSurelyLost = 4.0;
  if (lost.fraction > kSurelyLost * lost.standard_error)
    lost.disagrees = find_disagreement(device, scene, view, settings, small, kernels, shared).has_value();
  return lost;
}

} // namespace wavepath
