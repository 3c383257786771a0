// Materials and the textures they use, converted when the first primitive asks for them.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "host/scene/gltf/document.h"
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

// An image as stored in a file.
struct ImageFile {
  std::string document, name; // for messages
  std::vector<std::uint8_t> bytes;
};

// The images that the materials so far refer to, in the order of Scene::images. Throws Error.
std::vector<ImageFile> image_files(Document& document, const MaterialMap& map);

// Decodes them, in parallel. Throws the Error of the first that is not sound.
std::vector<Image> decode_images(const std::vector<ImageFile>& files);

} // namespace wavepath::gltf
