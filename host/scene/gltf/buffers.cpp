#include "host/scene/gltf/buffers.h"

#include "host/base/memory.h"
#include "host/base/read_file.h"
#include "host/scene/gltf/uri.h"

namespace wavepath::gltf {
namespace {

void load_buffer(Document& document, std::size_t buffer) {
  const Source& source = document.buffers[buffer];
  auto& bytes = document.loaded_buffers[buffer];
  const std::string what = "buffer " + std::to_string(buffer);
  if (source.view >= 0) {
    const tinygltf::BufferView& view = document.model.bufferViews[static_cast<std::size_t>(source.view)];
    if (!view.extensions.empty()) document.fail(what + " lies in a compressed buffer view");
    const Bytes lent = buffer_bytes(document, static_cast<std::size_t>(view.buffer), view.byteOffset, view.byteLength);
    bytes.assign(lent.begin(), lent.end());
  } else if (source.uri.empty()) {
    if (source.chunk < 0) document.fail(what + " has no data");
    bytes = std::move(document.chunks[static_cast<std::size_t>(source.chunk)]);
  } else {
    bytes = uri_bytes(document, what, source.uri, source.size);
  }
  if (bytes.size() < source.size) {
    document.fail(what + " holds " + std::to_string(bytes.size()) + " bytes instead of " + std::to_string(source.size));
  }
}

} // namespace

std::vector<std::uint8_t> uri_bytes(const Document& document, const std::string& what, const std::string& uri,
                                    std::uint64_t wanted) {
  if (is_data_uri(uri)) {
    UriData data = decode_data_uri(uri);
    if (!data.problem.empty()) document.fail(what + " has a malformed data URI: " + data.problem);
    if (data.is_text && wanted && data.bytes.size() != wanted)
      document.fail(what + " has a data URI of " + std::to_string(data.bytes.size()) + " bytes of text instead of " +
                        std::to_string(wanted) + " bytes",
                    "mark it as ';base64' if that is what it holds");
    return std::move(data.bytes);
  }
  const auto path = resolve_uri(document.path.parent_path(), uri);
  const auto size = path ? regular_file_size(*path) : std::nullopt;
  if (!size) document.fail(what + " '" + shown(uri) + "' is not there", "put it beside the file");
  if (*size < wanted) {
    document.fail(what + " '" + shown(uri) + "' is cut short: " + std::to_string(*size) + " of " +
                      std::to_string(wanted) + " bytes are there",
                  "copy or download it again");
  }
  const std::uint64_t length = wanted ? wanted : *size;
  require_memory(document.file, what + " '" + shown(uri) + "'", length, "use a machine with more memory");
  std::vector<std::uint8_t> bytes(length);
  if (!read_file(*path, 0, bytes))
    document.fail(what + " '" + shown(uri) + "' cannot be read", "check its permissions");
  return bytes;
}

Bytes buffer_bytes(Document& document, std::size_t buffer, std::uint64_t offset, std::uint64_t length) {
  if (length == 0) return {};
  if (offset + length > document.buffers[buffer].size) {
    document.fail("reads beyond the " + std::to_string(document.buffers[buffer].size) + " bytes of buffer " +
                  std::to_string(buffer));
  }
  if (document.loaded_buffers[buffer].empty()) load_buffer(document, buffer);
  return Bytes(document.loaded_buffers[buffer]).subspan(offset, length);
}

} // namespace wavepath::gltf
