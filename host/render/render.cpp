#include "host/render/render.h"

#include "host/render/loop/render_loop.h"
#include "host/render/workspace/kernel_compiler.h"

namespace wavepath {

RenderResult render(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                    const ProgressCallback& progress) {
  KernelCompiler kernels(device);
  return render(device, scene, view, settings, RenderHooks{progress}, kernels);
}

RenderResult render(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                    const RenderHooks& hooks, KernelCompiler& kernels, SceneOnDevice* shared) {
  std::shared_ptr<RenderLoop> kept = shared ? std::move(shared->loop) : nullptr;
  if (kept && kept->can_render(settings))
    kept->restart(view, settings, hooks);
  else
    kept.reset(); // which makes room
  if (!kept)
    kept = std::make_shared<RenderLoop>(device, scene, view, settings, kernels, hooks, LoopPolicy{},
                                        shared ? shared->scene : nullptr);
  RenderLoop& loop = *kept;
  if (shared && !shared->scene) {
    shared->scene = loop.workspace().on_device;
    shared->upload_seconds = loop.workspace().upload_seconds;
  }
  try {
    while (loop.step()) {
    }
    RenderResult result = loop.finish();
    if (shared && result.light_training.probabilities)
      shared->light_probabilities = result.light_training.probabilities;
    if (shared && shared->keeps_loop) {
      loop.forget_hooks();
      shared->loop = std::move(kept);
    }
    return result;
  } catch (const DeviceLost& lost) {
    if (!hooks.salvages) throw;
    return loop.salvage(lost);
  }
}

} // namespace wavepath
