// The payloads that are read: names, sizes of blocks and coding of each format of Vulkan.
#pragma once

#include <cstdint>

namespace wavepath::ktx {

enum class Coding : std::uint8_t {
  // Texels: 1 to 4 channels of unsigned normalized bytes or words, of signed bytes or words, of floats
  bytes,
  signed_bytes,
  words,
  signed_words,
  halves,
  floats,
  shared_exponent, // E5B9G9R9
  small_floats,    // B10G11R11
  uastc,
  bc1_opaque,
  bc1,
  bc2,
  bc3,
  bc4,
  bc4_signed,
  bc5,
  bc5_signed,
  bc6h,
  bc6h_signed,
  bc7,
  etc2_rgb,
  etc2_rgba1,
  etc2_rgba,
  eac_r,
  eac_r_signed,
  eac_rg,
  eac_rg_signed,
  astc
};

struct Format {
  std::uint32_t vk_format = 0;
  const char* name = "";
  Coding coding = Coding::bytes;
  std::uint8_t block_width = 1, block_height = 1, block_bytes = 1;
  std::uint8_t channels = 4; // of texels that are not compressed
  bool bgr = false;          // blue comes first
  bool srgb = false;         // by its name
};

// Nothing if this payload is not read.
const Format* find_format(std::uint32_t vk_format);

extern const Format kUastcFormat;

} // namespace wavepath::ktx
