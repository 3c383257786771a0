#include "ktx/read.h"

#include <algorithm>
#include <string>

#include <tbb/parallel_for.h>

#include "ktx/astc.h"
#include "ktx/bc.h"
#include "ktx/bptc.h"
#include "ktx/container.h"
#include "ktx/error.h"
#include "ktx/etc1s.h"
#include "ktx/etc2.h"
#include "ktx/formats.h"
#include "ktx/inflate.h"
#include "ktx/plain.h"
#include "ktx/uastc.h"

namespace wavepath::ktx {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kMostBlockTexels = 144;                 // 12 x 12
constexpr std::uint64_t kMostTexels = std::uint64_t{1} << 40; // no product of sizes overflows, whatever `check` allows

const Format& format_of(const Container& container) {
  if (container.vk_format == 0) {
    if (container.color_model == static_cast<std::uint8_t>(ColorModel::uastc)) return kUastcFormat;
    throw FileError("has texels of colour model " + std::to_string(container.color_model) +
                    ", which wavepath does not support");
  }
  const Format* format = find_format(container.vk_format);
  if (!format)
    throw FileError("has texels of Vulkan's format " + std::to_string(container.vk_format) +
                    ", which wavepath does not support");
  return *format;
}

struct Grid {
  std::size_t blocks_x = 0, blocks_y = 0;
};

Grid grid_of(const Picture& picture, const Format& format) {
  return {(picture.width + format.block_width - 1) / format.block_width,
          (picture.height + format.block_height - 1) / format.block_height};
}

// Level 0 without supercompression: as many bytes as its blocks have.
std::vector<std::uint8_t> inflate(const Container& container, std::size_t length) {
  if (container.uncompressed_length != length)
    fail_damaged("level 0 has " + std::to_string(container.uncompressed_length) + " bytes instead of " +
                 std::to_string(length));
  if (container.supercompression == Supercompression::zstd) return inflate_zstd(container.level, length);
  return inflate_zlib(container.level, length);
}

// Decodes blocks in parallel. `decode` gets a block, and room for its texels, row by row.
template <class Sample, class Decode>
void decode_blocks(Picture& picture, const Format& format, Bytes data, std::vector<Sample>& samples,
                   const Decode& decode) {
  const Grid grid = grid_of(picture, format);
  const std::size_t width = picture.width;
  samples.resize(width * picture.height * 4);
  tbb::parallel_for(std::size_t{0}, grid.blocks_y, [&](std::size_t by) {
    Sample texels[kMostBlockTexels * 4];
    const std::size_t rows = std::min<std::size_t>(format.block_height, picture.height - by * format.block_height);
    for (std::size_t bx = 0; bx < grid.blocks_x; ++bx) {
      decode(&data[(by * grid.blocks_x + bx) * format.block_bytes], texels);
      const std::size_t columns = std::min<std::size_t>(format.block_width, width - bx * format.block_width);
      Sample* out = &samples[((by * format.block_height) * width + bx * format.block_width) * 4];
      for (std::size_t y = 0; y < rows; ++y)
        std::copy_n(texels + y * format.block_width * 4, columns * 4, out + y * width * 4);
    }
  });
}

void decode_texels(Picture& picture, const Format& format, Bytes data, bool srgb) {
  using In = const std::uint8_t*;
  const auto decode_bytes = [&](const auto& decode) { decode_blocks(picture, format, data, picture.bytes, decode); };
  const auto decode_words = [&](const auto& decode) { decode_blocks(picture, format, data, picture.words, decode); };
  const auto decode_floats = [&](const auto& decode) { decode_blocks(picture, format, data, picture.floats, decode); };
  if (decode_plain(format, data, picture)) return;
  switch (format.coding) {
    case Coding::uastc:
      return decode_bytes([&](In block, std::uint8_t* out) { decode_uastc_block(block, srgb, out); });
    case Coding::bc1_opaque:
      return decode_bytes([](In block, std::uint8_t* out) { decode_bc1_block(block, false, out); });
    case Coding::bc1:
      return decode_bytes([](In block, std::uint8_t* out) { decode_bc1_block(block, true, out); });
    case Coding::bc2:
      return decode_bytes(decode_bc2_block);
    case Coding::bc3:
      return decode_bytes(decode_bc3_block);
    case Coding::bc4:
      return decode_words([](In block, std::uint16_t* out) { decode_rgtc_block(block, 1, out); });
    case Coding::bc4_signed:
      return decode_floats([](In block, float* out) { decode_signed_rgtc_block(block, 1, out); });
    case Coding::bc5:
      return decode_words([](In block, std::uint16_t* out) { decode_rgtc_block(block, 2, out); });
    case Coding::bc5_signed:
      return decode_floats([](In block, float* out) { decode_signed_rgtc_block(block, 2, out); });
    case Coding::bc6h:
      return decode_floats([](In block, float* out) { decode_bc6h_block(block, false, out); });
    case Coding::bc6h_signed:
      return decode_floats([](In block, float* out) { decode_bc6h_block(block, true, out); });
    case Coding::bc7:
      return decode_bytes(decode_bc7_block);
    case Coding::etc2_rgb:
      return decode_bytes(decode_etc2_block);
    case Coding::etc2_rgba1:
      return decode_bytes(decode_etc2_punchthrough_block);
    case Coding::etc2_rgba:
      return decode_bytes(decode_etc2_rgba_block);
    case Coding::eac_r:
      return decode_words([](In block, std::uint16_t* out) { decode_eac_block(block, 1, out); });
    case Coding::eac_r_signed:
      return decode_floats([](In block, float* out) { decode_signed_eac_block(block, 1, out); });
    case Coding::eac_rg:
      return decode_words([](In block, std::uint16_t* out) { decode_eac_block(block, 2, out); });
    case Coding::eac_rg_signed:
      return decode_floats([](In block, float* out) { decode_signed_eac_block(block, 2, out); });
    case Coding::astc:
      return decode_bytes([&](In block, std::uint8_t* out) {
        decode_astc_block(block, format.block_width, format.block_height, srgb, out);
      });
    default: // decode_plain() decodes the others
      break;
  }
}

// UASTC carries two channels as RRRG (green in alpha) or RG, and says so in the descriptor.
void sort_uastc_channels(const Container& container, Picture& picture) {
  constexpr std::uint8_t kRedAndAlpha = 5, kRedAndGreen = 6;
  const std::uint8_t channel = container.channels.empty() ? 0 : container.channels[0];
  if (channel != kRedAndAlpha && channel != kRedAndGreen) return;
  for (std::size_t i = 0; i < picture.bytes.size(); i += 4) {
    std::uint8_t* texel = &picture.bytes[i];
    if (channel == kRedAndAlpha) texel[1] = texel[3];
    texel[2] = 0;
    texel[3] = 255;
  }
}

template <class Sample>
void apply_swizzle(const std::array<char, 4>& swizzle, std::vector<Sample>& samples, Sample one) {
  for (std::size_t i = 0; i < samples.size(); i += 4) {
    const std::array<Sample, 4> in{samples[i], samples[i + 1], samples[i + 2], samples[i + 3]};
    for (std::size_t c = 0; c < 4; ++c) {
      const std::size_t from = std::string_view("rgba").find(swizzle[c]);
      samples[i + c] = from < 4 ? in[from] : swizzle[c] == '1' ? one : Sample{0};
    }
  }
}

} // namespace

