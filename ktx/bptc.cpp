#include "ktx/bptc.h"

#include <algorithm>
#include <array>
#include <bit>
#include <string_view>
#include <utility>

#include "ktx/block_bits.h"
#include "ktx/bptc_partitions.h"
#include "ktx/half.h"

namespace wavepath::ktx {
namespace {

// Weights of 64 by index, for indices of 2, 3 and 4 bits.
constexpr std::array<std::array<std::uint8_t, 16>, 3> kBptcWeights = {
    {{0, 21, 43, 64}, {0, 9, 18, 27, 37, 46, 55, 64}, {0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64}}};

unsigned weight_of(unsigned bits, std::uint32_t index) { return kBptcWeights[bits - 2][index]; }

unsigned subset_of(unsigned subsets, std::uint32_t partition, unsigned texel) {
  if (subsets == 2) return kTwoSubsets[partition] >> texel & 1;
  if (subsets == 3) return kThreeSubsets[partition] >> (2 * texel) & 3;
  return 0;
}

bool is_anchor(unsigned subsets, std::uint32_t partition, unsigned texel) {
  if (texel == 0) return true;
  if (subsets == 2) return texel == kAnchorOfTwo[partition];
  return subsets == 3 && (texel == kSecondAnchor[partition] || texel == kThirdAnchor[partition]);
}

// Columns of the table "Mode-dependent BPTC parameters".
struct Bc7Mode {
  std::uint8_t subsets, partition_bits, rotation_bits, selection_bits, color_bits, alpha_bits;
  std::uint8_t endpoint_p_bits, shared_p_bits, index_bits, second_index_bits;
};

constexpr std::array<Bc7Mode, 8> kBc7Modes = {{{3, 4, 0, 0, 4, 0, 1, 0, 3, 0},
                                               {2, 6, 0, 0, 6, 0, 0, 1, 3, 0},
                                               {3, 6, 0, 0, 5, 0, 0, 0, 2, 0},
                                               {2, 6, 0, 0, 7, 0, 1, 0, 2, 0},
                                               {1, 0, 2, 1, 5, 6, 0, 0, 2, 3},
                                               {1, 0, 2, 0, 7, 8, 0, 0, 2, 2},
                                               {1, 0, 0, 0, 7, 7, 1, 0, 4, 0},
                                               {2, 6, 0, 0, 5, 5, 1, 0, 2, 0}}};

using Bc7Endpoints = std::array<std::array<std::uint32_t, 4>, 6>; // two of each subset

Bc7Endpoints read_bc7_endpoints(BlockReader& reader, const Bc7Mode& mode) {
  Bc7Endpoints endpoints{};
  const std::size_t count = 2u * mode.subsets;
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t e = 0; e < count; ++e) endpoints[e][c] = reader.take(c < 3 ? mode.color_bits : mode.alpha_bits);
  const bool has_p = mode.endpoint_p_bits + mode.shared_p_bits > 0;
  std::uint32_t p = 0;
  for (std::size_t e = 0; has_p && e < count; ++e) {
    if (mode.endpoint_p_bits > 0 || e % 2 == 0) p = reader.take(1);
    for (std::uint32_t& value : endpoints[e]) value = value << 1 | p;
  }
  for (std::size_t e = 0; e < count; ++e) {
    for (std::size_t c = 0; c < 4; ++c) {
      const unsigned bits = (c < 3 ? mode.color_bits : mode.alpha_bits) + (has_p ? 1u : 0u);
      const std::uint32_t value = endpoints[e][c];
      endpoints[e][c] = c == 3 && mode.alpha_bits == 0 ? 255 : (value << (8 - bits) | value >> (2 * bits - 8)) & 255;
    }
  }
  return endpoints;
}

using Indices = std::array<std::uint8_t, 16>;

Indices read_indices(BlockReader& reader, unsigned bits, unsigned subsets, std::uint32_t partition) {
  Indices indices{};
  if (bits == 0) return indices;
  for (unsigned i = 0; i < 16; ++i)
    indices[i] = static_cast<std::uint8_t>(reader.take(bits - (is_anchor(subsets, partition, i) ? 1 : 0)));
  return indices;
}

// --- BC6H ---

// Where each bit of a block goes, as the table "Block descriptions for BC6H block modes" lists it behind the mode:
// channel and endpoint, then a bit, or the first and the last of several.
struct Bc6hMode {
  std::uint8_t number;
  bool transformed; // endpoints but the first are differences to it
  std::uint8_t endpoint_bits;
  std::array<std::uint8_t, 3> delta_bits;
  std::string_view layout;
};

constexpr std::array<Bc6hMode, 14> kBc6hModes = {
    {{0,
      true,
      10,
      {5, 5, 5},
      "g2:4 b2:4 b3:4 r0:9-0 g0:9-0 b0:9-0 r1:4-0 g3:4 g2:3-0 g1:4-0 b3:0 g3:3-0 b1:4-0 b3:1 b2:3-0 r2:4-0 b3:2 r3:4-0 "
      "b3:3"},
     {1,
      true,
      7,
      {6, 6, 6},
      "g2:5 g3:4 g3:5 r0:6-0 b3:0 b3:1 b2:4 g0:6-0 b2:5 b3:2 g2:4 b0:6-0 b3:3 b3:5 b3:4 r1:5-0 g2:3-0 g1:5-0 g3:3-0 "
      "b1:5-0 "
      "b2:3-0 r2:5-0 r3:5-0"},
     {2,
      true,
      11,
      {5, 4, 4},
      "r0:9-0 g0:9-0 b0:9-0 r1:4-0 r0:10 g2:3-0 g1:3-0 g0:10 b3:0 g3:3-0 b1:3-0 b0:10 b3:1 b2:3-0 r2:4-0 b3:2 r3:4-0 "
      "b3:3"},
     {6,
      true,
      11,
      {4, 5, 4},
      "r0:9-0 g0:9-0 b0:9-0 r1:3-0 r0:10 g3:4 g2:3-0 g1:4-0 g0:10 g3:3-0 b1:3-0 b0:10 b3:1 b2:3-0 r2:3-0 b3:0 b3:2 "
      "r3:3-0 "
      "g2:4 b3:3"},
     {10,
      true,
      11,
      {4, 4, 5},
      "r0:9-0 g0:9-0 b0:9-0 r1:3-0 r0:10 b2:4 g2:3-0 g1:3-0 g0:10 b3:0 g3:3-0 b1:4-0 b0:10 b2:3-0 r2:3-0 b3:1 b3:2 "
      "r3:3-0 "
      "b3:4 b3:3"},
     {14,
      true,
      9,
      {5, 5, 5},
      "r0:8-0 b2:4 g0:8-0 g2:4 b0:8-0 b3:4 r1:4-0 g3:4 g2:3-0 g1:4-0 b3:0 g3:3-0 b1:4-0 b3:1 b2:3-0 r2:4-0 b3:2 r3:4-0 "
      "b3:3"},
     {18,
      true,
      8,
      {6, 5, 5},
      "r0:7-0 g3:4 b2:4 g0:7-0 b3:2 g2:4 b0:7-0 b3:3 b3:4 r1:5-0 g2:3-0 g1:4-0 b3:0 g3:3-0 b1:4-0 b3:1 b2:3-0 r2:5-0 "
      "r3:5-0"},
     {22,
      true,
      8,
      {5, 6, 5},
      "r0:7-0 b3:0 b2:4 g0:7-0 g2:5 g2:4 b0:7-0 g3:5 b3:4 r1:4-0 g3:4 g2:3-0 g1:5-0 g3:3-0 b1:4-0 b3:1 b2:3-0 r2:4-0 "
      "b3:2 "
      "r3:4-0 b3:3"},
     {26,
      true,
      8,
      {5, 5, 6},
      "r0:7-0 b3:1 b2:4 g0:7-0 b2:5 g2:4 b0:7-0 b3:5 b3:4 r1:4-0 g3:4 g2:3-0 g1:4-0 b3:0 g3:3-0 b1:5-0 b2:3-0 r2:4-0 "
      "b3:2 "
      "r3:4-0 b3:3"},
     {30,
      false,
      6,
      {6, 6, 6},
      "r0:5-0 g3:4 b3:0 b3:1 b2:4 g0:5-0 g2:5 b2:5 b3:2 g2:4 b0:5-0 g3:5 b3:3 b3:5 b3:4 r1:5-0 g2:3-0 g1:5-0 g3:3-0 "
      "b1:5-0 "
      "b2:3-0 r2:5-0 r3:5-0"},
     {3, false, 10, {10, 10, 10}, "r0:9-0 g0:9-0 b0:9-0 r1:9-0 g1:9-0 b1:9-0"},
     {7, true, 11, {9, 9, 9}, "r0:9-0 g0:9-0 b0:9-0 r1:8-0 r0:10 g1:8-0 g0:10 b1:8-0 b0:10"},
     {11, true, 12, {8, 8, 8}, "r0:9-0 g0:9-0 b0:9-0 r1:7-0 r0:10-11 g1:7-0 g0:10-11 b1:7-0 b0:10-11"},
     {15, true, 16, {4, 4, 4}, "r0:9-0 g0:9-0 b0:9-0 r1:3-0 r0:10-15 g1:3-0 g0:10-15 b1:3-0 b0:10-15"}}};

constexpr unsigned kTwoSubsetBits = 77, kOneSubsetBits = 65; // of mode and endpoints

// A bit of an endpoint: channel, endpoint, bit.
struct Bc6hBit {
  std::uint8_t channel = 0, endpoint = 0, bit = 0;
};

struct Bc6hLayout {
  std::array<Bc6hBit, kTwoSubsetBits> bits{}; // behind the mode
  unsigned count = 0;
};

constexpr Bc6hLayout layout_of(std::string_view text) {
  Bc6hLayout layout;
  std::size_t at = 0;
  const auto number = [&] {
    unsigned value = 0;
    while (at < text.size() && text[at] >= '0' && text[at] <= '9')
      value = value * 10 + static_cast<unsigned>(text[at++] - '0');
    return value;
  };
  while (at < text.size()) {
    const auto channel = static_cast<std::uint8_t>(text[at] == 'r' ? 0 : text[at] == 'g' ? 1 : 2);
    const auto endpoint = static_cast<std::uint8_t>(text[at + 1] - '0');
    at += 3;
    const unsigned first = number();
    unsigned last = first;
    if (at < text.size() && text[at] == '-') {
      ++at;
      last = number();
    }
    // Where the first is the greater one, the lowest bit comes first.
    const unsigned low = first < last ? first : last, high = first < last ? last : first;
    for (unsigned i = 0; i <= high - low; ++i)
      layout.bits[layout.count++] = {channel, endpoint, static_cast<std::uint8_t>(first < last ? high - i : low + i)};
    ++at;
  }
  return layout;
}

constexpr auto kBc6hLayouts = [] {
  std::array<Bc6hLayout, kBc6hModes.size()> layouts{};
  for (std::size_t i = 0; i < layouts.size(); ++i) layouts[i] = layout_of(kBc6hModes[i].layout);
  return layouts;
}();

int sign_extend(int value, unsigned bits) { return (value ^ 1 << (bits - 1)) - (1 << (bits - 1)); }

int unquantize(int x, unsigned bits, bool is_signed) {
  if (!is_signed) {
    if (bits >= 15 || x == 0) return x;
    return x == (1 << bits) - 1 ? 0xffff : ((x << 15) + 0x4000) >> (bits - 1);
  }
  if (bits >= 16 || x == 0) return x;
  const int magnitude = x < 0 ? -x : x;
  const int wide = magnitude >= (1 << (bits - 1)) - 1 ? 0x7fff : ((magnitude << 15) + 0x4000) >> (bits - 1);
  return x < 0 ? -wide : wide;
}

// The bits of a half.
std::uint16_t finish(int value, bool is_signed) {
  if (!is_signed) return static_cast<std::uint16_t>((value * 31) >> 6);
  return static_cast<std::uint16_t>(value < 0 ? ((-value * 31) >> 5) | 0x8000 : (value * 31) >> 5);
}

} // namespace

