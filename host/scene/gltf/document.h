// A glTF document, parsed by tinygltf after our own checks. Its bytes are read later, see buffers.h and views.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <tiny_gltf.h>
#include <nlohmann/json_fwd.hpp>

#include "host/base/warnings.h"
#include "host/scene/gltf/container.h"
#include "host/scene/volume.h"

namespace wavepath::gltf {

using Bytes = std::span<const std::uint8_t>;

// Source of a buffer's or an image's bytes. `size`: a buffer's byteLength. `view`: the buffer view that holds them, or
// -1. `chunk`: the one of Document::chunks that holds a buffer, or -1.
struct Source {
  std::string name, uri;
  std::uint64_t size = 0;
  int view = -1;
  int chunk = -1;
};

// A channel of an animation that names what it moves by a JSON pointer (KHR_animation_pointer).
struct PointerChannel {
  std::size_t channel = 0; // its number in the file
  int sampler = 0;
  std::string pointer;
};

// The volume of a node, in the space of the node; without grids until they are needed.
struct NodeVolume {
  std::size_t node = 0;
  Source source{};
  Volume volume{};
};

// tinygltf refuses valid files whose indices have no bufferView (Draco, sparse), so they are kept among the attributes.
inline constexpr const char* kIndices = "INDICES";

struct Document {
  std::filesystem::path path;
  std::string file;      // the path, for messages
  tinygltf::Model model; // without buffers, images and materials; every index in it is in range
  std::shared_ptr<const nlohmann::json> materials;      // as posed
  std::shared_ptr<const nlohmann::json> file_materials; // as in the file
  std::vector<Source> buffers, images, profiles;        // profiles: of EXT_lights_ies
  std::vector<NodeVolume> volumes;
  // For each animation, its channels that name no node, which are not in `model`: those with a pointer, and the number
  // of others.
  std::vector<std::vector<PointerChannel>> pointer_channels;
  std::vector<std::size_t> nodeless_channels;
  bool keeps_textures = false;                      // also where a factor is zero: an animation may change it
  std::vector<std::string> variants;                // names of KHR_materials_variants
  std::vector<std::vector<std::uint8_t>> chunks;    // contents of .glb files
  std::vector<std::filesystem::path> assets;        // files that are instances in this one (external assets)
  Warnings warnings;                                // of opening it
  std::set<std::size_t> told_matrices, told_hidden; // nodes whose matrix or visibility the caller has replaced

  // Contents of each buffer and of each compressed view; empty until needed.
  std::vector<std::vector<std::uint8_t>> loaded_buffers, decoded_views;

  [[noreturn]] void fail(const std::string& problem, const std::string& remedy = kRepair) const;
};

} // namespace wavepath::gltf
