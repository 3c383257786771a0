// Reads a glTF 2.0 file (.gltf with what it refers to, or .glb) into a Scene: everything checked, decoded and posed.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "host/scene/scene.h"

namespace wavepath {

// Called when the scene is complete except for the contents of its images, which are still being decoded.
using SceneDescribed = std::function<void(Scene& scene)>;

struct LoadOptions {
  std::string scene;     // name or index; empty = the file's default scene, else its first one
  std::string animation; // name or index; empty = the pose at rest
  double at = 0.0;       // seconds into the animation, clamped to its key frames
  // Instead of `at`: when the shutter opens and closes. Cameras and lights stay as they are when it opens.
  std::optional<std::pair<double, double>> shutter{};
};

// Throws Error that names the file, what is wrong with it and what to do. What is ignored or repaired is counted in
// Scene::warnings. Meshes, materials and images that the chosen scene does not use are neither read nor decoded.
Scene load_gltf(const std::filesystem::path& path, const LoadOptions& options = {},
                const SceneDescribed& described = {});

} // namespace wavepath
