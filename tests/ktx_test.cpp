// KTX2 files: containers that are sound and that are not, supercompression, BasisLZ, and texels that are not
// compressed.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/ktx_builder.h"

namespace wavepath::test {
namespace {

using Texel = std::array<int, 4>;

Texel texel_at(const ktx::Picture& picture, std::size_t x, std::size_t y) {
  Texel texel{};
  for (std::size_t c = 0; c < 4; ++c) texel[c] = picture.bytes.at((y * picture.width + x) * 4 + c);
  return texel;
}

Bytes metadata(const std::string& key, const std::string& value) {
  Bytes bytes;
  put(bytes, key.size() + value.size() + 2, 4);
  for (const std::string& part : {key, value}) {
    bytes.insert(bytes.end(), part.begin(), part.end());
    bytes.push_back(0);
  }
  bytes.resize((bytes.size() + 3) / 4 * 4);
  return bytes;
}

// --- texels that are not compressed ---

KtxFile texels(std::uint32_t vk_format, Bytes level) {
  KtxFile file;
  file.vk_format = vk_format;
  file.level = std::move(level);
  return file;
}

TEST(KtxTexels, Bytes) {
  const auto bytes_of = [](std::uint32_t vk_format, const Bytes& level) {
    return read_ktx(texels(vk_format, level).bytes()).bytes;
  };
  EXPECT_EQ(bytes_of(9, {7}), (Bytes{7, 0, 0, 255}));
  EXPECT_EQ(bytes_of(16, {7, 8}), (Bytes{7, 8, 0, 255}));
  EXPECT_EQ(bytes_of(23, {7, 8, 9}), (Bytes{7, 8, 9, 255}));
  EXPECT_EQ(bytes_of(37, {7, 8, 9, 0}), (Bytes{7, 8, 9, 0}));
  EXPECT_EQ(bytes_of(30, {7, 8, 9}), (Bytes{9, 8, 7, 255}));
  EXPECT_EQ(bytes_of(44, {7, 8, 9, 10}), (Bytes{9, 8, 7, 10}));
  for (const std::uint32_t srgb : {43u, 50u, 57u}) {
    KtxFile file = texels(srgb, {7, 8, 9, 10});
    EXPECT_EQ(read_ktx(file.bytes()).transfer, ktx::Transfer::srgb); // though the descriptor says linear
  }
}

TEST(KtxTexels, WordsAndSignedOnes) {
  const ktx::Picture words = read_ktx(texels(91, {1, 0, 2, 1, 255, 255, 0, 0}).bytes());
  EXPECT_EQ(words.words, (std::vector<std::uint16_t>{1, 258, 65535, 0}));
  EXPECT_EQ(read_ktx(texels(70, {0x34, 0x12}).bytes()).words, (std::vector<std::uint16_t>{0x1234, 0, 0, 65535}));
  EXPECT_EQ(read_ktx(texels(17, {0x80, 127}).bytes()).floats, (std::vector<float>{-1, 1, 0, 1}));
  EXPECT_EQ(read_ktx(texels(71, {0x01, 0x80}).bytes()).floats, (std::vector<float>{-1, 0, 0, 1}));
}

TEST(KtxTexels, Floats) {
  // 1, 2^-24 (the least denormal), -65504, infinity
  const std::vector<float> halves =
      read_ktx(texels(97, {0x00, 0x3c, 0x01, 0x00, 0xff, 0xfb, 0x00, 0x7c}).bytes()).floats;
  EXPECT_EQ(halves, (std::vector<float>{1.0f, 0x1p-24f, -65504.0f, std::numeric_limits<float>::infinity()}));
  EXPECT_TRUE(std::isnan(read_ktx(texels(76, {0x01, 0x7c}).bytes()).floats[0]));
  EXPECT_EQ(read_ktx(texels(100, {0, 0, 0x20, 0xc1}).bytes()).floats, (std::vector<float>{-10, 0, 0, 1}));
  // E5B9G9R9: mantissas 256, 1 and 511, exponent 16: times 2^(16 - 24)
  Bytes shared;
  put(shared, 256 | 1 << 9 | 511 << 18 | 16u << 27, 4);
  EXPECT_EQ(read_ktx(texels(123, shared).bytes()).floats, (std::vector<float>{1, 0x1p-8f, 511 * 0x1p-8f, 1}));
  // B10G11R11: 1 is exponent 15 with mantissa 0; 1.5; 2
  Bytes small;
  put(small, 15u << 6 | (15u << 6 | 32u) << 11 | 16u << 5 << 22, 4);
  EXPECT_EQ(read_ktx(texels(122, small).bytes()).floats, (std::vector<float>{1, 1.5f, 2, 1}));
}

// --- the container ---

TEST(KtxContainer, TransferFunctions) {
  KtxFile file;
  const std::pair<int, ktx::Transfer> functions[] = {
      {0, ktx::Transfer::linear}, {1, ktx::Transfer::linear}, {2, ktx::Transfer::srgb}, {11, ktx::Transfer::other}};
  for (const auto& [number, function] : functions) {
    file.transfer = static_cast<std::uint8_t>(number);
    EXPECT_EQ(read_ktx(file.bytes()).transfer, function);
  }
  EXPECT_FALSE(read_ktx(file.bytes()).premultiplied);
  file.flags = 1;
  EXPECT_TRUE(read_ktx(file.bytes()).premultiplied);
}

TEST(KtxContainer, Swizzle) {
  KtxFile file;
  file.metadata = metadata("KTXorientation", "rd");
  const Bytes more = metadata("KTXswizzle", "b01r");
  file.metadata.insert(file.metadata.end(), more.begin(), more.end());
  EXPECT_EQ(read_ktx(file.bytes()).bytes, (Bytes{3, 0, 255, 1}));
  file.metadata = metadata("KTXswizzle", "xyzw");
  EXPECT_NE(ktx_refusal(file.bytes()).find("KTXswizzle"), std::string::npos);
}

TEST(KtxContainer, LevelsAndOneLayerArePassedOver) {
  KtxFile file = texels(9, {1, 2, 3, 4});
  file.width = file.height = 2;
  file.levels = 2;
  file.layers = 1;
  EXPECT_EQ(read_ktx(file.bytes()).bytes.size(), 16u);
  file.levels = 0; // smaller ones are to be made
  EXPECT_EQ(read_ktx(file.bytes()).width, 2u);
}

TEST(KtxContainer, OtherShapesAreRefused) {
  const auto refusal_of = [](void (*change)(KtxFile&)) {
    KtxFile file;
    change(file);
    return ktx_refusal(file.bytes());
  };
  EXPECT_EQ(refusal_of([](KtxFile& f) { f.faces = 6; }), "is a cube map, not a 2D picture");
  EXPECT_EQ(refusal_of([](KtxFile& f) { f.height = 0; }), "is a 1D texture, not a 2D picture");
  EXPECT_EQ(refusal_of([](KtxFile& f) { f.depth = 2; }), "is a 3D texture, not a 2D picture");
  EXPECT_EQ(refusal_of([](KtxFile& f) { f.layers = 3; }), "is an array of 3 pictures, not one");
  EXPECT_EQ(refusal_of([](KtxFile& f) { f.width = 0; }), "is damaged or cut short (its width is 0)");
  EXPECT_EQ(refusal_of([](KtxFile& f) { f.faces = 2; }), "is damaged or cut short (it has 2 faces)");
  EXPECT_EQ(refusal_of([](KtxFile& f) { f.vk_format = 2; }),
            "has texels of Vulkan's format 2, which wavepath does not support");
  EXPECT_EQ(refusal_of([](KtxFile& f) { f.vk_format = 0; }),
            "has texels of colour model 1, which wavepath does not support");
  EXPECT_EQ(refusal_of([](KtxFile& f) { f.scheme = 4; }), "has supercompression 4, which wavepath does not support");
  EXPECT_EQ(refusal_of([](KtxFile& f) { f.scheme = 1; }), "is damaged or cut short (BasisLZ, but not of ETC1S)");
  EXPECT_EQ(refusal_of([](KtxFile& f) { f.levels = 2; }),
            "is damaged or cut short (2 levels, but 1 x 1 texels have at most 1)");
  EXPECT_EQ(refusal_of([](KtxFile& f) { f.level.push_back(0); }),
            "is damaged or cut short (level 0 has 5 bytes instead of 4)");
}

TEST(KtxContainer, MoreLevelsThanTheFileHas) {
  for (const std::uint8_t levels : {32, 33, 255}) {
    KtxFile file;
    file.width = 0xffffffff; // of which 32 levels can be made
    Bytes bytes = file.bytes();
    bytes[40] = levels;
    EXPECT_NE(ktx_refusal(bytes).find(levels == 32 ? "the index of levels" : "at most 32"), std::string::npos);
  }
}

TEST(KtxContainer, CheckComesBeforeMemory) {
  KtxFile file;
  file.width = file.height = 60000;
  try {
    ktx::read(file.bytes(), [](std::uint32_t width, std::uint32_t height) {
      throw ktx::FileError(std::to_string(width) + " x " + std::to_string(height));
    });
    FAIL();
  } catch (const ktx::FileError& error) {
    EXPECT_STREQ(error.what(), "60000 x 60000");
  }
  EXPECT_NE(ktx_refusal(file.bytes()).find("instead of 14400000000"), std::string::npos);
}

// Products of these sizes, in bytes, are 0 or 16 in 64 bits.
TEST(KtxContainer, SizesThatOverflow) {
  for (const std::uint32_t vk_format : {109u, 145u}) {
    KtxFile file;
    file.vk_format = vk_format;
    file.width = file.height = 0x80000000;
    file.level = Bytes(16);
    EXPECT_EQ(ktx_refusal(file.bytes()), "has 2147483648 x 2147483648 texels");
  }
}

// Every prefix of a file is refused: each part lies within what the file has.
TEST(KtxContainer, CutShort) {
  KtxFile file;
  file.metadata = metadata("KTXwriter", "a test");
  const Bytes whole = file.bytes();
  ASSERT_EQ(ktx_refusal(whole), "was accepted");
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const std::string refusal = ktx_refusal({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)});
    EXPECT_TRUE(refusal == "is not KTX2" || refusal.starts_with("is damaged or cut short (")) << length << refusal;
  }
}

