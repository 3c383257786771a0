// A glTF document, parsed by tinygltf after our own checks. Its bytes are read later, see buffers.h and views.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <tiny_gltf.h>
#include <nlohmann/json_fwd.hpp>

#include "host/scene/gltf/container.h"

namespace wavepath::gltf {

using Bytes = std::span<const std::uint8_t>;

// Source of a buffer's or an image's bytes. `size`: a buffer's byteLength. `view`: an image's buffer view, or -1.
struct Source {
  std::string name, uri;
  std::uint64_t size = 0;
  int view = -1;
};

// tinygltf refuses valid files whose indices have no bufferView (Draco, sparse), so they are kept among the attributes.
inline constexpr const char* kIndices = "INDICES";

struct Document {
  std::filesystem::path path;
  std::string file;      // the path, for messages
  tinygltf::Model model; // without buffers, images and materials; every index in it is in range
  std::shared_ptr<const nlohmann::json> materials;
  std::vector<Source> buffers, images;
  // For each animation, the number of its channels that name no node; they are not in `model`.
  std::vector<std::size_t> nodeless_channels;
  std::vector<std::uint8_t> binary; // contents of buffer 0 of a .glb file

  // Contents of each buffer and of each compressed view; empty until needed.
  std::vector<std::vector<std::uint8_t>> loaded_buffers, decoded_views;

  [[noreturn]] void fail(const std::string& problem, const std::string& remedy = kRepair) const;
};

// Throws Error if the file is not sound glTF 2.0 or requires an extension that wavepath does not have.
Document open_document(const std::filesystem::path& path);

} // namespace wavepath::gltf
