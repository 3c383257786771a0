#include "host/scene/gltf/views.h"

#include "host/scene/gltf/buffers.h"
#include "host/scene/gltf/meshopt.h"

namespace wavepath::gltf {

Bytes view_bytes(Document& document, std::size_t view) {
  const tinygltf::BufferView& source = document.model.bufferViews[view];
  if (is_meshopt(source)) {
    if (document.decoded_views[view].empty()) document.decoded_views[view] = decode_meshopt(document, view);
    return document.decoded_views[view];
  }
  return buffer_bytes(document, static_cast<std::size_t>(source.buffer), source.byteOffset, source.byteLength);
}

std::vector<std::uint8_t> image_bytes(Document& document, std::size_t image) {
  const Source& source = document.images[image];
  const std::string what = "image " + std::to_string(image);
  if (source.view >= 0) {
    const Bytes bytes = view_bytes(document, static_cast<std::size_t>(source.view));
    return {bytes.begin(), bytes.end()};
  }
  if (source.uri.empty()) document.fail(what + " has neither a URI nor a buffer view");
  return uri_bytes(document, what, source.uri, 0);
}

} // namespace wavepath::gltf
