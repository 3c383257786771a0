// Reads a scene file; meanwhile the device opens and the kernels for the scene compile.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "host/gpu/device.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/pack.h"
#include "host/session/requests.h"

namespace wavepath {

struct OpenScene {
  std::shared_ptr<Device> device;
  std::shared_ptr<KernelCompiler> kernels; // compiling what the scene will most likely need
  LoadedScene loaded;
};

// The device opens while the scene is read; kernels compile from the moment the scene's needs can be foreseen.
// `window_extensions`: as Device takes them. `stays_open`: as load_scene() takes it. Throws Error.
OpenScene open_scene(const SceneRequest& scene, const RenderRequest& render,
                     std::span<const char* const> window_extensions = {}, bool stays_open = false);

// Throws Error unless there is such a file.
void require_file(const std::string& path);

} // namespace wavepath
