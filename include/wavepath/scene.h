// A scene: a glTF file, and how it is posed and lit.
#pragma once

#include <string>

#include <wavepath/export.h>
#include <wavepath/settings.h>

namespace wavepath_v0 {

struct Scene {
  std::string file; // .gltf or .glb
  // Flags about the scene: env, env-intensity, env-rotation, animation, at, ground, sun, scene, shutter, staged-at,
  // variant, volume and its like.
  Settings settings{};
};

} // namespace wavepath_v0
