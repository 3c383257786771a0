// Renders a scene: takes settings, returns a picture and its cost. The loop itself is loop/render_loop.h.
#pragma once

#include <memory>

#include "host/render/loop/hooks.h"
#include "host/render/loop/render_result.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

class Device;
class RenderLoop;     // host/render/loop/render_loop.h
class KernelCompiler; // host/render/workspace/kernel_compiler.h
struct DeviceScene;   // host/render/workspace/device_scene.h
struct PackedScene;
struct View; // host/scene/staging/view.h: the resolved camera

// Renders `scene` as seen by `view`. Throws Error if the device cannot hold the scene or fails. The bits of the result
// depend on the device, the scene, the view and the settings alone. They do not depend on wave_slots, on timing (unless
// time_limit ends the render), or on how often it was stopped and resumed.
RenderResult render(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                    const ProgressCallback& progress = {});

// A scene on a device that several renders share, pilots among them. The first render uploads it. The device must
// outlive this.
struct SceneOnDevice {
  std::shared_ptr<const DeviceScene> scene; // null before the first render
  double upload_seconds = 0.0;
  LightProbabilities light_probabilities; // of the latest render that trained them
  // The loop of the latest render, with its buffers, for the next one; kept only if that was asked for. Null otherwise,
  // and to be made so when the scene changes.
  bool keeps_loop = false;
  std::shared_ptr<RenderLoop> loop{};
};

// The same, with kernels whose compilation may have begun before the scene was known. `shared`: null if no other render
// uses the scene.
RenderResult render(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                    const RenderHooks& hooks, KernelCompiler& kernels, SceneOnDevice* shared = nullptr);

} // namespace wavepath
