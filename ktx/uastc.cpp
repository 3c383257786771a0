#include "ktx/uastc.h"

#include <algorithm>
#include <array>

#include "ktx/astc_parts.h"
#include "ktx/block_bits.h"

namespace wavepath::ktx {
namespace {

constexpr std::uint8_t kSolidMode = 8, kInvalidMode = 19;

// The layout of a mode. Bits of hints for other formats are counted and passed over.
struct UastcMode {
  std::uint8_t hint_bits = 0;             // behind the mode: BC1H0 to ETC2M
  std::uint8_t pattern_bits = 0;          // PAT
  bool two_planes = false;                // with CSEL, except in mode 17
  std::uint8_t subsets = 1, channels = 3; // 2: luminance and alpha
  IntegerRange range;                     // of endpoints
  std::uint8_t weight_bits = 0;
};

constexpr std::uint8_t kHints = 15, kFewHints = 9, kAlphaHints = 8; // with ETCBI and BC1H1; without; ETC2T and ETC2M

constexpr std::array<UastcMode, kInvalidMode> kUastcModes = {{
    {kHints, 0, false, 1, 3, {1, 0, 6}, 4},                  // 0
    {kHints, 0, false, 1, 3, {0, 0, 8}, 2},                  // 1
    {kHints, 5, false, 2, 3, {0, 0, 4}, 3},                  // 2
    {kHints, 4, false, 3, 3, {1, 0, 2}, 2},                  // 3
    {kHints, 5, false, 2, 3, {0, 1, 3}, 2},                  // 4
    {kHints, 0, false, 1, 3, {0, 0, 8}, 3},                  // 5
    {kHints, 0, true, 1, 3, {0, 1, 5}, 2},                   // 6
    {kHints, 5, false, 2, 3, {0, 1, 3}, 2},                  // 7
    {},                                                      // 8: one colour
    {kHints + kAlphaHints, 5, false, 2, 4, {0, 0, 4}, 2},    // 9
    {kFewHints + kAlphaHints, 0, false, 1, 4, {1, 0, 4}, 4}, // 10
    {kFewHints + kAlphaHints, 0, true, 1, 4, {1, 0, 4}, 2},  // 11
    {kFewHints + kAlphaHints, 0, false, 1, 4, {1, 0, 6}, 3}, // 12
    {kHints + kAlphaHints, 0, true, 1, 4, {0, 0, 8}, 1},     // 13
    {kHints + kAlphaHints, 0, false, 1, 4, {0, 0, 8}, 2},    // 14
    {kHints + kAlphaHints, 0, false, 1, 2, {0, 0, 8}, 4},    // 15
    {kHints + kAlphaHints, 5, false, 2, 2, {0, 0, 8}, 2},    // 16
    {kHints + kAlphaHints, 0, true, 1, 2, {0, 0, 8}, 2},     // 17
    {kHints, 0, false, 1, 3, {0, 0, 5}, 5},                  // 18
}};

// The mode and the number of its bits, by the lowest 7 bits of a block.
struct ModeCode {
  std::uint8_t mode = kInvalidMode, length = 7;
};

constexpr std::array<ModeCode, 128> mode_codes() {
  struct Word {
    std::uint8_t bits, length, mode;
  };
  constexpr Word kWords[] = {{0x00, 2, 11}, {0x02, 3, 10}, {0x06, 3, 12}, {0x01, 4, 0},  {0x09, 4, 18},
                             {0x03, 5, 3},  {0x07, 5, 7},  {0x0b, 5, 5},  {0x0d, 5, 14}, {0x0f, 5, 9},
                             {0x13, 5, 4},  {0x17, 5, 8},  {0x1b, 5, 6},  {0x1d, 5, 2},  {0x1f, 5, 13},
                             {0x15, 6, 16}, {0x25, 6, 17}, {0x35, 6, 1},  {0x05, 7, 15}};
  std::array<ModeCode, 128> codes{};
  for (const Word& word : kWords)
    for (unsigned at = word.bits; at < 128; at += 1u << word.length) codes[at] = {word.mode, word.length};
  return codes;
}

constexpr std::array<ModeCode, 128> kModeCodes = mode_codes();

// Patterns are those that ASTC makes of these seeds.
constexpr std::array<std::uint16_t, 30> kSeedsOfTwo = {28,  20,  16,  29,  91,  9,   107, 72,  149, 204,
                                                       50,  114, 496, 17,  78,  39,  252, 828, 43,  156,
                                                       116, 210, 476, 273, 684, 359, 246, 195, 694, 524};
constexpr std::array<std::uint16_t, 11> kSeedsOfThree = {260, 74, 32, 156, 183, 15, 745, 0, 335, 902, 254};
constexpr std::array<std::uint16_t, 19> kSeedsOfMode7 = {36,  48,  61,  137, 161, 183, 226, 281, 302, 307,
                                                         479, 495, 593, 594, 605, 799, 812, 988, 993};

struct Pattern {
  std::array<std::uint8_t, 16> subset{};
  std::uint16_t anchors = 1; // texels whose weight lacks its highest bit: the first of each subset
};

Pattern make_pattern(std::uint32_t seed, std::uint32_t subsets) {
  Pattern pattern;
  pattern.anchors = 0;
  std::uint32_t seen = 0;
  for (std::uint32_t i = 0; i < 16; ++i) {
    const std::uint32_t subset = partition_of(seed, i % 4, i / 4, subsets, true);
    pattern.subset[i] = static_cast<std::uint8_t>(subset);
    if ((seen >> subset & 1) == 0) pattern.anchors |= static_cast<std::uint16_t>(1u << i);
    seen |= 1u << subset;
  }
  return pattern;
}

template <std::size_t count>
std::array<Pattern, count> make_patterns(const std::array<std::uint16_t, count>& seeds, std::uint32_t subsets) {
  std::array<Pattern, count> patterns;
  for (std::size_t i = 0; i < count; ++i) patterns[i] = make_pattern(seeds[i], subsets);
  return patterns;
}

// The pattern of a block; nothing if its number is none.
const Pattern* find_pattern(std::uint8_t mode, std::uint32_t number) {
  static const Pattern kWhole;
  static const auto kOfTwo = make_patterns(kSeedsOfTwo, 2);
  static const auto kOfThree = make_patterns(kSeedsOfThree, 3);
  static const auto kOfMode7 = make_patterns(kSeedsOfMode7, 2);
  if (kUastcModes[mode].subsets == 1) return &kWhole;
  if (mode == 3) return number < kOfThree.size() ? &kOfThree[number] : nullptr;
  if (mode == 7) return number < kOfMode7.size() ? &kOfMode7[number] : nullptr;
  return number < kOfTwo.size() ? &kOfTwo[number] : nullptr;
}

// Weights of 0..64 by the number of bits and the bits.
std::array<std::array<std::uint8_t, 32>, 6> make_weights() {
  std::array<std::array<std::uint8_t, 32>, 6> weights{};
  for (std::uint8_t bits = 1; bits < weights.size(); ++bits)
    for (std::uint32_t value = 0; value < 1u << bits; ++value)
      weights[bits][value] = unquantize_weight({0, 0, bits}, value);
  return weights;
}

void fill_texels(std::uint8_t* rgba, const std::array<std::uint8_t, 4>& color) {
  for (std::size_t i = 0; i < 16; ++i) std::ranges::copy(color, rgba + 4 * i);
}

// Trits or quints come first, packed by powers of 3 or 5, then the bits of all values.
std::array<std::uint8_t, 18> read_endpoint_values(BlockReader& reader, IntegerRange range, unsigned count) {
  std::array<std::uint8_t, 18> values{};
  const std::uint32_t base = range.trits > 0 ? 3 : 5;
  const unsigned group = range.trits > 0 ? 5 : 3;
  if (range.trits + range.quints > 0) {
    for (unsigned done = 0; done < count; done += group) {
      const unsigned here = std::min(group, count - done);
      std::uint32_t packed = reader.take(IntegerRange{range.trits, range.quints, 0}.length(here));
      for (unsigned i = 0; i < here; ++i, packed /= base)
        values[done + i] = static_cast<std::uint8_t>(packed % base << range.bits);
    }
  }
  for (unsigned i = 0; i < count; ++i) values[i] = static_cast<std::uint8_t>(values[i] | reader.take(range.bits));
  for (unsigned i = 0; i < count; ++i) values[i] = unquantize_color(range, values[i]);
  return values;
}

std::array<EndpointPair, 3> read_endpoint_pairs(BlockReader& reader, const UastcMode& mode) {
  const std::array<std::uint8_t, 18> values =
      read_endpoint_values(reader, mode.range, 2u * mode.channels * mode.subsets);
  std::array<EndpointPair, 3> pairs;
  const std::uint8_t* value = values.data();
  for (std::size_t s = 0; s < mode.subsets; ++s) {
    const auto set = [&](std::size_t first, std::size_t last) {
      for (std::size_t c = first; c < last; ++c) {
        pairs[s].from[c] = value[0];
        pairs[s].to[c] = value[1];
      }
      value += 2;
    };
    pairs[s].from[3] = pairs[s].to[3] = 255;
    if (mode.channels == 2) {
      set(0, 3);
      set(3, 4);
    } else {
      for (std::size_t c = 0; c < mode.channels; ++c) set(c, c + 1);
    }
  }
  return pairs;
}

} // namespace

void decode_uastc_block(const std::uint8_t* block, bool srgb, std::uint8_t* rgba) {
  constexpr std::array<std::uint8_t, 4> kError = {255, 0, 255, 255};
  BlockReader reader{block_bits(block)};
  const ModeCode code = kModeCodes[reader.bits.at(0, 7)];
  if (code.mode == kInvalidMode) return fill_texels(rgba, kError);
  reader.next = code.length;
  if (code.mode == kSolidMode) {
    std::array<std::uint8_t, 4> color{};
    for (std::uint8_t& channel : color) channel = static_cast<std::uint8_t>(reader.take(8));
    return fill_texels(rgba, color);
  }
  const UastcMode& mode = kUastcModes[code.mode];
  reader.next += mode.hint_bits;
  // The multiplier of the hint for alpha, which must not be 0.
  if (mode.channels != 3 && reader.bits.at(reader.next - 4, 4) == 0) return fill_texels(rgba, kError);
  const Pattern* pattern = find_pattern(code.mode, reader.take(mode.pattern_bits));
  if (!pattern) return fill_texels(rgba, kError);
  std::size_t second_plane = 4; // the channel that it weights
  if (mode.two_planes) second_plane = mode.channels == 2 ? 3 : reader.take(2);
  const std::array<EndpointPair, 3> pairs = read_endpoint_pairs(reader, mode);

  static const auto kWeights = make_weights();
  const std::array<std::uint8_t, 32>& weights = kWeights[mode.weight_bits];
  for (std::size_t i = 0; i < 16; ++i) {
    const unsigned bits = mode.weight_bits - (pattern->anchors >> i & 1u);
    const std::uint32_t first = weights[reader.take(bits)];
    const std::uint32_t second = mode.two_planes ? weights[reader.take(bits)] : 0;
    const EndpointPair& pair = pairs[pattern->subset[i]];
    for (std::size_t c = 0; c < 4; ++c)
      rgba[4 * i + c] = interpolate(pair.from[c], pair.to[c], c == second_plane ? second : first, srgb);
  }
}

} // namespace wavepath::ktx
