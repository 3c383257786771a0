// Materials and the textures they use, converted when the first primitive asks for them.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "host/scene/gltf_document.h"
#include "host/scene/scene.h"

namespace wavepath::gltf {

// What has been converted so far.
struct MaterialMap {
  std::map<int, std::uint32_t> materials;        // glTF material (-1: the default one) -> Scene::materials
  std::map<std::string, std::uint32_t> image_of; // where its data come from -> Scene::images
  std::vector<std::size_t> image_sources;        // glTF image of each of Scene::images
};

// The index in scene.materials of a glTF material, or of the default material for -1. Throws Error.
std::uint32_t use_material(const Document& document, Scene& scene, MaterialMap& map, int material);

// Decodes the images that the materials in use refer to into scene.images, in parallel. Throws Error.
void decode_images(Document& document, Scene& scene, const MaterialMap& map);

} // namespace wavepath::gltf
