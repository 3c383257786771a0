#include "host/session/open_scene.h"

#include <filesystem>
#include <future>

#include "host/base/error.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/shadow_settings.h"
#include "host/scene/pack/features.h"

namespace wavepath {
namespace {

// Compiles the kernels that the scene will most likely need. A wrong guess costs only time.
void begin_kernels(KernelCompiler& kernels, const DeviceInfo& device, const Scene& scene, const RenderPlan& settings) {
  gpu::Feature features = expected_features(scene, direct_of(settings)) | features_of(settings);
  if (settings.textures == kTexturesHardware && features & gpu::kFeatureTextures)
    features |= gpu::kFeatureSampledTextures;
  for (const Camera& camera : scene.cameras)
    if (camera.orthographic) features |= gpu::kFeatureOrthographic;
  settings.integrator->start_kernels(kernels, device, features, settings);
}

} // namespace

SessionDevice open_device(const std::string& name, std::span<const char* const> window_extensions) {
  SessionDevice opened;
  opened.device = std::make_shared<Device>(name, window_extensions);
  opened.kernels = std::make_shared<KernelCompiler>(*opened.device);
  return opened;
}

OpenScene open_scene(const SceneRequest& scene, const RenderRequest& render,
                     std::span<const char* const> window_extensions, bool stays_open, const SessionDevice& device) {
  OpenScene open;
  auto opening = std::async(std::launch::async,
                            [&] { return device.device ? device : open_device(render.device, window_extensions); });
  const auto begin = [&](const Scene& described) {
    SessionDevice opened = opening.get();
    open.device = std::move(opened.device);
    open.kernels = std::move(opened.kernels);
    begin_kernels(*open.kernels, open.device->info(), described, render.settings);
  };
  open.loaded = load_scene(scene, begin, stays_open);
  return open;
}

void require_file(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw Error(path, "does not exist", "check the name");
  if (std::filesystem::is_directory(path, error)) throw Error(path, "is a folder", "name a file");
}

} // namespace wavepath
