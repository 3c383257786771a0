// Decompresses with meshoptimizer, whose preconditions are checked first.
#include "host/scene/gltf/meshopt.h"

#include <meshoptimizer.h>

#include "host/base/memory.h"
#include "host/scene/gltf/buffers.h"

namespace wavepath::gltf {
namespace {

// First byte of attributes in the newer of the two encodings that KHR_meshopt_compression has.
constexpr std::uint8_t kVersion1 = 0xa1;
constexpr const char* kOlder = "export it with EXT_meshopt_compression";

const tinygltf::Value* extension_of(const tinygltf::BufferView& view) {
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
    if (const auto found = view.extensions.find(name); found != view.extensions.end()) return &found->second;
  return nullptr;
}

struct Meshopt {
  std::size_t buffer, offset, length, stride, count;
  std::string mode, filter;
};

Meshopt read_meshopt(const tinygltf::Value& value) {
  const auto number = [&](const char* name) { return static_cast<std::size_t>(value.Get(name).GetNumberAsInt()); };
  const auto text = [&](const char* name, const char* otherwise) {
    return value.Has(name) ? value.Get(name).Get<std::string>() : std::string(otherwise);
  };
  return {number("buffer"),      value.Has("byteOffset") ? number("byteOffset") : 0,
          number("byteLength"),  number("byteStride"),
          number("count"),       text("mode", ""),
          text("filter", "NONE")};
}

// The library asserts on strides; the ratios are the best that its formats can reach, so that a few bytes cannot ask
// for gigabytes: 4 bytes of header for 256 values of each byte channel, one byte a triangle, one byte an index.
bool is_plausible(const Meshopt& view) {
  if (view.mode == "ATTRIBUTES") {
    const bool stride = view.stride > 0 && view.stride <= 256 && view.stride % 4 == 0;
    return stride && view.count / 64 * view.stride <= view.length;
  }
  const bool stride = view.stride == 2 || view.stride == 4;
  if (view.mode == "TRIANGLES") return stride && view.count % 3 == 0 && view.count / 3 <= view.length;
  return view.mode == "INDICES" && stride && view.count <= view.length;
}

bool is_filter_sound(const Meshopt& view) {
  if (view.filter == "NONE") return true;
  if (view.mode != "ATTRIBUTES") return false;
  if (view.filter == "OCTAHEDRAL") return view.stride == 4 || view.stride == 8;
  if (view.filter == "QUATERNION") return view.stride == 8;
  return view.filter == "EXPONENTIAL" && view.stride % 4 == 0;
}

} // namespace

bool is_meshopt(const tinygltf::BufferView& view) { return extension_of(view) != nullptr; }

std::vector<std::uint8_t> decode_meshopt(Document& document, std::size_t index) {
  const std::string what = "buffer view " + std::to_string(index);
  const Meshopt view = read_meshopt(*extension_of(document.model.bufferViews[index]));
  if (view.filter == "COLOR") document.fail(what + " has meshopt filter COLOR, which wavepath does not know", kOlder);
  if (!is_plausible(view)) document.fail(what + " has a meshopt mode, stride or count that its data cannot have");
  if (!is_filter_sound(view)) document.fail(what + " has a meshopt filter that does not fit its mode or stride");
  const Bytes bytes = buffer_bytes(document, view.buffer, view.offset, view.length);
  if (view.mode == "ATTRIBUTES" && !bytes.empty() && bytes[0] == kVersion1)
    document.fail(what + " holds meshopt data of version 1, of which wavepath knows version 0", kOlder);
  require_memory(document.file, what, view.count * view.stride, "use a machine with more memory");
  std::vector<std::uint8_t> out(view.count * view.stride);
  int failed = 0;
  if (view.mode == "ATTRIBUTES")
    failed = meshopt_decodeVertexBuffer(out.data(), view.count, view.stride, bytes.data(), bytes.size());
  if (view.mode == "TRIANGLES")
    failed = meshopt_decodeIndexBuffer(out.data(), view.count, view.stride, bytes.data(), bytes.size());
  if (view.mode == "INDICES")
    failed = meshopt_decodeIndexSequence(out.data(), view.count, view.stride, bytes.data(), bytes.size());
  if (failed) document.fail(what + " holds damaged meshopt data");
  if (view.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), view.count, view.stride);
  if (view.filter == "QUATERNION") meshopt_decodeFilterQuat(out.data(), view.count, view.stride);
  if (view.filter == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), view.count, view.stride);
  return out;
}

} // namespace wavepath::gltf
