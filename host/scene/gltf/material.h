// Materials, converted when the first primitive asks for them.
#pragma once

#include <cstdint>
#include <map>

#include "host/scene/gltf/document.h"
#include "host/scene/gltf/texture.h"
#include "host/scene/scene.h"

namespace wavepath::gltf {

// What has been converted so far.
struct MaterialMap {
  std::map<int, std::uint32_t> materials; // glTF material (-1: the default one) -> Scene::materials
  ImageMap images;
};

// The index in scene.materials of a glTF material, or of the default material for -1. Throws Error.
std::uint32_t use_material(const Document& document, Scene& scene, MaterialMap& map, int material);

} // namespace wavepath::gltf