// Offsets and lengths near the greatest numbers, which overflow if they are added.
TEST(KtxContainer, OffsetsBeyondTheEnd) {
  const Bytes whole = KtxFile{}.bytes();
  for (const std::size_t at : {48u, 52u, 56u, 60u, 64u, 72u, 80u, 88u, 96u}) {
    for (const std::uint64_t value : {0xffffffffull, 0xfffffff0ull, 0xffffffffffffffffull, 0x7fffffffffffffffull}) {
      Bytes damaged = whole;
      for (std::size_t i = 0; i < (at < 64 ? 4u : 8u); ++i)
        damaged[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
      // An offset of a part of no length matters to nobody.
      if (at == 96) continue; // the length without supercompression
      EXPECT_TRUE(ktx_refusal(damaged).starts_with("is damaged or cut short (")) << at << ktx_refusal(damaged);
    }
  }
}

TEST(KtxContainer, Descriptor) {
  const Bytes whole = KtxFile{}.bytes();
  const auto with = [&](std::size_t at, std::uint8_t value) {
    Bytes damaged = whole;
    damaged[104 + at] = value;
    return ktx_refusal(damaged);
  };
  EXPECT_NE(with(0, 99).find("another length"), std::string::npos);
  EXPECT_NE(with(4, 1).find("basic"), std::string::npos);
  for (const std::uint8_t length : {0, 23, 25, 41, 200})
    EXPECT_NE(with(10, length).find("a block of"), std::string::npos) << int{length};
}

TEST(KtxContainer, Metadata) {
  KtxFile file;
  for (const Bytes& bad : {Bytes{1, 0, 0}, Bytes{1, 0, 0, 0, 'a', 0, 0, 0}, Bytes{9, 0, 0, 0, 'a', 0, 0, 0},
                           Bytes{255, 255, 255, 255, 'a', 0, 0, 0}, Bytes{4, 0, 0, 0, 'a', 'b', 'c', 'd'}}) {
    file.metadata = bad;
    EXPECT_NE(ktx_refusal(file.bytes()).find("the metadata"), std::string::npos);
  }
}

// --- supercompression ---

// A frame of one raw block (RFC 8478): magic, a single segment with a length of one byte.
Bytes zstd_frame(const Bytes& data) {
  Bytes frame = {0x28, 0xb5, 0x2f, 0xfd, 0x20, static_cast<std::uint8_t>(data.size())};
  put(frame, 1 | data.size() << 3, 3);
  frame.insert(frame.end(), data.begin(), data.end());
  return frame;
}

// One stored block (RFC 1950 and 1951).
Bytes zlib_stream(const Bytes& data) {
  std::uint32_t a = 1, b = 0;
  for (const std::uint8_t byte : data) a = (a + byte) % 65521, b = (b + a) % 65521;
  Bytes stream = {0x78, 0x01, 1};
  put(stream, data.size(), 2);
  put(stream, ~data.size(), 2);
  stream.insert(stream.end(), data.begin(), data.end());
  for (int shift = 24; shift >= 0; shift -= 8) stream.push_back(static_cast<std::uint8_t>((b << 16 | a) >> shift));
  return stream;
}

TEST(KtxSupercompression, ZstdAndZlib) {
  for (const std::uint32_t scheme : {2u, 3u}) {
    const auto packed = [&](const Bytes& data) { return scheme == 2 ? zstd_frame(data) : zlib_stream(data); };
    KtxFile file;
    file.scheme = scheme;
    file.level = packed({9, 8, 7, 6});
    file.uncompressed = 4;
    EXPECT_EQ(read_ktx(file.bytes()).bytes, (Bytes{9, 8, 7, 6}));
    const KtxFile sound = file;
    file.uncompressed = 5;
    EXPECT_EQ(ktx_refusal(file.bytes()), "is damaged or cut short (level 0 has 5 bytes instead of 4)");
    file.uncompressed = 4;
    for (const Bytes& level : {packed({1, 2, 3}), packed({1, 2, 3, 4, 5}), Bytes{1, 2, 3}}) {
      file.level = level;
      EXPECT_TRUE(
          ktx_refusal(file.bytes())
              .starts_with(scheme == 2 ? "is damaged or cut short (Zstandard: " : "is damaged or cut short (zlib: "))
          << ktx_refusal(file.bytes());
    }
    for (std::size_t length = 1; length < sound.level.size(); ++length) {
      file.level.assign(sound.level.begin(), sound.level.begin() + static_cast<std::ptrdiff_t>(length));
      EXPECT_NE(ktx_refusal(file.bytes()), "was accepted") << length;
    }
  }
}

// --- BasisLZ ---

// Endpoint 0: (31, 0, 16) of 5 bits is (255, 0, 132), table 1: -17, -5, 5, 17. Endpoint 1: (31, 1, 15) is (255, 8,
// 123), table 0: -8, -2, 2, 8. Selector 0 is 0, 1, 2, 3 in each row; the rows of selector 1 are 3, 2, 1 and 0.
TEST(KtxBasis, CodebooksAndPredictions) {
  Etc1sFile etc1s;
  etc1s.first_prediction = 3 | 0 << 2 | 1 << 4 | 3 << 6; // stored; left; above; stored
  etc1s.deltas = {0, 1};
  etc1s.selectors = {0, 1, 1, 0};
  const ktx::Picture picture = read_ktx(etc1s.file().bytes());
  EXPECT_EQ(picture.payload, "ETC1S");
  EXPECT_EQ(texel_at(picture, 0, 0), (Texel{238, 0, 115, 255}));
  EXPECT_EQ(texel_at(picture, 1, 0), (Texel{250, 0, 127, 255}));
  EXPECT_EQ(texel_at(picture, 2, 3), (Texel{255, 5, 137, 255}));
  EXPECT_EQ(texel_at(picture, 3, 0), (Texel{255, 17, 149, 255}));
  EXPECT_EQ(texel_at(picture, 4, 0), (Texel{255, 17, 149, 255})); // endpoint of the left, selector 1, first row: 3
  EXPECT_EQ(texel_at(picture, 7, 3), (Texel{238, 0, 115, 255}));
  EXPECT_EQ(texel_at(picture, 0, 5), (Texel{255, 5, 137, 255})); // endpoint of above
  EXPECT_EQ(texel_at(picture, 4, 4), (Texel{247, 0, 115, 255})); // endpoint 1
  EXPECT_EQ(texel_at(picture, 7, 7), (Texel{255, 16, 131, 255}));
}

TEST(KtxBasis, PicturesOfAnySize) {
  Etc1sFile etc1s;
  etc1s.first_prediction = 3 | 0 << 2 | 1 << 4 | 2 << 6;
  etc1s.deltas = {1};
  etc1s.selectors = {0, 0, 0, 0};
  etc1s.width = 5;
  etc1s.height = 7;
  const ktx::Picture picture = read_ktx(etc1s.file().bytes());
  EXPECT_EQ(picture.bytes.size(), 5u * 7 * 4);
  EXPECT_EQ(texel_at(picture, 4, 6), (Texel{247, 0, 115, 255}));
}

// The history holds the selectors used last: symbol 2 is its first place, symbol 3 its second, 4 a run of the first.
TEST(KtxBasis, HistoryOfSelectors) {
  Etc1sFile etc1s;
  etc1s.first_prediction = 3 | 0 << 2 | 1 << 4 | 1 << 6;
  etc1s.deltas = {0};
  etc1s.selectors = {1, 3, 2, 2}; // 1 goes to place 1; its use swaps it with place 0
  const ktx::Picture picture = read_ktx(etc1s.file().bytes());
  for (const std::size_t x : {0u, 4u})
    for (const std::size_t y : {0u, 4u}) EXPECT_EQ(texel_at(picture, x, y), (Texel{255, 17, 149, 255})) << x << y;
  etc1s.selectors = {1, 3, 4}; // a run of at least 3: longer than what is left
  EXPECT_EQ(read_ktx(etc1s.file().bytes()).bytes, picture.bytes);
}

TEST(KtxBasis, AlphaIsASlice) {
  Etc1sFile etc1s;
  etc1s.first_prediction = 3;
  etc1s.width = etc1s.height = 4;
  etc1s.deltas = {0};
  etc1s.selectors = {0};
  etc1s.has_alpha = true;
  KtxFile file = etc1s.file();
  EXPECT_EQ(texel_at(read_ktx(file.bytes()), 3, 0), (Texel{255, 17, 149, 17}));
  file.channels = {3, 4}; // red and green
  EXPECT_EQ(texel_at(read_ktx(file.bytes()), 3, 0), (Texel{255, 17, 0, 255}));
}

TEST(KtxBasis, DamagedSlices) {
  const auto refusal_of = [](const std::function<void(Etc1sFile&)>& change) {
    Etc1sFile etc1s;
    etc1s.first_prediction = 3 | 0 << 2 | 1 << 4 | 1 << 6;
    etc1s.deltas = {0};
    etc1s.selectors = {0, 0, 0, 0};
    change(etc1s);
    return ktx_refusal(etc1s.file().bytes());
  };
  EXPECT_EQ(refusal_of([](Etc1sFile&) {}), "was accepted");
  EXPECT_NE(refusal_of([](Etc1sFile& f) { f.first_prediction = 0; }).find("a block outside"), std::string::npos);
  EXPECT_NE(refusal_of([](Etc1sFile& f) { f.first_prediction = 1; }).find("a block outside"), std::string::npos);
  EXPECT_NE(refusal_of([](Etc1sFile& f) { f.first_prediction = 2; }).find("a block outside"), std::string::npos);
  EXPECT_NE(refusal_of([](Etc1sFile& f) { f.endpoint_count = 0; }).find("an endpoint"), std::string::npos);
  EXPECT_NE(refusal_of([](Etc1sFile& f) {
              f.selectors = {4, 0, 0, 0}, f.selector_count = 0;
            }).find("is damaged"),
            std::string::npos);
  EXPECT_NE(refusal_of([](Etc1sFile& f) { f.width = f.height = 4000; }).find("end too soon"), std::string::npos);
  EXPECT_NE(refusal_of([](Etc1sFile& f) { f.endpoint_count = 65535; }).find("the endpoints of BasisLZ"),
            std::string::npos);
  EXPECT_NE(refusal_of([](Etc1sFile& f) { f.selector_count = 65535; }).find("the selectors of BasisLZ"),
            std::string::npos);
}

TEST(KtxBasis, DamagedGlobalData) {
  Etc1sFile etc1s;
  etc1s.first_prediction = 3;
  etc1s.width = etc1s.height = 4;
  etc1s.deltas = {0};
  etc1s.selectors = {0};
  const KtxFile sound = etc1s.file();
  ASSERT_EQ(ktx_refusal(sound.bytes()), "was accepted");
  const auto with = [&](std::size_t at, std::uint8_t value) {
    KtxFile file = sound;
    file.global[at] = value;
    return ktx_refusal(file.bytes());
  };
  for (const std::size_t length : {4u, 8u, 12u, 16u})
    EXPECT_NE(with(length + 3, 255).find("another length"), std::string::npos);
  EXPECT_EQ(with(20, 2), "is a frame of an animation that needs the frame before it");
  EXPECT_NE(with(27, 255).find("beyond its level"), std::string::npos);
  EXPECT_NE(with(31, 255).find("beyond its level"), std::string::npos);
  EXPECT_NE(with(28, 0).find("empty"), std::string::npos);
  KtxFile file = sound;
  file.levels = 3;
  EXPECT_NE(ktx_refusal(file.bytes()).find("another length"), std::string::npos); // three images are described
  for (std::size_t length = 0; length < sound.global.size(); ++length) {
    file = sound;
    file.global.resize(length);
    EXPECT_NE(ktx_refusal(file.bytes()), "was accepted") << length;
  }
}

// Codes of too many words, of lengths behind the last symbol, that repeat nothing, and words that a code does not have.
TEST(KtxBasis, BadHuffmanCodes) {
  const auto refusal_of = [](const BitWriter& endpoints) {
    Etc1sFile etc1s;
    KtxFile file = etc1s.file();
    const std::uint32_t before = file.global[4] | file.global[5] << 8;
    file.global.erase(file.global.begin() + 40, file.global.begin() + 40 + before);
    file.global.insert(file.global.begin() + 40, endpoints.bytes.begin(), endpoints.bytes.end());
    for (std::size_t i = 0; i < 4; ++i)
      file.global[4 + i] = static_cast<std::uint8_t>(endpoints.bytes.size() >> (8 * i));
    return ktx_refusal(file.bytes());
  };
  BitWriter crowded;
  add_code(crowded, {1, 1, 1});
  crowded.bytes.resize(600);
  EXPECT_NE(refusal_of(crowded).find("too many words of 1 bits"), std::string::npos) << refusal_of(crowded);
  // The code of lengths: symbol 17 (3 to 10 zeros) alone, of one bit.
  BitWriter zeros;
  zeros.add(2, 14);
  zeros.add(1, 5);
  zeros.add(1, 3);
  zeros.add(0, 1);
  zeros.add(0, 3);
  zeros.bytes.resize(600);
  EXPECT_NE(refusal_of(zeros).find("more lengths than symbols"), std::string::npos) << refusal_of(zeros);
  BitWriter repeats; // symbol 19: the length before, of which there is none
  repeats.add(9, 14);
  repeats.add(3, 5);
  for (const int size : {0, 0, 1}) repeats.add(static_cast<std::uint64_t>(size), 3);
  repeats.bytes.resize(600);
  EXPECT_NE(refusal_of(repeats).find("repeat a code length that is not there"), std::string::npos)
      << refusal_of(repeats);
  BitWriter counts;
  counts.add(9, 14);
  counts.add(22, 5);
  counts.bytes.resize(600);
  EXPECT_NE(refusal_of(counts).find("22 code lengths"), std::string::npos) << refusal_of(counts);
  BitWriter lone; // one word of one bit, and the other one in the data
  lone.add(9, 14);
  lone.add(1, 5);
  lone.add(1, 3);
  lone.add(1, 1);
  lone.bytes.resize(600);
  EXPECT_NE(refusal_of(lone).find("no word of their Huffman code"), std::string::npos) << refusal_of(lone);
}

// --- noise ---

// Sound files of several kinds with bytes exchanged, cut and repeated: a picture or a refusal, nothing else. The fuzz
// target looks longer.
TEST(KtxNoise, IsReadOrRefused) {
  std::vector<Bytes> files = {KtxFile{}.bytes()};
  Etc1sFile etc1s;
  etc1s.first_prediction = 3 | 0 << 2 | 1 << 4 | 3 << 6;
  etc1s.deltas = {0, 1};
  etc1s.selectors = {0, 1, 3, 4};
  etc1s.has_alpha = true;
  files.push_back(etc1s.file().bytes());
  for (const std::uint32_t scheme : {2u, 3u}) {
    KtxFile file;
    file.scheme = scheme;
    file.level = scheme == 2 ? zstd_frame({9, 8, 7, 6}) : zlib_stream({9, 8, 7, 6});
    file.uncompressed = 4;
    files.push_back(file.bytes());
  }
  std::mt19937 random(1);
  int accepted = 0;
  const int rounds = 20000;
  for (int round = 0; round < rounds; ++round) {
    Bytes file = files[static_cast<std::size_t>(round) % files.size()];
    for (unsigned edits = 1 + random() % 4; edits > 0; --edits) {
      const std::size_t at = random() % file.size();
      if (random() % 8 == 0)
        file.resize(std::max<std::size_t>(at, 1));
      else
        file[at] = random() % 2 ? static_cast<std::uint8_t>(random())
                                : static_cast<std::uint8_t>(file[at] ^ 1u << random() % 8);
    }
    try {
      ktx::read(file, [](std::uint32_t width, std::uint32_t height) {
        if (std::uint64_t{width} * height > 4096) throw ktx::FileError("is too large");
      });
      ++accepted;
    } catch (const ktx::FileError& error) {
      EXPECT_FALSE(std::string(error.what()).empty());
    }
  }
  EXPECT_GT(accepted, rounds / 100);
  EXPECT_LT(accepted, rounds);
}

} // namespace
} // namespace wavepath::test
