// A scene that is ready to be rendered: on its devices, planned.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/base/warnings.h"
#include "host/cli/render_request.h"
#include "host/gpu/device.h"
#include "host/picture/tev.h"
#include "host/plan/memory.h"
#include "host/plan/plan.h"
#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/pack.h"

namespace wavepath {

// One of --devices besides the first.
struct OtherDevice {
  std::unique_ptr<Device> device;
  std::unique_ptr<KernelCompiler> kernels;
};

struct Prepared {
  std::unique_ptr<Device> device;
  std::unique_ptr<KernelCompiler> kernels;
  std::vector<OtherDevice> others;
  std::unique_ptr<TevViewer> viewer; // of --tev
  View view;
  std::optional<MemoryCheck> memory;
  PackedScene packed;
  SceneOnDevice on_device; // on `device`
  Plan plan;
  std::uint64_t scene_hash = 0; // where the identity needs it
  std::string identity;         // of the render as it is planned; empty where nothing needs it
  Warnings warnings;
  double load_seconds = 0.0; // without building the BVH
};

// Opens the device, loads the scene, compiles and packs. Throws Error.
Prepared prepare(const RenderCommandRequest& request);

// Decides what the render is going to do, makes the pilots for it, and tells what they found. Throws Error.
void plan_render(const RenderCommandRequest& request, Prepared& prepared);

} // namespace wavepath
