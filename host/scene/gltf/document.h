// A glTF document: parsed by tinygltf after our own checks, with its bytes brought in only when something asks for
// them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <tiny_gltf.h>

#include "host/scene/gltf/container.h"

namespace wavepath::gltf {

using Bytes = std::span<const std::uint8_t>;

// Where a buffer or an image comes from. `size` is a buffer's byteLength; `view` an image's buffer view or -1.
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
  std::vector<std::uint8_t> binary; // of a .glb: the contents of buffer 0

  // Contents by buffer and by compressed view, empty until asked for.
  std::vector<std::vector<std::uint8_t>> loaded_buffers, decoded_views;

  [[noreturn]] void fail(const std::string& problem, const std::string& remedy = kRepair) const;
};

// Throws Error if the file is not sound glTF 2.0 or requires an extension that wavepath does not have.
Document open_document(const std::filesystem::path& path);

// The bytes of a buffer from `offset` on, `length` of them; the buffer is read at its first use. Throws Error.
Bytes buffer_bytes(Document& document, std::size_t buffer, std::uint64_t offset, std::uint64_t length);

// The whole contents of a buffer view, decompressed if need be; they live as long as the document. Throws Error.
Bytes view_bytes(Document& document, std::size_t view);

// The file of an image as stored: from its URI or its buffer view. Throws Error.
std::vector<std::uint8_t> image_bytes(Document& document, std::size_t image);

} // namespace wavepath::gltf
