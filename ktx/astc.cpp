#include "ktx/astc.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "ktx/astc_parts.h"

namespace wavepath::ktx {
namespace {

constexpr unsigned kMostWeights = 64, kMostSide = 12;
constexpr std::array<std::uint8_t, 4> kAstcError = {255, 0, 255, 255};

struct WeightGrid {
  unsigned width = 0, height = 0;
  bool two_planes = false;
  IntegerRange range;

  unsigned count() const { return width * height * (two_planes ? 2 : 1); }
};

// Table "ASTC 2D block mode layout". Nothing if the mode is reserved.
std::optional<WeightGrid> read_block_mode(std::uint32_t mode) {
  constexpr std::array<IntegerRange, 12> kRanges = {{{0, 0, 1},
                                                     {1, 0, 0},
                                                     {0, 0, 2},
                                                     {0, 1, 0},
                                                     {1, 0, 1},
                                                     {0, 0, 3},
                                                     {0, 1, 1},
                                                     {1, 0, 2},
                                                     {0, 0, 4},
                                                     {0, 1, 2},
                                                     {1, 0, 3},
                                                     {0, 0, 5}}};
  const auto bits = [&](unsigned first, unsigned count) { return mode >> first & ((1u << count) - 1); };
  WeightGrid grid;
  bool precise = bits(9, 1) != 0; // P
  grid.two_planes = bits(10, 1) != 0;
  std::uint32_t range = bits(4, 1); // rho
  const unsigned a = bits(5, 2), b = bits(7, 2);
  if (bits(0, 2) != 0) {
    range |= bits(0, 2) << 1;
    switch (bits(2, 2)) {
      case 0:
        grid.width = b + 4;
        grid.height = a + 2;
        break;
      case 1:
        grid.width = b + 8;
        grid.height = a + 2;
        break;
      case 2:
        grid.width = a + 2;
        grid.height = b + 8;
        break;
      default:
        grid.width = bits(8, 1) ? bits(7, 1) + 2 : a + 2;
        grid.height = bits(8, 1) ? a + 2 : bits(7, 1) + 6;
        break;
    }
  } else {
    range |= bits(2, 2) << 1;
    switch (b) {
      case 0:
        grid.width = 12;
        grid.height = a + 2;
        break;
      case 1:
        grid.width = a + 2;
        grid.height = 12;
        break;
      case 2:
        grid.width = a + 6;
        grid.height = bits(9, 2) + 6;
        precise = grid.two_planes = false;
        break;
      default:
        if (a > 1) return std::nullopt;
        grid.width = a == 0 ? 6 : 10;
        grid.height = a == 0 ? 10 : 6;
        break;
    }
  }
  if (range < 2) return std::nullopt;
  grid.range = kRanges[range - 2 + (precise ? 6 : 0)];
  return grid;
}

std::uint64_t reversed(std::uint64_t word) {
  std::uint64_t result = 0;
  for (unsigned i = 0; i < 64; ++i) result |= (word >> i & 1) << (63 - i);
  return result;
}

struct Partitions {
  unsigned count = 1;
  std::uint32_t seed = 0;
  std::array<std::uint8_t, 4> endpoint_modes{};
  unsigned first_color_bit = 17, extra_bits = 0; // of endpoint modes, below the weights
};

// Configuration behind the block mode. `weights_end`: the first bit of the weights.
Partitions read_partitions(const BlockBits& bits, unsigned weights_end) {
  Partitions partitions;
  partitions.count = bits.at(11, 2) + 1;
  if (partitions.count == 1) {
    partitions.endpoint_modes[0] = static_cast<std::uint8_t>(bits.at(13, 4));
    return partitions;
  }
  partitions.seed = bits.at(13, 10);
  partitions.first_color_bit = 29;
  const std::uint32_t shared_class = bits.at(23, 2);
  if (shared_class == 0) {
    partitions.endpoint_modes.fill(static_cast<std::uint8_t>(bits.at(25, 4)));
    return partitions;
  }
  // A class bit C of each partition, then two bits M of each. The first 4 of these bits lie here, the others below the
  // weights.
  partitions.extra_bits = 3 * partitions.count - 4;
  const std::uint32_t fields = bits.at(25, 4) | bits.at(weights_end - partitions.extra_bits, partitions.extra_bits)
                                                    << 4;
  for (unsigned i = 0; i < partitions.count; ++i) {
    const std::uint32_t upper = shared_class - 1 + (fields >> i & 1);
    const std::uint32_t mode = upper << 2 | (fields >> (partitions.count + 2 * i) & 3);
    partitions.endpoint_modes[i] = static_cast<std::uint8_t>(mode);
  }
  return partitions;
}

using Rgba = std::array<int, 4>;

// Moves the highest bit of a to b; a becomes a signed number of 6 bits.
void transfer_bit(int& a, int& b) {
  b = b >> 1 | (a & 0x80);
  a = a >> 1 & 0x3f;
  if (a & 0x20) a -= 0x40;
}

Rgba contract_blue(const Rgba& c) { return {(c[0] + c[2]) >> 1, (c[1] + c[2]) >> 1, c[2], c[3]}; }

// An endpoint pair of the LDR modes. Nothing for modes of HDR.
std::optional<EndpointPair> endpoint_pair(unsigned mode, const std::uint8_t* values) {
  std::array<int, 8> v{};
  std::copy_n(values, 2 * (mode / 4 + 1), v.begin());
  Rgba from{}, to{};
  const auto scaled = [&](int channel) { return channel * v[3] >> 8; };
  switch (mode) {
    case 0:
      from = {v[0], v[0], v[0], 255};
      to = {v[1], v[1], v[1], 255};
      break;
    case 1: {
      const int low = v[0] >> 2 | (v[1] & 0xc0), high = low + (v[1] & 0x3f);
      from = {low, low, low, 255};
      to = {high, high, high, 255};
      break;
    }
    case 4:
      from = {v[0], v[0], v[0], v[2]};
      to = {v[1], v[1], v[1], v[3]};
      break;
    case 5:
      transfer_bit(v[1], v[0]);
      transfer_bit(v[3], v[2]);
      from = {v[0], v[0], v[0], v[2]};
      to = {v[0] + v[1], v[0] + v[1], v[0] + v[1], v[2] + v[3]};
      break;
    case 6:
      from = {scaled(v[0]), scaled(v[1]), scaled(v[2]), 255};
      to = {v[0], v[1], v[2], 255};
      break;
    case 8:
    case 12: {
      if (mode == 8) v[6] = v[7] = 255;
      from = {v[0], v[2], v[4], v[6]};
      to = {v[1], v[3], v[5], v[7]};
      if (v[1] + v[3] + v[5] < v[0] + v[2] + v[4]) {
        const Rgba first = contract_blue(to);
        to = contract_blue(from);
        from = first;
      }
      break;
    }
    case 9:
    case 13: {
      for (std::size_t i = 0; i < (mode == 9 ? 6u : 8u); i += 2) transfer_bit(v[i + 1], v[i]);
      if (mode == 9) {
        v[6] = 255;
        v[7] = 0;
      }
      from = {v[0], v[2], v[4], v[6]};
      to = {v[0] + v[1], v[2] + v[3], v[4] + v[5], v[6] + v[7]};
      if (v[1] + v[3] + v[5] < 0) {
        const Rgba first = contract_blue(to);
        to = contract_blue(from);
        from = first;
      }
      break;
    }
    case 10:
      from = {scaled(v[0]), scaled(v[1]), scaled(v[2]), v[4]};
      to = {v[0], v[1], v[2], v[5]};
      break;
    default:
      return std::nullopt;
  }
  EndpointPair pair;
  for (std::size_t c = 0; c < 4; ++c) {
    pair.from[c] = clamp_to_byte(from[c]);
    pair.to[c] = clamp_to_byte(to[c]);
  }
  return pair;
}

// Weights of the grid, both planes; behind them zeros, because texels at the edge read one more row and column with a
// factor of 0.
using GridWeights = std::array<std::array<std::uint8_t, kMostWeights + kMostSide + 1>, 2>;

GridWeights read_weights(const BlockBits& bits, const WeightGrid& grid) {
  const BlockBits downwards{reversed(bits.high), reversed(bits.low)}; // weights grow from bit 127 down
  std::array<std::uint8_t, kMostWeights> values{};
  read_integers(downwards, 0, grid.range, grid.count(), values.data());
  GridWeights weights{};
  const unsigned planes = grid.two_planes ? 2 : 1;
  for (unsigned i = 0; i < grid.count(); ++i)
    weights[i % planes][i / planes] = unquantize_weight(grid.range, values[i]);
  return weights;
}

// Where a column or a row of texels lies between those of the grid: 4 bits of fraction.
std::array<std::uint32_t, kMostSide> grid_places(unsigned texels, unsigned weights) {
  const std::uint32_t scale = (1024 + texels / 2) / (texels - 1);
  std::array<std::uint32_t, kMostSide> places{};
  for (unsigned i = 0; i < texels; ++i) places[i] = (scale * i * (weights - 1) + 32) >> 6;
  return places;
}

std::uint32_t weight_between(const std::uint8_t* weights, unsigned width, std::uint32_t s, std::uint32_t t) {
  const std::uint32_t fs = s & 15, ft = t & 15, w11 = (fs * ft + 8) >> 4;
  const std::uint8_t* at = weights + (s >> 4) + (t >> 4) * width;
  return (at[0] * (16 - fs - ft + w11) + at[1] * (fs - w11) + at[width] * (ft - w11) + at[width + 1] * w11 + 8) >> 4;
}

void fill(std::uint8_t* rgba, unsigned texels, const std::array<std::uint8_t, 4>& color) {
  for (unsigned i = 0; i < texels; ++i) std::ranges::copy(color, rgba + 4 * i);
}

// A block of one colour. The extent of the colour beyond the block is not used, only checked.
std::array<std::uint8_t, 4> void_extent_color(const BlockBits& bits) {
  constexpr std::uint32_t kAll = 0x1fff;
  const std::uint32_t s0 = bits.at(12, 13), s1 = bits.at(25, 13), t0 = bits.at(38, 13), t1 = bits.at(51, 13);
  const bool whole = s0 == kAll && s1 == kAll && t0 == kAll && t1 == kAll;
  const bool is_hdr = bits.at(9, 1) != 0;
  if (is_hdr || bits.at(10, 2) != 3 || (!whole && (s0 >= s1 || t0 >= t1))) return kAstcError;
  std::array<std::uint8_t, 4> color{};
  for (unsigned c = 0; c < 4; ++c) color[c] = static_cast<std::uint8_t>(bits.at(64 + 16 * c, 16) >> 8);
  return color;
}

// The widest range of colours that fits into the bits.
const IntegerRange* widest_range(unsigned count, int bits) {
  for (auto range = kColorRanges.rbegin(); range != kColorRanges.rend(); ++range)
    if (static_cast<int>(range->length(count)) <= bits) return &*range;
  return nullptr;
}

} // namespace

void decode_astc_block(const std::uint8_t* block, unsigned width, unsigned height, bool srgb, std::uint8_t* rgba) {
  constexpr unsigned kLeastWeightBits = 24, kMostWeightBits = 96, kMostColorValues = 18;
  const unsigned texels = width * height;
  const BlockBits bits = block_bits(block);
  if (bits.at(0, 9) == 0x1fc) return fill(rgba, texels, void_extent_color(bits));

  const std::optional<WeightGrid> grid = read_block_mode(bits.at(0, 11));
  if (!grid || grid->width > width || grid->height > height || grid->count() > kMostWeights)
    return fill(rgba, texels, kAstcError);
  const unsigned weight_bits = grid->range.length(grid->count());
  if (weight_bits < kLeastWeightBits || weight_bits > kMostWeightBits) return fill(rgba, texels, kAstcError);
  const unsigned weights_end = 128 - weight_bits;
  const Partitions partitions = read_partitions(bits, weights_end);
  if (partitions.count == 4 && grid->two_planes) return fill(rgba, texels, kAstcError);

  unsigned value_count = 0;
  for (unsigned i = 0; i < partitions.count; ++i) value_count += 2 * (partitions.endpoint_modes[i] / 4u + 1);
  const int color_bits = static_cast<int>(weights_end) - static_cast<int>(partitions.extra_bits) -
                         (grid->two_planes ? 2 : 0) - static_cast<int>(partitions.first_color_bit);
  const IntegerRange* range = value_count <= kMostColorValues ? widest_range(value_count, color_bits) : nullptr;
  if (!range) return fill(rgba, texels, kAstcError);
  std::array<std::uint8_t, kMostColorValues> values{};
  read_integers(bits, partitions.first_color_bit, *range, value_count, values.data());
  for (unsigned i = 0; i < value_count; ++i) values[i] = unquantize_color(*range, values[i]);
  std::array<std::optional<EndpointPair>, 4> pairs;
  const std::uint8_t* next = values.data();
  for (unsigned i = 0; i < partitions.count; ++i) {
    pairs[i] = endpoint_pair(partitions.endpoint_modes[i], next);
    next += 2 * (partitions.endpoint_modes[i] / 4 + 1);
  }

  const std::size_t second_plane = grid->two_planes ? bits.at(weights_end - partitions.extra_bits - 2, 2) : 4;
  const GridWeights weights = read_weights(bits, *grid);
  const auto columns = grid_places(width, grid->width), rows = grid_places(height, grid->height);
  std::uint8_t* out = rgba;
  for (unsigned y = 0; y < height; ++y) {
    for (unsigned x = 0; x < width; ++x, out += 4) {
      const std::uint32_t partition =
          partitions.count > 1 ? partition_of(partitions.seed, x, y, partitions.count, texels < 31) : 0;
      const std::optional<EndpointPair>& pair = pairs[partition];
      if (!pair) {
        std::ranges::copy(kAstcError, out);
        continue;
      }
      const std::uint32_t first = weight_between(weights[0].data(), grid->width, columns[x], rows[y]);
      const std::uint32_t second =
          grid->two_planes ? weight_between(weights[1].data(), grid->width, columns[x], rows[y]) : first;
      for (std::size_t c = 0; c < 4; ++c)
        out[c] = interpolate(pair->from[c], pair->to[c], c == second_plane ? second : first, srgb);
    }
  }
}

} // namespace wavepath::ktx
