#include "host/cli/open_scene.h"

#include <filesystem>
#include <future>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/memory.h"
#include "host/film/denoise.h"
#include "host/render/device/workspace.h"
#include "host/render/settings/adaptivity.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/shadow_settings.h"
#include "host/scene/pack/features.h"

namespace wavepath {
namespace {

// Compiles the kernels that the scene will most likely need. A wrong guess costs only time.
void begin_kernels(KernelCompiler& kernels, const DeviceInfo& device, const Scene& scene,
                   const RenderSettings& settings) {
  gpu::Feature features = expected_features(scene, direct_of(settings)) | features_of(settings);
  if (settings.textures == kTexturesHardware && features & gpu::kFeatureTextures)
    features |= gpu::kFeatureSampledTextures;
  for (const Camera& camera : scene.cameras)
    if (camera.orthographic) features |= gpu::kFeatureOrthographic;
  settings.integrator->start_kernels(kernels, device, features, settings);
}

} // namespace

OpenScene open_scene(const SceneRequest& scene, const RenderRequest& render,
                     std::span<const char* const> window_extensions) {
  OpenScene open;
  auto opening =
      std::async(std::launch::async, [&] { return std::make_unique<Device>(render.device, window_extensions); });
  open.loaded = load_scene(scene, [&](const Scene& described) {
    open.device = opening.get();
    open.kernels = std::make_unique<KernelCompiler>(*open.device);
    begin_kernels(*open.kernels, open.device->info(), described, render.settings);
  });
  return open;
}

void require_file(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw Error(path, "does not exist", "check the name");
  if (std::filesystem::is_directory(path, error)) throw Error(path, "is a folder", "name a file");
}

void require_memory_for(const std::string& path, const RenderSettings& settings, const Plan& plan,
                        const DeviceInfo& device) {
  const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
  const FilmShape shape = film_shape(settings);
  const std::uint64_t film = shape.bytes() + (is_adaptive(settings) ? shape.places() * sizeof(std::uint32_t) : 0);
  const IntegratorKind& kind = *settings.integrator;
  const std::uint64_t extra = kind.extra_bytes ? kind.extra_bytes(settings) : 0;
  const std::uint64_t frames = pixels * kind.bytes_per_pixel(settings) + extra;
  const bool learns = plan.light_tree_bytes > 0 && (features_of(settings) & gpu::kFeatureLightRows) != 0;
  const bool learns_sky = plan.environment_bytes > 0 && (features_of(settings) & gpu::kFeatureLearnedSky) != 0;
  const std::uint64_t lesson = (learns ? kind.light_lesson_bytes : 0) + (learns_sky ? kind.sky_lesson_bytes : 0);
  const std::uint64_t picture = pixels * sizeof(float) * (4 + 3 * settings.aovs.size());
  const std::uint64_t copies = device.type == "cpu" ? 2 : 1;
  const std::uint64_t filter = denoises_film(settings) ? pixels * kDenoiseBytesPerPixel : 0;
  require_memory(path, fmt::format("rendering it at {}x{}", settings.width, settings.height),
                 copies * (plan.total() + film) + frames + lesson + picture + filter,
                 "use a smaller --size, fewer --aov or a simpler scene");
}

} // namespace wavepath
