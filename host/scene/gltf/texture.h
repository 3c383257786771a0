// Texture references of materials, and the images behind them.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "host/scene/gltf/document.h"
#include "host/scene/gltf/image.h"
#include "host/scene/scene.h"

namespace wavepath::gltf {

// The images that materials refer to, in the order of Scene::images.
struct ImageMap {
  std::map<std::string, std::uint32_t> index_of; // key: source of the image's data
  std::vector<std::size_t> sources;              // glTF image of each of Scene::images
};

// The slot that a textureInfo object of a material describes; its set is that of the file. Throws Error.
TextureSlot read_texture(const Document& document, ImageMap& images, Warnings& warnings, const nlohmann::json& info,
                         bool srgb);

// An image as stored in a file.
struct ImageFile {
  std::string document, name; // for messages
  std::vector<std::uint8_t> bytes;
};

// Throws Error.
std::vector<ImageFile> image_files(Document& document, const ImageMap& images);

// Decodes them, in parallel. Throws the Error of the first that is not sound.
std::vector<TextureImage> decode_images(const std::vector<ImageFile>& files);

// Gives the scene its images, and its materials' slots what files of KTX2 say about their values. Returns whether one
// holds values (TextureImage).
bool take_images(Scene& scene, std::vector<TextureImage> images);

} // namespace wavepath::gltf