void decode_bc7_block(const std::uint8_t* block, std::uint8_t* rgba) {
  const unsigned number = static_cast<unsigned>(std::countr_zero(block[0]));
  if (number >= kBc7Modes.size()) {
    std::fill_n(rgba, 64, std::uint8_t{0});
    return;
  }
  const Bc7Mode& mode = kBc7Modes[number];
  BlockReader reader{block_bits(block), number + 1};
  const std::uint32_t partition = reader.take(mode.partition_bits), rotation = reader.take(mode.rotation_bits);
  const bool swaps_indices = reader.take(mode.selection_bits) != 0;
  const Bc7Endpoints endpoints = read_bc7_endpoints(reader, mode);
  const Indices first = read_indices(reader, mode.index_bits, mode.subsets, partition);
  const Indices second = read_indices(reader, mode.second_index_bits, 1, 0);
  const bool has_second = mode.second_index_bits > 0;
  for (unsigned i = 0; i < 16; ++i) {
    unsigned color = weight_of(mode.index_bits, first[i]);
    unsigned alpha = has_second ? weight_of(mode.second_index_bits, second[i]) : color;
    if (swaps_indices) std::swap(color, alpha);
    const std::size_t pair = 2 * subset_of(mode.subsets, partition, i);
    std::uint8_t* texel = rgba + 4 * i;
    for (std::size_t c = 0; c < 4; ++c) {
      const std::uint32_t weight = c < 3 ? color : alpha;
      texel[c] =
          static_cast<std::uint8_t>(((64 - weight) * endpoints[pair][c] + weight * endpoints[pair + 1][c] + 32) >> 6);
    }
    if (rotation > 0) std::swap(texel[3], texel[rotation - 1]);
  }
}