Picture read(Bytes file, const CheckSize& check) {
  const Container container = read_container(file);
  check(container.width, container.height);
  if (std::uint64_t{container.width} * container.height > kMostTexels)
    throw FileError("has " + std::to_string(container.width) + " x " + std::to_string(container.height) + " texels");
  Picture picture;
  picture.width = container.width;
  picture.height = container.height;
  picture.transfer = container.transfer;
  picture.premultiplied = container.premultiplied;
  if (container.supercompression == Supercompression::basis_lz) {
    if (container.color_model != static_cast<std::uint8_t>(ColorModel::etc1s))
      fail_damaged("BasisLZ, but not of ETC1S");
    picture.payload = "ETC1S";
    picture.bytes.resize(std::size_t{picture.width} * picture.height * 4);
    decode_etc1s(container, picture.bytes.data());
  } else {
    const Format& format = format_of(container);
    picture.payload = format.name;
    if (format.srgb) picture.transfer = Transfer::srgb;
    const Grid grid = grid_of(picture, format);
    const std::size_t length = grid.blocks_x * grid.blocks_y * format.block_bytes;
    std::vector<std::uint8_t> inflated;
    Bytes data = container.level;
    if (container.supercompression != Supercompression::none) data = inflated = inflate(container, length);
    if (data.size() != length)
      fail_damaged("level 0 has " + std::to_string(data.size()) + " bytes instead of " + std::to_string(length));
    decode_texels(picture, format, data, picture.transfer == Transfer::srgb);
    if (format.coding == Coding::uastc) sort_uastc_channels(container, picture);
  }
  if (container.swizzle != std::array<char, 4>{'r', 'g', 'b', 'a'}) {
    apply_swizzle(container.swizzle, picture.bytes, std::uint8_t{255});
    apply_swizzle(container.swizzle, picture.words, std::uint16_t{65535});
    apply_swizzle(container.swizzle, picture.floats, 1.0f);
  }
  return picture;
}

} // namespace wavepath::ktx
