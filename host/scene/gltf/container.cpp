// Splits a glTF file into its chunks (glTF 2.0 specification, chapter 4: GLB file format).
#include "host/scene/gltf/container.h"

#include <algorithm>
#include <cstring>

#include "host/base/error.h"
#include "host/base/read_file.h"

namespace wavepath::gltf {
namespace {

constexpr std::uint64_t kMaxJsonBytes = std::uint64_t{1} << 30;
constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 32; // the length field of a .glb has 32 bits
// A parsed JSON value takes about 50 bytes, so this many stay below 2 GiB.
constexpr std::uint64_t kMaxJsonValues = 40'000'000;
// Valid files need about 10 levels (extensions inside texture references); parsers recurse.
constexpr int kMaxJsonDepth = 64;

struct Header {
  char magic[4];
  std::uint32_t version, length;
};
struct ChunkHeader {
  std::uint32_t length, type;
};
constexpr std::uint32_t kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;

void read_or_fail(const std::filesystem::path& path, std::uint64_t offset, std::span<std::uint8_t> out) {
  if (!read_file(path, offset, out)) throw Error(path.string(), "cannot be read", "check its permissions and the disk");
}

template <typename T>
T read_struct(const std::filesystem::path& path, std::uint64_t offset) {
  std::uint8_t bytes[sizeof(T)];
  read_or_fail(path, offset, bytes);
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

Container read_glb(const std::filesystem::path& path, std::uint64_t size) {
  const std::string file = path.string();
  const auto header = read_struct<Header>(path, 0);
  if (header.version != 2) {
    throw Error(file, "has GLB version " + std::to_string(header.version), "convert it to glTF 2.0");
  }
  if (header.length > size) {
    throw Error(file,
                "is cut short: " + std::to_string(size) + " of " + std::to_string(header.length) + " bytes are there",
                "copy or download it again");
  }
  Container container;
  std::uint64_t offset = sizeof(Header);
  for (int chunk = 0; offset + sizeof(ChunkHeader) <= header.length; ++chunk) {
    const auto head = read_struct<ChunkHeader>(path, offset);
    offset += sizeof(ChunkHeader);
    if (head.length > header.length - offset) {
      throw Error(file, "chunk " + std::to_string(chunk) + " reaches beyond the end of the file",
                  "copy or download it again");
    }
    if (chunk == 0 && (head.type != kJsonChunk || head.length > kMaxJsonBytes)) {
      throw Error(file, "does not begin with a JSON chunk of reasonable size", kRepair);
    }
    if (chunk == 0) {
      container.json.resize(head.length);
      read_or_fail(path, offset, {reinterpret_cast<std::uint8_t*>(container.json.data()), head.length});
    } else if (chunk == 1 && head.type == kBinaryChunk) {
      container.binary.resize(head.length);
      read_or_fail(path, offset, container.binary);
    }
    offset += head.length;
  }
  return container;
}

// Rejects text that would exhaust the stack or the memory of a JSON parser. Does not check the grammar.
void check_json_size(const std::string& file, const std::string& json) {
  int depth = 0;
  std::uint64_t values = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
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

} // namespace

Container read_container(const std::filesystem::path& path) {
  const std::string file = path.string();
  const auto size = regular_file_size(path);
  if (!size) throw Error(file, "is not a file that can be opened", "check the path");
  if (*size > kMaxFileBytes) throw Error(file, "is larger than 4 GiB", "move its data into .bin files beside a .gltf");
  if (*size < sizeof(Header)) throw Error(file, "is too short to be glTF", "copy or download it again");

  Container container;
  if (std::memcmp(read_struct<Header>(path, 0).magic, "glTF", 4) == 0) {
    container = read_glb(path, *size);
  } else {
    if (*size > kMaxJsonBytes)
      throw Error(file, "holds more than 1 GiB of JSON", "move its data into .bin files or a .glb");
    container.json.resize(*size);
    read_or_fail(path, 0, {reinterpret_cast<std::uint8_t*>(container.json.data()), container.json.size()});
    if (container.json.starts_with("\xef\xbb\xbf")) container.json.erase(0, 3);
  }
  const auto first = container.json.find_first_not_of(" \t\r\n");
  if (first == std::string::npos || container.json[first] != '{') {
    throw Error(file, "is not glTF: neither a JSON object nor a .glb", "give a .gltf or .glb file");
  }
  check_json_size(file, container.json);
  return container;
}

} // namespace wavepath::gltf
