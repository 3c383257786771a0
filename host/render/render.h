// Renders a scene: takes settings, returns a picture and what it cost. The loop itself is loop/render_loop.h.
#pragma once

#include <memory>

#include "host/render/loop/hooks.h"
#include "host/render/loop/render_result.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

class Device;
class KernelCompiler; // host/render/workspace/kernel_compiler.h
struct DeviceScene;   // host/render/workspace/device_scene.h
struct PackedScene;
struct View; // host/scene/staging/view.h: the resolved camera

// Renders `scene` as seen by `view`. Throws Error if the device cannot hold it or fails. The result depends on the
// device, the scene, the view and the settings alone, not on wave_slots or timing (save where time_limit or
// target_error ends it), nor on how often it was stopped and resumed.
RenderResult render(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                    const ProgressCallback& progress = {});

// A scene that several renders on one device share, pilots among them: the first one uploads it. The device outlives
// this.
struct SceneOnDevice {
  std::shared_ptr<const DeviceScene> scene; // null before the first render
  double upload_seconds = 0.0;
  LightProbabilities light_probabilities; // of the latest render that trained any
};

// The same with kernels that may have been begun before the scene was known. `shared`: null where no other render
// shares the scene.
RenderResult render(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                    const RenderHooks& hooks, KernelCompiler& kernels, SceneOnDevice* shared = nullptr);

} // namespace wavepath
