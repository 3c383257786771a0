// Blocks of compressed texels: values that the Khronos Data Format Specification gives or that follow from its tables,
// written field by field; and noise, whose pictures other decoders have confirmed.
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "tests/ktx_builder.h"

namespace wavepath::test {
namespace {

using Texel = std::array<int, 4>;

// What files need beside their blocks. UASTC is format 0.
KtxFile file_of(std::uint32_t vk_format, Bytes blocks, std::uint32_t width, std::uint32_t height, bool srgb = false) {
  KtxFile file;
  file.vk_format = vk_format;
  if (vk_format == 0) file.model = 166;
  file.transfer = srgb ? 2 : 1;
  file.level = std::move(blocks);
  file.width = width;
  file.height = height;
  return file;
}

// One block of 4 x 4 texels.
ktx::Picture picture_of(std::uint32_t vk_format, const Bytes& block, bool srgb = false) {
  return read_ktx(file_of(vk_format, block, 4, 4, srgb).bytes());
}

Texel texel(const ktx::Picture& picture, std::size_t i) {
  Texel values{};
  for (std::size_t c = 0; c < 4; ++c)
    values[c] = picture.bytes.empty() ? picture.words[4 * i + c] : picture.bytes[4 * i + c];
  return values;
}

std::vector<Texel> texels_of(std::uint32_t vk_format, const Bytes& block, bool srgb = false) {
  const ktx::Picture picture = picture_of(vk_format, block, srgb);
  std::vector<Texel> texels;
  for (std::size_t i = 0; i < 16; ++i) texels.push_back(texel(picture, i));
  return texels;
}

std::vector<float> floats_of(std::uint32_t vk_format, const Bytes& block) {
  return picture_of(vk_format, block).floats;
}

// --- BC1 to BC5 ---

constexpr std::uint64_t kCodes0123 = 0xe4e4e4e4; // codes 0, 1, 2, 3 in each row

Bytes joined(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Bytes bc1_block(std::uint16_t first, std::uint16_t second) {
  Bytes block;
  put(block, first, 2);
  put(block, second, 2);
  put(block, kCodes0123, 4);
  return block;
}

constexpr std::uint16_t rgb565(unsigned r, unsigned g, unsigned b) {
  return static_cast<std::uint16_t>(r << 11 | g << 5 | b);
}

// The two blocks of the note in the chapter on S3TC.
TEST(Bc1, BlocksOfTheSpecification) {
  constexpr std::uint16_t kA = rgb565(29, 60, 1), kB = rgb565(20, 2, 30);
  const std::vector<Texel> four = texels_of(131, bc1_block(kA, kB));
  EXPECT_EQ(four[0], (Texel{239, 243, 8, 255}));
  EXPECT_EQ(four[1], (Texel{165, 8, 247, 255}));
  EXPECT_EQ(four[2], (Texel{214, 165, 88, 255})); // (2 a + b) / 3
  EXPECT_EQ(four[7], (Texel{189, 86, 167, 255})); // (a + 2 b) / 3
  for (const auto& [format, alpha] : {std::pair{131u, 255}, std::pair{133u, 0}}) {
    const std::vector<Texel> three = texels_of(format, bc1_block(kB, kA));
    EXPECT_EQ(three[2], (Texel{202, 125, 128, 255})); // (a + b) / 2
    EXPECT_EQ(three[3], (Texel{0, 0, 0, alpha}));
  }
}

TEST(Bc2, AlphaOfFourBits) {
  Bytes alpha;
  put(alpha, 0xfedcba9876543210, 8);
  const std::vector<Texel> texels = texels_of(135, joined(alpha, bc1_block(0, 0xffff)));
  for (std::size_t i = 0; i < 16; ++i) EXPECT_EQ(texels[i][3], static_cast<int>(17 * i));
  EXPECT_EQ(texels[2][0], 85); // four colours though the first is not the greater one
}

Bytes eight_codes(std::uint8_t first, std::uint8_t second) {
  Bytes block = {first, second};
  std::uint64_t codes = 0;
  for (unsigned i = 0; i < 16; ++i) codes |= std::uint64_t{i % 8} << (3 * i);
  put(block, codes, 6);
  return block;
}

TEST(Bc3, AlphaOfEightAndOfSixValues) {
  const int eight[8] = {240, 30, 210, 180, 150, 120, 90, 60}, six[8] = {30, 240, 72, 114, 156, 198, 0, 255};
  const std::vector<Texel> a = texels_of(137, joined(eight_codes(240, 30), bc1_block(0, 0)));
  const std::vector<Texel> b = texels_of(137, joined(eight_codes(30, 240), bc1_block(0, 0)));
  for (std::size_t i = 0; i < 16; ++i) {
    EXPECT_EQ(a[i][3], eight[i % 8]) << i;
    EXPECT_EQ(b[i][3], six[i % 8]) << i;
  }
}

TEST(Bc4And5, FractionsOfSixteenBits) {
  const std::vector<Texel> red = texels_of(139, eight_codes(255, 0));
  for (std::size_t code = 2; code < 8; ++code)
    EXPECT_EQ(red[code][0], std::lround(65535.0 * static_cast<double>(8 - code) / 7)) << code;
  EXPECT_EQ(red[0], (Texel{65535, 0, 0, 65535}));
  const std::vector<Texel> two = texels_of(141, joined(eight_codes(7, 9), eight_codes(255, 0)));
  EXPECT_EQ(two[0], (Texel{7 * 257, 65535, 0, 65535}));
  EXPECT_EQ(two[6], (Texel{0, 18724, 0, 65535})); // least; 2/7
  EXPECT_EQ(two[7], (Texel{65535, 9362, 0, 65535}));
}

TEST(Bc4And5, SignedOnesReachOne) {
  const std::vector<float> red = floats_of(140, eight_codes(127, 0x81)); // 127 and -127
  EXPECT_EQ(red[0], 1.0f);
  EXPECT_EQ(red[4], -1.0f);
  EXPECT_FLOAT_EQ(red[4 * 2], 5.0f / 7);
  const std::vector<float> six = floats_of(140, eight_codes(0x80, 0x40)); // -128 counts as -127
  EXPECT_EQ(six[0], -1.0f);
  EXPECT_EQ(six[4 * 6], -1.0f);
  EXPECT_EQ(six[4 * 7], 1.0f);
  EXPECT_EQ(floats_of(142, joined(eight_codes(127, 0), eight_codes(0x81, 0)))[1], -1.0f);
}

// --- BC7 ---

// First bits of fields, from the table "Bit layout for BC7 modes".
struct Bc7Layout {
  unsigned mode, subsets, partition, red, green, blue, alpha, p, index, second_index;
  unsigned color_bits, alpha_bits, index_bits, second_index_bits;
  bool shared_p;
};

constexpr Bc7Layout kBc7Layouts[] = {
    {0, 3, 1, 5, 29, 53, 0, 77, 83, 0, 4, 0, 3, 0, false},  {1, 2, 2, 8, 32, 56, 0, 80, 82, 0, 6, 0, 3, 0, true},
    {2, 3, 3, 9, 39, 69, 0, 0, 99, 0, 5, 0, 2, 0, false},   {3, 2, 4, 10, 38, 66, 0, 94, 98, 0, 7, 0, 2, 0, false},
    {4, 1, 0, 8, 18, 28, 38, 0, 50, 81, 5, 6, 2, 3, false}, {5, 1, 0, 8, 22, 36, 50, 0, 66, 97, 7, 8, 2, 2, false},
    {6, 1, 0, 7, 21, 35, 49, 63, 65, 0, 7, 7, 4, 0, false}, {7, 2, 8, 14, 34, 54, 74, 94, 98, 0, 5, 5, 2, 0, false}};

// Bits of a value, repeated to 8.
int widened(unsigned value, unsigned bits) {
  return static_cast<int>((value << (8 - bits) | value >> (2 * bits - 8)) & 255);
}

// Each endpoint has a colour of its own; index 0 shows the first of each subset, an index of ones the second.
TEST(Bc7, EndpointsOfEveryMode) {
  // Pattern 13 of two subsets: the two lower rows are subset 1. Pattern 8 of three: rows 0 and 1, row 2, row 3.
  for (const Bc7Layout& m : kBc7Layouts) {
    SCOPED_TRACE(m.mode);
    const auto value = [&](unsigned endpoint, unsigned channel, unsigned bits) {
      return (5u + 7 * endpoint + 3 * channel) & ((1u << bits) - 1);
    };
    const auto p_of = [](unsigned endpoint, bool shared) { return (shared ? endpoint / 2 : endpoint) % 2; };
    BitWriter writer;
    writer.bytes.resize(16);
    writer.set(m.mode, 1, 1);
    if (m.subsets > 1) writer.set(m.partition, m.mode == 0 ? 4 : 6, m.subsets == 2 ? 13 : 8);
    for (unsigned e = 0; e < 2 * m.subsets; ++e) {
      const unsigned starts[3] = {m.red, m.green, m.blue};
      for (unsigned c = 0; c < 3; ++c)
        writer.set(starts[c] + e * m.color_bits, m.color_bits, value(e, c, m.color_bits));
      if (m.alpha > 0) writer.set(m.alpha + e * m.alpha_bits, m.alpha_bits, value(e, 3, m.alpha_bits));
      if (m.p > 0 && (!m.shared_p || e % 2 == 0)) writer.set(m.p + (m.shared_p ? e / 2 : e), 1, p_of(e, m.shared_p));
    }
    const auto expected = [&](unsigned endpoint) {
      Texel color{0, 0, 0, 255};
      for (unsigned c = 0; c < (m.alpha > 0 ? 4u : 3u); ++c) {
        const unsigned bits = c < 3 ? m.color_bits : m.alpha_bits, v = value(endpoint, c, bits);
        color[c] = m.p > 0 ? widened(v << 1 | p_of(endpoint, m.shared_p), bits + 1) : widened(v, bits);
      }
      return color;
    };
    const auto subset_of = [&](unsigned i) {
      return m.subsets == 1 ? 0 : m.subsets == 2 ? i / 8 : i < 8 ? 0 : i / 4 - 1;
    };
    std::vector<Texel> texels = texels_of(145, writer.bytes);
    for (unsigned i = 0; i < 16; ++i) EXPECT_EQ(texels[i], expected(2 * subset_of(i))) << i;

    // Ones in all indices. Texel 1 is no anchor of these patterns.
    writer.set(m.index, 128 - m.index, ~std::uint64_t{0});
    writer.set(64, m.index < 64 ? 64 : 0, ~std::uint64_t{0});
    texels = texels_of(145, writer.bytes);
    EXPECT_EQ(texels[1], expected(1));
    EXPECT_EQ(texels[13], expected(2 * m.subsets - 1));
  }
}

TEST(Bc7, RotationAndChoiceOfIndices) {
  // Mode 4: colour 31 and 0, alpha 0 and 63; the two bits of texel 1 are 3, the three bits 0.
  const auto mode4 = [](std::uint64_t rotation, std::uint64_t selection) {
    return texels_of(
        145, block_of({{4, 1, 1}, {5, 2, rotation}, {7, 1, selection}, {13, 5, 31}, {44, 6, 63}, {51, 2, 3}}))[1];
  };
  EXPECT_EQ(mode4(0, 0), (Texel{255, 0, 0, 0}));
  EXPECT_EQ(mode4(0, 1), (Texel{0, 0, 0, 255}));
  EXPECT_EQ(mode4(1, 1), (Texel{255, 0, 0, 0}));
  EXPECT_EQ(mode4(2, 1), (Texel{0, 255, 0, 0}));
  EXPECT_EQ(mode4(3, 1), (Texel{0, 0, 255, 0}));
}

TEST(Bc7, WeightsAndReservedMode) {
  // Mode 6: red from 0 to 255; the indices of texels 1 to 15 are 1 to 15.
  BitWriter writer;
  writer.bytes.resize(16);
  writer.set(6, 1, 1);
  writer.set(14, 7, 127);
  writer.set(64, 1, 1);
  for (unsigned i = 1; i < 16; ++i) writer.set(64 + 4 * i, 4, i);
  const std::vector<Texel> texels = texels_of(145, writer.bytes);
  const int weights[16] = {0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64};
  for (unsigned i = 0; i < 16; ++i) EXPECT_EQ(texels[i][0], (weights[i] * 255 + 32) / 64) << i;
  EXPECT_EQ(texels_of(145, Bytes(16))[5], (Texel{0, 0, 0, 0}));
}

// --- BC6H ---

float half_value(std::uint32_t bits) {
  const int exponent = static_cast<int>(bits >> 10 & 31);
  const double mantissa = static_cast<double>(bits & 1023) / 1024;
  const double value = exponent == 0 ? std::ldexp(mantissa, -14) : std::ldexp(1 + mantissa, exponent - 15);
  return static_cast<float>(bits >> 15 & 1 ? -value : value);
}

// The highest bits of the first endpoint, from the table "Interpretation of lower bits for BC6H block modes".
struct Bc6hLayout {
  unsigned mode, bits, red, green, blue;
  bool transformed;
};

constexpr Bc6hLayout kBc6hLayouts[] = {
    {0, 10, 14, 24, 34, true},  {1, 7, 11, 21, 31, true},   {2, 11, 40, 49, 59, true},  {6, 11, 39, 50, 59, true},
    {10, 11, 39, 49, 60, true}, {14, 9, 13, 23, 33, true},  {18, 8, 12, 22, 32, true},  {22, 8, 12, 22, 32, true},
    {26, 8, 12, 22, 32, true},  {30, 6, 10, 20, 30, false}, {3, 10, 14, 24, 34, false}, {7, 11, 44, 54, 64, true},
    {11, 12, 43, 53, 63, true}, {15, 16, 39, 49, 59, true}};

TEST(Bc6h, HighestBitOfEveryMode) {
  for (const Bc6hLayout& m : kBc6hLayouts) {
    SCOPED_TRACE(m.mode);
    const unsigned mode_bits = m.mode < 2 ? 2 : 5;
    const Bytes block = block_of({{0, mode_bits, m.mode}, {m.red, 1, 1}, {m.blue, 1, 1}});
    const std::uint32_t x = 1u << (m.bits - 1);
    const std::uint32_t wide = m.bits >= 15 ? x : ((x << 15) + 0x4000) >> (m.bits - 1);
    const float value = half_value(wide * 31 >> 6);
    const std::vector<float> floats = floats_of(143, block);
    EXPECT_EQ((std::vector<float>(floats.begin(), floats.begin() + 4)), (std::vector<float>{value, 0, value, 1}));
    // The other subset of pattern 0, columns 2 and 3, has what differences of zero make of it.
    const bool one_subset = m.mode % 4 == 3;
    EXPECT_EQ(floats[4 * 3], m.transformed || one_subset ? value : 0.0f);
    EXPECT_EQ(floats_of(143, block_of({{0, mode_bits, m.mode}, {m.green, 1, 1}}))[1], value);
    // In the signed format it is the sign: the least number, or as near to it as a half has.
    const float least = m.bits == 16 ? -std::numeric_limits<float>::infinity() : -65504.0f;
    EXPECT_EQ(floats_of(144, block)[0], least);
  }
}

// Mode 3: endpoints of 10 bits, 0 and all ones.
TEST(Bc6h, WeightsAndReservedModes) {
  BitWriter writer;
  writer.bytes.resize(16);
  writer.set(0, 5, 3);
  writer.set(35, 10, 1023);
  for (unsigned i = 1; i < 16; ++i) writer.set(64 + 4 * i, 4, i);
  const std::vector<float> floats = floats_of(143, writer.bytes);
  const unsigned weights[16] = {0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64};
  for (unsigned i = 0; i < 16; ++i)
    EXPECT_EQ(floats[4 * i], half_value(((weights[i] * 0xffff + 32) >> 6) * 31 >> 6)) << i;
  EXPECT_EQ(floats[4 * 15], 65504.0f);
  for (const unsigned mode : {19u, 23u, 27u, 31u})
    EXPECT_EQ(floats_of(143, block_of({{0, 5, mode}, {5, 59, ~std::uint64_t{0}}}))[0], 0.0f);
}

// Differences have signs: mode 7 with 1 and -1 of 9 bits.
TEST(Bc6h, DifferencesToTheFirstEndpoint) {
  BitWriter writer;
  writer.bytes.resize(16);
  writer.set(0, 5, 7);
  writer.set(5, 10, 1);   // red 1
  writer.set(15, 10, 1);  // green 1
  writer.set(35, 9, 1);   // red + 1
  writer.set(45, 9, 511); // green - 1
  writer.set(68, 4, 15);  // texel 1: the second endpoint
  const std::vector<float> floats = floats_of(143, writer.bytes);
  const auto wide = [](std::uint32_t x) { return half_value((((x << 15) + 0x4000) >> 10) * 31 >> 6); };
  EXPECT_EQ(floats[0], wide(1));
  EXPECT_EQ(floats[4], wide(2));
  EXPECT_EQ(floats[5], 0.0f);
}

// --- ETC2 and EAC: the examples of the specification ---

Bytes big_endian(std::uint64_t word) {
  Bytes bytes;
  for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(word >> shift));
  return bytes;
}

// Fields of a word of 64 bits, of which the first bit is the lowest one.
std::uint64_t word_of(std::initializer_list<Field> fields) {
  std::uint64_t word = 0;
  for (const Field& field : fields) word |= field.value << field.first;
  return word;
}

// Texels a, b, c, d of the first column and m, n, o, p of the last have pixel indices 0, 1, 2, 3.
constexpr std::uint64_t kEtcIndices = 0xc00cull << 16 | 0xa00aull;

std::vector<Texel> first_column(const std::vector<Texel>& texels) {
  return {texels[0], texels[4], texels[8], texels[12]};
}
std::vector<Texel> last_column(const std::vector<Texel>& texels) {
  return {texels[3], texels[7], texels[11], texels[15]};
}

TEST(Etc2, IndividualAndDifferentialBlocks) {
  const std::uint64_t individual =
      word_of({{60, 4, 4}, {56, 4, 14}, {52, 4, 11}, {48, 4, 3}, {44, 4, 9}, {40, 4, 8}, {37, 3, 4}});
  std::vector<Texel> texels = texels_of(147, big_endian(individual | kEtcIndices));
  EXPECT_EQ(first_column(texels),
            (std::vector<Texel>{{86, 205, 171, 255}, {128, 247, 213, 255}, {50, 169, 135, 255}, {8, 127, 93, 255}}));
  EXPECT_EQ(last_column(texels),
            (std::vector<Texel>{{240, 53, 138, 255}, {246, 59, 144, 255}, {236, 49, 134, 255}, {230, 43, 128, 255}}));
  // One above the other: the upper rows are the first.
  texels = texels_of(147, big_endian(individual | kEtcIndices | 1ull << 32));
  EXPECT_EQ(texels[3], (Texel{86, 205, 171, 255}));
  EXPECT_EQ(texels[12], (Texel{230, 43, 128, 255}));

  const std::uint64_t differential = word_of(
      {{59, 5, 29}, {56, 3, 4}, {51, 5, 26}, {48, 3, 5}, {43, 5, 8}, {40, 3, 3}, {37, 3, 2}, {34, 3, 3}, {33, 1, 1}});
  for (const std::uint32_t format : {147u, 149u}) { // with the bit set, both formats are the same
    texels = texels_of(format, big_endian(differential | kEtcIndices));
    EXPECT_EQ(first_column(texels),
              (std::vector<Texel>{{248, 223, 75, 255}, {255, 243, 95, 255}, {230, 205, 57, 255}, {210, 185, 37, 255}}));
    EXPECT_EQ(
        last_column(texels),
        (std::vector<Texel>{{219, 202, 103, 255}, {248, 231, 132, 255}, {193, 176, 77, 255}, {164, 147, 48, 255}}));
  }
  // Without it: the small modifiers are 0, and index 2 is transparent.
  texels = texels_of(149, big_endian((differential & ~(1ull << 33)) | kEtcIndices));
  EXPECT_EQ(first_column(texels),
            (std::vector<Texel>{{239, 214, 66, 255}, {255, 243, 95, 255}, {0, 0, 0, 0}, {210, 185, 37, 255}}));
}

// Base colours (13, 1, 8) and (4, 12, 13), distance 32.
TEST(Etc2, BlocksOfModeT) {
  // Red + its difference must leave 0..31: bits 63 to 61 and 58 are free for that. Here they are 31 and 1.
  const std::uint64_t word = word_of({{61, 3, 7},
                                      {59, 2, 3},
                                      {58, 1, 0},
                                      {56, 2, 1},
                                      {52, 4, 1},
                                      {48, 4, 8},
                                      {44, 4, 4},
                                      {40, 4, 12},
                                      {36, 4, 13},
                                      {34, 2, 2},
                                      {33, 1, 1},
                                      {32, 1, 1}});
  for (const std::uint32_t format : {147u, 149u})
    EXPECT_EQ(
        first_column(texels_of(format, big_endian(word | kEtcIndices))),
        (std::vector<Texel>{{221, 17, 136, 255}, {100, 236, 253, 255}, {68, 204, 221, 255}, {36, 172, 189, 255}}));
  EXPECT_EQ(texels_of(149, big_endian((word & ~(1ull << 33)) | kEtcIndices))[8], (Texel{0, 0, 0, 0}));
}

TEST(Etc2, BlocksOfModeH) {
  // Green + its difference must leave 0..31: bits 55 to 53 and 50 are free. The lowest bit of the distance is that the
  // first colour is the greater one.
  const std::uint64_t word = word_of({{59, 4, 13},
                                      {52, 1, 1},
                                      {51, 1, 1},
                                      {50, 1, 1},
                                      {43, 4, 4},
                                      {39, 4, 12},
                                      {35, 4, 13},
                                      {34, 1, 1},
                                      {33, 1, 1}}); // here they are 3 and -4
  EXPECT_EQ(first_column(texels_of(147, big_endian(word | kEtcIndices))),
            (std::vector<Texel>{{253, 49, 168, 255}, {189, 0, 104, 255}, {100, 236, 253, 255}, {36, 172, 189, 255}}));
  EXPECT_EQ(texels_of(149, big_endian((word & ~(1ull << 33)) | kEtcIndices))[8], (Texel{0, 0, 0, 0}));
}

TEST(Etc2, PlanarBlocks) {
  // (12, 64, 62), (50, 5, 37) across, (40, 112, 45) down.
  const std::uint64_t origin = word_of({{57, 6, 12}, {56, 1, 1}, {49, 6, 0}, {48, 1, 1}, {43, 2, 3}, {39, 3, 6}});
  const std::uint64_t others =
      word_of({{34, 5, 25}, {33, 1, 1}, {32, 1, 0}, {25, 7, 5}, {19, 6, 37}, {13, 6, 40}, {6, 7, 112}, {0, 6, 45}});
  // Blue + its difference must leave 0..31: bits 47 to 45 and 42 are free. Here they are 31 and 3.
  const std::uint64_t word = origin | others | 7ull << 45;
  const int expected[16][3] = {{48, 129, 251},  {87, 99, 226},   {126, 70, 201},  {164, 40, 175},
                               {77, 153, 234},  {115, 123, 209}, {154, 94, 183},  {193, 64, 158},
                               {105, 177, 217}, {144, 147, 191}, {183, 118, 166}, {221, 88, 141},
                               {134, 201, 199}, {172, 171, 174}, {211, 142, 149}, {250, 112, 124}};
  for (const std::uint32_t format : {147u, 149u}) {
    const std::vector<Texel> texels = texels_of(format, big_endian(word));
    for (std::size_t i = 0; i < 16; ++i)
      EXPECT_EQ(texels[i], (Texel{expected[i][0], expected[i][1], expected[i][2], 255})) << i;
  }
}

// Base codeword, table 13, multiplier; texel b (second of the first column) has pixel index 3: -10.
Bytes eac_block(std::uint8_t base, unsigned multiplier) {
  return big_endian(word_of({{56, 8, base}, {52, 4, multiplier}, {48, 4, 13}, {42, 3, 3}}));
}

TEST(Eac, ExamplesOfTheSpecification) {
  const Bytes color = big_endian(0);
  EXPECT_EQ(texels_of(151, joined(eac_block(103, 2), color))[4][3], 83);
  EXPECT_EQ(texels_of(151, joined(eac_block(103, 0), color))[4][3], 103);
  EXPECT_EQ(texels_of(153, eac_block(103, 2))[4], (Texel{21386, 0, 0, 65535})); // 668 of 11 bits
  EXPECT_EQ(texels_of(153, eac_block(103, 0))[4][0], (818 << 5) + (818 >> 6));
  EXPECT_EQ(texels_of(155, joined(eac_block(103, 2), eac_block(103, 0)))[4],
            (Texel{21386, (818 << 5) + (818 >> 6), 0, 65535}));
  EXPECT_FLOAT_EQ(floats_of(154, eac_block(60, 2))[16], 320.0f / 1023);
  EXPECT_FLOAT_EQ(floats_of(154, eac_block(60, 0))[16], 470.0f / 1023);
  EXPECT_EQ(floats_of(156, joined(eac_block(0x80, 15), eac_block(0x80, 15)))[17],
            -1.0f); // -128 counts as -127; clamped
}

// --- ASTC ---

constexpr std::uint64_t kAstcMode = 66; // 4 x 4 weights of 2 bits, one plane
constexpr Texel kMagenta = {255, 0, 255, 255};

// A block of one partition: values of the endpoint mode as bytes from bit 17 on; all weights 0 or all 3.
std::vector<Texel> astc_texels(std::uint64_t endpoint_mode, const std::vector<std::uint8_t>& values, bool last) {
  BitWriter writer;
  writer.bytes.resize(16);
  writer.set(0, 11, kAstcMode);
  writer.set(13, 4, endpoint_mode);
  for (std::size_t i = 0; i < values.size(); ++i) writer.set(17 + 8 * i, 8, values[i]);
  if (last) writer.set(96, 32, 0xffffffff);
  return texels_of(157, writer.bytes);
}

TEST(Astc, EndpointModes) {
  struct Case {
    std::uint64_t mode;
    std::vector<std::uint8_t> values;
    Texel first, second;
  };
  const Case cases[] = {{0, {20, 200}, {20, 20, 20, 255}, {200, 200, 200, 255}},
                        // (v0 >> 2) | (v1 & 0xc0), + (v1 & 0x3f)
                        {1, {200, 0x85}, {178, 178, 178, 255}, {183, 183, 183, 255}},
                        {1, {255, 0xff}, {255, 255, 255, 255}, {255, 255, 255, 255}},
                        {4, {1, 2, 3, 4}, {1, 1, 1, 3}, {2, 2, 2, 4}},
                        // base 100 >> 1 with the bit of 0x88: 178, offset 4; base 200 >> 1 = 100, offset -1
                        {5, {100, 0x88, 200, 0x7f}, {178, 178, 178, 100}, {182, 182, 182, 99}},
                        {6, {200, 100, 50, 128}, {100, 50, 25, 255}, {200, 100, 50, 255}},
                        {8, {1, 11, 2, 12, 3, 13}, {1, 2, 3, 255}, {11, 12, 13, 255}},
                        // The second sum is the smaller one: exchanged, with blue mixed into red and green.
                        {8, {101, 11, 102, 12, 103, 14}, {12, 13, 14, 255}, {102, 102, 103, 255}},
                        {9, {20, 2, 40, 4, 60, 6}, {10, 20, 30, 255}, {11, 22, 33, 255}},
                        // Offsets of -1, -2 and -3
                        {9, {20, 0x7e, 40, 0x7c, 60, 0x7a}, {18, 22, 27, 255}, {20, 25, 30, 255}},
                        {10, {200, 100, 50, 128, 7, 8}, {100, 50, 25, 7}, {200, 100, 50, 8}},
                        {12, {1, 11, 2, 12, 3, 13, 4, 14}, {1, 2, 3, 4}, {11, 12, 13, 14}},
                        {12, {101, 11, 102, 12, 103, 14, 9, 8}, {12, 13, 14, 8}, {102, 102, 103, 9}},
                        {13, {20, 2, 40, 4, 60, 6, 80, 8}, {10, 20, 30, 40}, {11, 22, 33, 44}}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.mode);
    EXPECT_EQ(astc_texels(c.mode, c.values, false), std::vector<Texel>(16, c.first));
    EXPECT_EQ(astc_texels(c.mode, c.values, true), std::vector<Texel>(16, c.second));
  }
  for (const std::uint64_t hdr : {2u, 3u, 7u, 11u, 14u, 15u})
    EXPECT_EQ(astc_texels(hdr, {}, false)[0], kMagenta) << hdr;
}

TEST(Astc, WeightsGrowDownwards) {
  // Luminance 0 to 255; the weight of texel i is bits 127 - 2 i and 126 - 2 i, the upper one the lower bit.
  BitWriter writer;
  writer.bytes.resize(16);
  writer.set(0, 11, kAstcMode);
  writer.set(25, 8, 255);
  writer.set(127 - 2 * 1, 1, 1);
  writer.set(126 - 2 * 2, 1, 1);
  writer.set(126 - 2 * 3, 2, 3);
  const std::vector<Texel> linear = texels_of(157, writer.bytes), srgb = texels_of(158, writer.bytes, true);
  EXPECT_EQ(linear[0][0], 0);
  EXPECT_EQ(linear[1][0], (21 * 65535 + 32) / 64 >> 8);
  EXPECT_EQ(linear[2][0], (43 * 65535 + 32) / 64 >> 8);
  EXPECT_EQ(linear[3][0], 255);
  EXPECT_EQ(srgb[1][0], (43 * 0x80 + 21 * 0xff80 + 32) / 64 >> 8);
}

TEST(Astc, VoidExtents) {
  const auto color = [](std::uint64_t flags, std::uint64_t s0, std::uint64_t s1) {
    return texels_of(157, block_of({{0, 9, 0x1fc},
                                    {9, 3, flags},
                                    {12, 13, s0},
                                    {25, 13, s1},
                                    {38, 13, s0},
                                    {51, 13, s1},
                                    {64, 16, 0x1234},
                                    {80, 16, 0xffff},
                                    {96, 16, 0},
                                    {112, 16, 0x80ff}}))[7];
  };
  EXPECT_EQ(color(6, 0x1fff, 0x1fff), (Texel{0x12, 255, 0, 0x80}));
  EXPECT_EQ(color(6, 0, 100), (Texel{0x12, 255, 0, 0x80}));
  EXPECT_EQ(color(6, 100, 100), kMagenta);       // an extent of nothing
  EXPECT_EQ(color(7, 0x1fff, 0x1fff), kMagenta); // HDR
  EXPECT_EQ(color(2, 0x1fff, 0x1fff), kMagenta); // reserved bits
}

TEST(Astc, IllegalBlocks) {
  const auto first = [](std::uint64_t mode, std::uint64_t more = 0) {
    return texels_of(157, block_of({{0, 11, mode}, {11, 18, more}}))[0];
  };
  EXPECT_EQ(first(kAstcMode), (Texel{0, 0, 0, 255}));
  EXPECT_EQ(first(0), kMagenta);                        // reserved
  EXPECT_EQ(first(0x1e4), kMagenta);                    // reserved
  EXPECT_EQ(first(2), kMagenta);                        // 4 x 2 weights of 2 bits: fewer than 24 bits
  EXPECT_EQ(first(kAstcMode | 1u << 7), kMagenta);      // 5 weights on 4 texels
  EXPECT_EQ(first(kAstcMode | 1u << 10, 3), kMagenta);  // two planes and four partitions
  EXPECT_EQ(first(kAstcMode, 3 | 12u << 14), kMagenta); // four partitions of RGBA: 32 values
  EXPECT_EQ(first(0x253 | 1u << 10), kMagenta);         // 32 weights of 5 bits: more than 96 bits
}

// The second plane weights the channel that two bits below the weights name. Endpoints are 0 and 15 of 0..47, which is
// 142: trits of 0 and 4 bits. (8 values take 45 bits.)
TEST(Astc, TwoPlanes) {
  for (unsigned channel = 0; channel < 4; ++channel) {
    BitWriter writer;
    writer.bytes.resize(16);
    writer.set(0, 11, kAstcMode | 1u << 10);
    writer.set(13, 4, 12);
    for (const unsigned upper : {6u, 17u, 28u, 40u}) writer.set(17 + upper, 4, 15);
    writer.set(62, 2, channel);
    writer.set(124, 2, 3); // the second weight of texel 0
    const std::vector<Texel> texels = texels_of(157, writer.bytes);
    Texel expected{};
    expected[channel] = 142;
    EXPECT_EQ(texels[0], expected);
    EXPECT_EQ(texels[1], Texel{});
  }
}

// --- UASTC ---

// From the tables "UASTC mode encoding": the bits of the mode, the first bits of RL0 and of the weights, the value of
// RL0 whose bits are all ones with a trit or quint of 0, where ETC2M lies, the bits of a weight, and the planes.
struct UastcLayout {
  unsigned mode, code, code_bits, red, red_bits, weights, value, multiplier, weight_bits, planes, channels;
};

constexpr UastcLayout kUastcLayouts[] = {
    {0, 0x01, 4, 29, 6, 65, 131, 0, 4, 1, 3},   {1, 0x35, 6, 21, 8, 69, 255, 0, 2, 1, 3},
    {2, 0x1d, 5, 25, 4, 73, 255, 0, 3, 1, 3},   {3, 0x03, 5, 53, 2, 89, 186, 0, 2, 1, 3},
    {4, 0x13, 5, 53, 3, 89, 158, 0, 2, 1, 3},   {5, 0x0b, 5, 20, 8, 68, 255, 0, 3, 1, 3},
    {6, 0x1b, 5, 36, 5, 66, 135, 0, 2, 2, 3},   {7, 0x07, 5, 53, 3, 89, 158, 0, 2, 1, 3},
    {9, 0x0f, 5, 33, 4, 97, 255, 24, 2, 1, 4},  {10, 0x02, 3, 33, 4, 65, 142, 16, 4, 1, 4},
    {11, 0x00, 2, 34, 4, 66, 142, 15, 2, 2, 4}, {12, 0x06, 3, 33, 6, 81, 131, 16, 3, 1, 4},
    {13, 0x1f, 5, 30, 8, 94, 255, 24, 1, 2, 4}, {14, 0x0d, 5, 28, 8, 92, 255, 24, 2, 1, 4},
    {15, 0x05, 7, 30, 8, 62, 255, 26, 4, 1, 2}, {16, 0x15, 6, 34, 8, 98, 255, 25, 2, 1, 2},
    {17, 0x25, 6, 29, 8, 61, 255, 25, 2, 2, 2}, {18, 0x09, 4, 19, 5, 49, 255, 0, 5, 1, 3}};

std::vector<Texel> uastc_texels(const UastcLayout& m, bool high, bool weighted, std::uint64_t multiplier = 1) {
  BitWriter writer;
  writer.bytes.resize(16);
  writer.set(0, m.code_bits, m.code);
  if (m.multiplier > 0) writer.set(m.multiplier, 4, multiplier);
  writer.set(m.red + (high ? m.red_bits : 0), m.red_bits, (1u << m.red_bits) - 1);
  if (weighted) // ones in the weight of texel 1, which lies behind that of texel 0 without its highest bit
    writer.set(m.weights + m.planes * (m.weight_bits - 1), m.planes * m.weight_bits, ~std::uint64_t{0});
  return texels_of(0, writer.bytes);
}

TEST(Uastc, FirstEndpointOfEveryMode) {
  for (const UastcLayout& m : kUastcLayouts) {
    SCOPED_TRACE(m.mode);
    const int value = static_cast<int>(m.value), grey = m.channels == 2 ? value : 0;
    const Texel low{value, grey, grey, m.channels == 3 ? 255 : 0}, black{0, 0, 0, low[3]};
    const Texel first = uastc_texels(m, false, false)[0], second = uastc_texels(m, true, true)[1];
    EXPECT_EQ(first, low);
    EXPECT_EQ(second, low);
    EXPECT_EQ(uastc_texels(m, true, true)[0], black);
    if (m.multiplier > 0) {
      EXPECT_EQ(uastc_texels(m, false, false, 0)[0], kMagenta);
    }
  }
}

TEST(Uastc, OneColour) {
  const Bytes block = block_of({{0, 5, 0x17}, {5, 8, 12}, {13, 8, 34}, {21, 8, 56}, {29, 8, 78}});
  EXPECT_EQ(texels_of(0, block), std::vector<Texel>(16, Texel{12, 34, 56, 78}));
}

// Patterns of the specification: the first rows of each table, as bits of texels of subset 1.
TEST(Uastc, Patterns) {
  // Mode 4: subset 1 has all ones in red (bits 71 to 73 and 74 to 76), subset 0 zeros.
  const auto subset1 = [](std::uint64_t mode_bits, std::uint64_t pattern) {
    const std::vector<Texel> texels = texels_of(0, block_of({{0, 5, mode_bits}, {20, 5, pattern}, {71, 6, 63}}));
    std::uint32_t mask = 0;
    for (std::size_t i = 0; i < 16; ++i) mask |= (texels[i][0] == 158 ? 1u : 0u) << i;
    return mask;
  };
  EXPECT_EQ(subset1(0x13, 0), 0xccccu);
  EXPECT_EQ(subset1(0x13, 8), 0xc800u);
  EXPECT_EQ(subset1(0x13, 16), 0xff71u);
  EXPECT_EQ(subset1(0x13, 29), 0x36c9u);
  EXPECT_EQ(subset1(0x07, 0), 0x00f0u); // mode 7
  EXPECT_EQ(subset1(0x07, 9), 0x00eeu);
  EXPECT_EQ(subset1(0x07, 18), 0x00efu);
  EXPECT_EQ(texels_of(0, block_of({{0, 5, 0x13}, {20, 5, 30}}))[0], kMagenta); // there are 30 patterns
  EXPECT_EQ(texels_of(0, block_of({{0, 5, 0x07}, {20, 5, 19}}))[0], kMagenta);
  EXPECT_EQ(texels_of(0, block_of({{0, 5, 0x03}, {20, 4, 11}}))[0], kMagenta);
}

TEST(Uastc, InvalidModesAreMagenta) {
  EXPECT_EQ(texels_of(0, block_of({{0, 7, 0x45}})), std::vector<Texel>(16, kMagenta));
}

TEST(Uastc, TwoChannels) {
  KtxFile file = file_of(0, block_of({{0, 5, 0x17}, {5, 8, 12}, {13, 8, 34}, {21, 8, 56}, {29, 8, 78}}), 4, 4);
  file.channels = {5};
  EXPECT_EQ(texel(read_ktx(file.bytes()), 3), (Texel{12, 78, 0, 255}));
  file.channels = {6};
  EXPECT_EQ(texel(read_ktx(file.bytes()), 3), (Texel{12, 34, 0, 255}));
}

// --- noise ---

// 64 x 64 blocks of noise, and a number of the picture that they are: FNV-1a of its bytes.
std::uint64_t picture_of_noise(std::uint32_t vk_format, std::uint32_t block_width, std::uint32_t block_height,
                               std::uint32_t block_bytes) {
  std::mt19937 random(vk_format + 1);
  Bytes blocks(std::size_t{64} * 64 * block_bytes);
  for (std::uint8_t& byte : blocks) byte = static_cast<std::uint8_t>(random() >> 24);
  const ktx::Picture picture = read_ktx(file_of(vk_format, blocks, 64 * block_width, 64 * block_height).bytes());
  std::uint64_t hash = 0xcbf29ce484222325;
  const auto add = [&](const auto& values) {
    for (const auto& value : values)
      for (std::size_t i = 0; i < sizeof(value); ++i)
        hash = (hash ^ (reinterpret_cast<const unsigned char*>(&value)[i])) * 0x100000001b3;
  };
  add(picture.bytes);
  add(picture.words);
  add(picture.floats);
  return hash;
}

struct Noise {
  std::uint32_t vk_format, block_width, block_height, block_bytes;
  std::uint64_t hash;
};

constexpr Noise kNoise[] = {
    {131, 4, 4, 8, 0x32838795f91004ed},    {133, 4, 4, 8, 0xe3227d0eb6989408},    {135, 4, 4, 16, 0x9f220be0e43fb45a},
    {137, 4, 4, 16, 0xb8b67ec80c61de39},   {139, 4, 4, 8, 0xc6f82f7d03f361f3},    {140, 4, 4, 8, 0x8664a8bde37d6a47},
    {141, 4, 4, 16, 0x9930cc4a2f8dc227},   {142, 4, 4, 16, 0x3f101d5e03bd3d1b},   {143, 4, 4, 16, 0xd7b7f8f1337ac847},
    {144, 4, 4, 16, 0x8abc9bf262d7ad2e},   {145, 4, 4, 16, 0xe5486feffc092858},   {147, 4, 4, 8, 0xc3247581be4ca675},
    {149, 4, 4, 8, 0x9fdfced03af37896},    {151, 4, 4, 16, 0x3746843d72d39a18},   {153, 4, 4, 8, 0x627da6c25415e092},
    {154, 4, 4, 8, 0x21861f2b0ecee443},    {155, 4, 4, 16, 0x14486042ec0a1a8c},   {156, 4, 4, 16, 0x88d7f1474a4f92bd},
    {157, 4, 4, 16, 0x37b84ac5d3903d59},   {159, 5, 4, 16, 0x8fa1d28fb36d1a30},   {161, 5, 5, 16, 0xdf294353d2564bc6},
    {163, 6, 5, 16, 0xa98af2db608423f7},   {165, 6, 6, 16, 0x40522ad08f3b784},    {167, 8, 5, 16, 0x15565ac1428a2d52},
    {169, 8, 6, 16, 0x72c374a6ad600a1a},   {171, 8, 8, 16, 0xb537fa2d42296335},   {173, 10, 5, 16, 0xd3b45d1f9bb5fcab},
    {175, 10, 6, 16, 0x35012a104da62317},  {177, 10, 8, 16, 0x8a5e4ad73116a098},  {179, 10, 10, 16, 0x34a3640e2ee789f7},
    {181, 12, 10, 16, 0x7e20674e93dbe34d}, {183, 12, 12, 16, 0x69fc3aaac63a1a99}, {0, 4, 4, 16, 0xa4238185a6bfe2a5},
};

TEST(Noise, IsThePictureOfOtherDecoders) {
  for (const Noise& noise : kNoise) {
    const std::uint64_t hash =
        picture_of_noise(noise.vk_format, noise.block_width, noise.block_height, noise.block_bytes);
    EXPECT_EQ(hash, noise.hash) << "{" << noise.vk_format << ", " << noise.block_width << ", " << noise.block_height
                                << ", " << noise.block_bytes << ", 0x" << std::hex << hash << "},";
  }
}

} // namespace
} // namespace wavepath::test
