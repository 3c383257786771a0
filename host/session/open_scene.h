// Reads a scene file; meanwhile the device opens and the kernels for the scene compile.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "host/gpu/device.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/pack.h"
#include "host/session/load.h"
#include "host/session/requests.h"

namespace wavepath {

// A device with the kernels that were compiled for it, which several scenes may share.
struct SessionDevice {
  std::shared_ptr<Device> device;
  std::shared_ptr<KernelCompiler> kernels;
};
// Opens the device that `name` means: a name, an index, or empty for the usual choice. Throws Error.
SessionDevice open_device(const std::string& name, std::span<const char* const> window_extensions = {});

struct OpenScene {
  std::shared_ptr<Device> device;
  std::shared_ptr<KernelCompiler> kernels; // compiling what the scene will most likely need
  LoadedScene loaded;
};

// The device opens while the scene is read; kernels compile from the moment the scene's needs can be foreseen.
// `window_extensions`: as Device takes them. `stays_open`: as load_scene() takes it. `device`: one that is open, or
// null. Throws Error.
OpenScene open_scene(const SceneRequest& scene, const RenderRequest& render,
                     std::span<const char* const> window_extensions = {}, bool stays_open = false,
                     const SessionDevice& device = {});

// Throws Error unless there is such a file.
void require_file(const std::string& path);

} // namespace wavepath
