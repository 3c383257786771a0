#include "host/scene/nanovdb/container.h"

#include <algorithm>
#include <cstring>

#include <blosc.h>
#include <fmt/format.h>
#include <nanovdb/util/IO.h>
#include <zlib.h>

#include "host/base/error.h"
#include "host/base/memory.h"

namespace wavepath::nvdb {
namespace {

using nanovdb::io::Codec;

constexpr const char* kCopyAgain = "copy or download it again";
// Files of OpenVDB begin with this, and those of NanoVDB with one of the others: that of versions up to 32.5, and that
// of later ones.
constexpr std::uint64_t kOpenVdbMagic = 0x56444220;
constexpr std::uint64_t kOldMagic = NANOVDB_MAGIC_NUMBER, kNewMagic = 0x324244566f6e614e;
// Deflate makes at most 1032 bytes of one, and LZ4 255.
constexpr std::uint64_t kMostRatio = 1100;

// The bytes that are still to be read.
struct Cursor {
  const std::string& file;
  std::span<const std::uint8_t> rest;

  std::span<const std::uint8_t> take(std::uint64_t size) {
    if (size > rest.size()) throw Error(file, "is cut short", kCopyAgain);
    const auto bytes = rest.first(size);
    rest = rest.subspan(size);
    return bytes;
  }
  template <class T>
  T read() {
    T value;
    std::memcpy(static_cast<void*>(&value), take(sizeof(T)).data(), sizeof(T));
    return value;
  }
};

void check_header(const std::string& file, const nanovdb::io::Header& header) {
  if (header.magic == kOpenVdbMagic)
    throw Error(file, "is a file of OpenVDB", "convert it by nanovdb_convert FILE.vdb FILE.nvdb");
  if (header.magic != kOldMagic && header.magic != kNewMagic)
    throw Error(file, "is no NanoVDB file", "give a .nvdb, such as nanovdb_convert FILE.vdb FILE.nvdb writes");
  if (header.version.getMajor() != NANOVDB_MAJOR_VERSION_NUMBER)
    throw Error(file,
                fmt::format("has version {} of NanoVDB, where {} is read", header.version.getMajor(),
                            NANOVDB_MAJOR_VERSION_NUMBER),
                "convert it anew by nanovdb_convert FILE.vdb FILE.nvdb");
  if (header.codec >= Codec::END)
    throw Error(file, fmt::format("has unknown codec {}", static_cast<unsigned>(header.codec)),
                "write it without compression");
}

// On one line, and not too long.
std::string printable(std::span<const std::uint8_t> text) {
  std::string name;
  for (const std::uint8_t c : text.first(std::min<std::size_t>(text.size(), 100))) {
    if (c == 0) break;
    name += c < 0x20 || c == 0x7f ? '?' : static_cast<char>(c);
  }
  return name;
}

[[noreturn]] void fail_unpacked(const std::string& file, const ListedGrid& grid) {
  throw Error(file, fmt::format("the compressed data of its grid '{}' are damaged", grid.name), kCopyAgain);
}

void inflate_grid(const std::string& file, const ListedGrid& grid, std::span<std::uint8_t> out) {
  Cursor cursor{file, grid.stored};
  const auto packed = cursor.take(cursor.read<std::uint64_t>());
  uLongf size = out.size();
  if (uncompress(out.data(), &size, packed.data(), packed.size()) != Z_OK || size != out.size())
    fail_unpacked(file, grid);
}

void unblosc_grid(const std::string& file, const ListedGrid& grid, std::span<std::uint8_t> out) {
  Cursor cursor{file, grid.stored};
  while (!out.empty()) {
    const std::size_t size = std::min<std::size_t>(out.size(), nanovdb::io::Internal::MAX_SIZE);
    const auto packed = cursor.take(cursor.read<std::uint64_t>());
    std::size_t unpacked = 0;
    if (packed.size() < BLOSC_MIN_HEADER_LENGTH ||
        blosc_cbuffer_validate(packed.data(), packed.size(), &unpacked) != 0 || unpacked != size ||
        blosc_decompress_ctx(packed.data(), out.data(), size, 1) != static_cast<int>(size))
      fail_unpacked(file, grid);
    out = out.subspan(size);
  }
}

} // namespace

std::vector<ListedGrid> list_grids(const std::string& file, std::span<const std::uint8_t> bytes) {
  std::vector<ListedGrid> grids;
  Cursor cursor{file, bytes};
  do {
    nanovdb::io::Header header;
    header.magic = 0;
    if (cursor.rest.size() >= sizeof(header)) header = cursor.read<nanovdb::io::Header>();
    check_header(file, header);
    const std::size_t first = grids.size();
    std::vector<std::uint64_t> sizes;
    for (unsigned i = 0; i < header.gridCount; ++i) {
      const auto meta = cursor.read<nanovdb::io::MetaData>();
      grids.push_back({printable(cursor.take(meta.nameSize)), meta.gridType, meta.gridClass,
                       static_cast<std::uint16_t>(header.codec), meta.gridSize});
      sizes.push_back(meta.fileSize);
    }
    for (std::size_t i = 0; i < sizes.size(); ++i) grids[first + i].stored = cursor.take(sizes[i]);
  } while (cursor.rest.size() >= sizeof(nanovdb::io::Header));
  return grids;
}

std::span<const std::uint8_t> grid_bytes(const std::string& file, const ListedGrid& grid,
                                         std::vector<std::uint8_t>& buffer) {
  const auto codec = static_cast<Codec>(grid.codec);
  const std::uint64_t most = grid.stored.size() * (codec == Codec::NONE ? 1 : kMostRatio);
  if (grid.size > most)
    throw Error(file, fmt::format("its grid '{}' is of {} bytes, more than it can hold", grid.name, grid.size),
                kCopyAgain);
  if (codec == Codec::NONE) return grid.stored.first(grid.size);
  require_memory(file, fmt::format("its grid '{}'", grid.name), grid.size, "choose a smaller file");
  buffer.resize(grid.size);
  (codec == Codec::ZIP ? inflate_grid : unblosc_grid)(file, grid, buffer);
  return buffer;
}

} // namespace wavepath::nvdb
