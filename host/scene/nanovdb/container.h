// Segments of a NanoVDB file: the grids that it lists, and the bytes of each.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nanovdb/NanoVDB.h>

namespace wavepath::nvdb {

// A grid as its file lists it. Nothing is verified but that the stored bytes are there.
struct ListedGrid {
  std::string name; // fit for messages
  nanovdb::GridType type = nanovdb::GridType::Unknown;
  nanovdb::GridClass kind = nanovdb::GridClass::Unknown;
  std::uint16_t codec = 0;                // nanovdb::io::Codec
  std::uint64_t size = 0;                 // bytes, decompressed
  std::span<const std::uint8_t> stored{}; // within the file
};

// Grids of the file with these bytes, which must outlive them. `file`: for messages. Throws Error.
std::vector<ListedGrid> list_grids(const std::string& file, std::span<const std::uint8_t> bytes);

// The bytes of a grid: those of the file, or decompressed into `buffer`, which must outlive them. Throws Error.
std::span<const std::uint8_t> grid_bytes(const std::string& file, const ListedGrid& grid,
                                         std::vector<std::uint8_t>& buffer);

} // namespace wavepath::nvdb
