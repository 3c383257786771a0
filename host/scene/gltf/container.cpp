// Splits a glTF file into its chunks (glTF 2.0 specification, chapter 4, and draft of glTF 2.1: GLB file format).
#include "host/scene/gltf/container.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <optional>

#include "host/base/error.h"
#include "host/base/memory.h"
#include "host/base/read_file.h"
#include "host/scene/gltf/foreign.h"

namespace wavepath::gltf {
namespace {

constexpr std::uint64_t kMaxJsonBytes = std::uint64_t{1} << 30;
// A parsed JSON value takes about 50 bytes, so this many stay below 2 GiB.
constexpr std::uint64_t kMaxJsonValues = 40'000'000;
// Valid files need about 10 levels (extensions inside texture references); parsers recurse.
constexpr int kMaxJsonDepth = 64;

constexpr std::uint32_t kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;

// Bytes of a file on disk or in memory.
struct FileBytes {
  std::string file;
  std::uint64_t size = 0;
  std::function<bool(std::uint64_t offset, std::span<std::uint8_t> out)> read;

  void read_or_fail(std::uint64_t offset, std::span<std::uint8_t> out) const {
    if (!read(offset, out)) throw Error(file, "cannot be read", "check its permissions and the disk");
  }
  template <typename T>
  T value(std::uint64_t offset) const {
    std::uint8_t bytes[sizeof(T)];
    read_or_fail(offset, bytes);
    T result;
    std::memcpy(&result, bytes, sizeof(T));
    return result;
  }
};

// Version 2 has lengths of 32 bits, version 3 of 64 bits, and an encoding of each chunk.
struct Chunk {
  std::uint32_t type = 0, encoding = 0;
  std::uint64_t length = 0;
};
struct Layout {
  std::uint64_t header = 0, chunk_header = 0, alignment = 0;
};
constexpr Layout kLayouts[] = {{12, 8, 4}, {16, 16, 8}}; // versions 2 and 3

Chunk read_chunk_header(const FileBytes& bytes, std::uint32_t version, std::uint64_t offset) {
  if (version == 2) return {bytes.value<std::uint32_t>(offset + 4), 0, bytes.value<std::uint32_t>(offset)};
  return {bytes.value<std::uint32_t>(offset), bytes.value<std::uint32_t>(offset + 4),
          bytes.value<std::uint64_t>(offset + 8)};
}

// Whether a buffer may lie in this chunk: the one after the JSON, and in version 3 any that the JSON names.
bool holds_buffer(std::uint32_t version, std::uint64_t number, const Chunk& chunk) {
  return chunk.type == kBinaryChunk && (version == 3 || number == 1);
}

Container read_glb(const FileBytes& bytes) {
  Container container;
  container.version = bytes.value<std::uint32_t>(4);
  if (container.version != 2 && container.version != 3)
    throw Error(bytes.file, "has GLB version " + std::to_string(container.version), "convert it to glTF 2.0");
  const Layout layout = kLayouts[container.version - 2];
  const std::uint64_t size = bytes.size;
  if (size < layout.header) throw Error(bytes.file, "is too short to be glTF", "copy or download it again");
  const std::uint64_t length = container.version == 2 ? bytes.value<std::uint32_t>(8) : bytes.value<std::uint64_t>(8);
  if (length > size) {
    throw Error(bytes.file,
                "is cut short: " + std::to_string(size) + " of " + std::to_string(length) + " bytes are there",
                "copy or download it again");
  }
  bool has_json = false;
  std::uint64_t offset = layout.header;
  for (std::uint64_t number = 0; offset + layout.chunk_header <= length; ++number) {
    const Chunk chunk = read_chunk_header(bytes, container.version, offset);
    const std::string what = "chunk " + std::to_string(number);
    offset += layout.chunk_header;
    if (chunk.length > length - offset)
      throw Error(bytes.file, what + " reaches beyond the end of the file", "copy or download it again");
    const bool is_json = chunk.type == kJsonChunk && !has_json;
    if (!has_json && (is_json ? chunk.length > kMaxJsonBytes : container.version == 2))
      throw Error(bytes.file, "does not begin with a JSON chunk of reasonable size", kRepair);
    const bool is_buffer = holds_buffer(container.version, number, chunk);
    if (chunk.encoding != 0 && (is_json || is_buffer))
      throw Error(bytes.file,
                  what + " has encoding " + std::to_string(chunk.encoding) + ", which wavepath does not know",
                  "export it without compressed or encrypted chunks");
    if (is_json) {
      has_json = true;
      container.json.resize(chunk.length);
      bytes.read_or_fail(offset, {reinterpret_cast<std::uint8_t*>(container.json.data()), container.json.size()});
    } else if (is_buffer) {
      require_memory(bytes.file, what, chunk.length, "use a machine with more memory");
      std::vector<std::uint8_t>& contents = container.chunks[number];
      contents.resize(chunk.length);
      bytes.read_or_fail(offset, contents);
    }
    offset += chunk.length;
    // Version 2 counts the padding among the chunk's bytes, version 3 may leave it behind them.
    if (container.version == 3) offset = (offset + layout.alignment - 1) / layout.alignment * layout.alignment;
  }
  if (!has_json && container.version == 3) throw Error(bytes.file, "holds no JSON chunk", kRepair);
  return container;
}

// Rejects text that would exhaust the stack or the memory of a JSON parser. Does not check the grammar.
void check_json_size(const std::string& file, const std::string& text) {
  int depth = 0;
  std::uint64_t values = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      ++values;
      if (++depth > kMaxJsonDepth) {
        throw Error(file, "its JSON nests deeper than " + std::to_string(kMaxJsonDepth) + " levels", kRepair);
      }
    } else if (c == '}' || c == ']') {
      --depth;
    } else if (c == ',') {
      ++values;
    }
  }
  if (values > kMaxJsonValues) throw Error(file, "its JSON holds " + std::to_string(values) + " values", kRepair);
}

