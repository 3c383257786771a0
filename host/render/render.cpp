#include "host/render/render.h"

#include "host/render/device/kernel_compiler.h"
#include "host/render/loop/render_loop.h"

namespace wavepath {

RenderResult render(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
                    const ProgressCallback& progress) {
  KernelCompiler kernels(device);
  return render(device, scene, view, settings, RenderHooks{progress}, kernels);
}

RenderResult render(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
                    const RenderHooks& hooks, KernelCompiler& kernels, SceneOnDevice* shared) {
  RenderLoop loop(device, scene, view, settings, kernels, hooks, {}, shared ? shared->scene : nullptr);
  if (shared && !shared->scene) *shared = {loop.workspace().on_device, loop.workspace().upload_seconds};
  try {
    while (loop.step()) {
    }
    return loop.finish();
  } catch (const DeviceLost& lost) {
    if (!hooks.salvages) throw;
    return loop.salvage(lost);
  }
}

} // namespace wavepath
