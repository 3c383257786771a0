// The container: header, index, data format descriptor and metadata, each checked against the file.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "ktx/picture.h"

namespace wavepath::ktx {

enum class Supercompression : std::uint32_t { none = 0, basis_lz = 1, zstd = 2, zlib = 3 };

// Models of the data format descriptor that vkFormat 0 leaves to it.
enum class ColorModel : std::uint8_t { etc1s = 163, uastc = 166 };

struct Container {
  std::uint32_t vk_format = 0, width = 0, height = 0, level_count = 0;
  Supercompression supercompression = Supercompression::none;
  std::span<const std::uint8_t> level;   // level 0 as stored
  std::uint64_t uncompressed_length = 0; // of level 0; 0 for BasisLZ
  std::span<const std::uint8_t> global;  // supercompression global data
  std::uint8_t color_model = 0;          // KHR_DF_MODEL_*
  Transfer transfer = Transfer::linear;
  bool premultiplied = false;
  std::vector<std::uint8_t> channels; // KHR_DF_CHANNEL_* of each sample
  std::array<char, 4> swizzle{'r', 'g', 'b', 'a'};
};

// True if the file begins with the identifier of KTX2.
bool is_ktx2(std::span<const std::uint8_t> file);

// Throws FileError if the file is damaged, or is not a 2D picture.
Container read_container(std::span<const std::uint8_t> file);

} // namespace wavepath::ktx