Container read(const FileBytes& bytes) {
  const std::string& file = bytes.file;
  if (bytes.size < kLayouts[0].header) throw Error(file, "is too short to be glTF", "copy or download it again");
  std::uint8_t magic[4];
  bytes.read_or_fail(0, magic);
  Container container;
  if (std::memcmp(magic, "glTF", 4) == 0) {
    container = read_glb(bytes);
  } else {
    if (bytes.size > kMaxJsonBytes)
      throw Error(file, "holds more than 1 GiB of JSON", "move its data into .bin files or a .glb");
    container.json.resize(bytes.size);
    bytes.read_or_fail(0, {reinterpret_cast<std::uint8_t*>(container.json.data()), container.json.size()});
    if (container.json.starts_with("\xef\xbb\xbf")) container.json.erase(0, 3);
  }
  const auto first = container.json.find_first_not_of(" \t\r\n");
  if (first == std::string::npos || container.json[first] != '{') {
    throw Error(file, "is not glTF: neither a JSON object nor a .glb", "give a .gltf or .glb file");
  }
  check_json_size(file, container.json);
  return container;
}

} // namespace

Container read_container(const std::filesystem::path& path) {
  const auto size = regular_file_size(path);
  if (!size) throw Error(path.string(), "is not a file that can be opened", "check the path");
  if (const std::optional<ForeignFile> foreign = foreign_file(path))
    throw Error(path.string(), foreign->what + ", not glTF", "convert it: " + foreign->command);
  return read({path.string(), *size,
               [&](std::uint64_t offset, std::span<std::uint8_t> out) { return read_file(path, offset, out); }});
}

Container read_container(const std::string& file, std::span<const std::uint8_t> bytes) {
  return read({file, bytes.size(), [&](std::uint64_t offset, std::span<std::uint8_t> out) {
                 if (offset > bytes.size() || out.size() > bytes.size() - offset) return false;
                 std::ranges::copy(bytes.subspan(offset, out.size()), out.begin());
                 return true;
               }});
}

} // namespace wavepath::gltf