void decode_bc6h_block(const std::uint8_t* block, bool is_signed, float* rgba) {
  BlockReader reader{block_bits(block)};
  std::uint32_t number = reader.take(2);
  if (number >= 2) number |= reader.take(3) << 2;
  const auto found = std::ranges::find(kBc6hModes, number, &Bc6hMode::number);
  if (found == kBc6hModes.end()) {
    for (unsigned i = 0; i < 64; ++i) rgba[i] = i % 4 == 3 ? 1.0f : 0.0f;
    return;
  }
  const Bc6hMode& mode = *found;
  const Bc6hLayout& layout = kBc6hLayouts[static_cast<std::size_t>(found - kBc6hModes.begin())];
  std::array<std::array<int, 3>, 4> endpoints{};
  for (unsigned i = 0; i < layout.count; ++i) {
    const Bc6hBit to = layout.bits[i];
    endpoints[to.endpoint][to.channel] |= static_cast<int>(reader.take(1)) << to.bit;
  }
  const unsigned subsets = reader.next == kOneSubsetBits ? 1 : 2;
  const std::uint32_t partition = subsets == 2 ? reader.take(5) : 0;

  for (std::size_t c = 0; c < 3; ++c) {
    const unsigned bits = mode.endpoint_bits;
    const int base = endpoints[0][c];
    for (std::size_t e = 0; e < 2 * subsets; ++e) {
      int& value = endpoints[e][c];
      if (e > 0 && mode.transformed) value = (base + sign_extend(value, mode.delta_bits[c])) & ((1 << bits) - 1);
      if (is_signed) value = sign_extend(value, bits);
      value = unquantize(value, bits, is_signed);
    }
  }
  const unsigned index_bits = subsets == 2 ? 3 : 4;
  const Indices indices = read_indices(reader, index_bits, subsets, partition);
  for (unsigned i = 0; i < 16; ++i) {
    const auto weight = static_cast<int>(weight_of(index_bits, indices[i]));
    const std::size_t pair = 2 * subset_of(subsets, partition, i);
    for (std::size_t c = 0; c < 3; ++c) {
      const int value = ((64 - weight) * endpoints[pair][c] + weight * endpoints[pair + 1][c] + 32) >> 6;
      rgba[4 * i + c] = float_of_half(finish(value, is_signed));
    }
    rgba[4 * i + 3] = 1.0f;
  }
}

} // namespace wavepath::ktx
