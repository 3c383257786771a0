// Materials, converted when the first primitive asks for them.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "host/scene/gltf/document.h"
#include "host/scene/gltf/texture.h"
#include "host/scene/gltf/uv_sets.h"
#include "host/scene/scene.h"

namespace wavepath::gltf {

// Materials converted so far.
struct MaterialMap {
  std::map<int, std::uint32_t> materials; // glTF material (-1: the default one) -> Scene::materials
  ImageMap images;
  std::vector<UvSets> uv_sets; // for each of Scene::materials: the coordinates that vertices must carry
  // Materials that read more sets of texture coordinates than vertices have, with the sets of the file; and their
  // versions for single primitives.
  std::map<std::uint32_t, Material> crowded;
  std::map<std::pair<std::uint32_t, std::vector<float>>, std::uint32_t> fitted;
};

// The index in scene.materials of a glTF material, or of the default material for -1. Throws Error.
std::uint32_t use_material(const Document& document, Scene& scene, MaterialMap& map, int material);

// The same as one primitive shows it, whose coordinates decide where there are too many sets of them.
std::uint32_t use_material(Document& document, Scene& scene, MaterialMap& map, const tinygltf::Primitive& primitive,
                           const Decoded& decoded);

} // namespace wavepath::gltf
