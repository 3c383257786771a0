// Picture files: every kind by known bytes, back from the writers, cut short, damaged, and too large to be believed.
#include "host/codecs/decode.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <jpeglib.h>
#include <webp/encode.h>

#include "host/codecs/jpeg.h"
#include "host/codecs/png.h"
#include "host/codecs/webp.h"

namespace wavepath::test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Words = std::vector<std::uint16_t>;

void accept(const ImageShape&) {}

DecodedImage decode_any(const Bytes& file) { return decode(file_format(file).value(), file, accept); }

std::string refusal(const Bytes& file, const CheckShape& check = accept) {
  const std::optional<FileFormat> format = file_format(file);
  if (!format) return "no format";
  try {
    decode(*format, file, check);
  } catch (const ImageError& error) {
    return error.what();
  }
  return "was accepted";
}

std::array<std::uint32_t, 3> shape_of(const DecodedImage& image) {
  return {image.shape.width, image.shape.height, image.shape.channels};
}

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Bytes text(const std::string& words) { return {words.begin(), words.end()}; }

// --- PNG, written by hand: what is expected depends on no encoder ---

Bytes big_endian(std::uint32_t value) {
  return {static_cast<std::uint8_t>(value >> 24), static_cast<std::uint8_t>(value >> 16),
          static_cast<std::uint8_t>(value >> 8), static_cast<std::uint8_t>(value)};
}

std::uint32_t crc32(const Bytes& bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

Bytes chunk(const std::string& type, const Bytes& data) {
  const Bytes body = text(type) + data;
  return big_endian(static_cast<std::uint32_t>(data.size())) + body + big_endian(crc32(body));
}

// One stored block, not compressed.
Bytes zlib(const Bytes& data) {
  std::uint32_t a = 1, b = 0;
  for (const std::uint8_t byte : data) a = (a + byte) % 65521, b = (b + a) % 65521;
  const auto length = static_cast<std::uint16_t>(data.size());
  const Bytes header{0x78,
                     0x01,
                     1,
                     static_cast<std::uint8_t>(length & 255),
                     static_cast<std::uint8_t>(length >> 8),
                     static_cast<std::uint8_t>(~length & 255),
                     static_cast<std::uint8_t>(~length >> 8 & 255)};
  return header + data + big_endian(b << 16 | a);
}

enum Color : std::uint8_t { grey = 0, rgb = 2, palette = 3, grey_alpha = 4, rgba = 6 };

struct Png {
  std::uint32_t width, height;
  std::uint8_t depth;
  Color color;
  Bytes scanlines;    // each begins with its filter
  Bytes between = {}; // chunks before the pixels
  bool interlaced = false;
};

Bytes file_of(const Png& png) {
  const Bytes header =
      big_endian(png.width) + big_endian(png.height) + Bytes{png.depth, png.color, 0, 0, png.interlaced};
  return text("\x89PNG\r\n\x1a\n") + chunk("IHDR", header) + png.between + chunk("IDAT", zlib(png.scanlines)) +
         chunk("IEND", {});
}

DecodedImage read(const Png& png) { return decode_any(file_of(png)); }

TEST(Png, GreyOfEveryDepth) {
  EXPECT_EQ(read({8, 1, 1, grey, {0, 0xa5}}).bytes, (Bytes{255, 0, 255, 0, 0, 255, 0, 255}));
  EXPECT_EQ(read({4, 1, 2, grey, {0, 0x1b}}).bytes, (Bytes{0, 85, 170, 255}));
  EXPECT_EQ(read({2, 1, 4, grey, {0, 0x3f}}).bytes, (Bytes{51, 255}));
  const DecodedImage eight = read({2, 2, 8, grey, {0, 7, 200, 0, 0, 255}});
  EXPECT_EQ(eight.bytes, (Bytes{7, 200, 0, 255}));
  EXPECT_EQ(shape_of(eight), (std::array<std::uint32_t, 3>{2, 2, 1}));
  const DecodedImage deep = read({2, 1, 16, grey, {0, 0x12, 0x34, 0xff, 0xfe}});
  EXPECT_EQ(deep.words, (Words{0x1234, 0xfffe}));
  EXPECT_TRUE(deep.bytes.empty());
}

TEST(Png, ColourAndAlpha) {
  EXPECT_EQ(read({1, 2, 8, rgb, {0, 1, 2, 3, 0, 4, 5, 6}}).bytes, (Bytes{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(read({1, 1, 8, rgba, {0, 9, 8, 7, 0}}).bytes, (Bytes{9, 8, 7, 0})); // not multiplied by alpha
  EXPECT_EQ(read({1, 1, 16, rgb, {0, 1, 0, 2, 0, 3, 0}}).words, (Words{256, 512, 768}));
  EXPECT_EQ(read({1, 1, 16, rgba, {0, 1, 0, 2, 0, 3, 0, 0, 1}}).words, (Words{256, 512, 768, 1}));
  const DecodedImage two = read({1, 1, 8, grey_alpha, {0, 100, 50}});
  EXPECT_EQ(two.bytes, (Bytes{100, 50}));
  EXPECT_EQ(two.shape.channels, 2u);
  EXPECT_EQ(read({1, 1, 16, grey_alpha, {0, 1, 1, 2, 2}}).words, (Words{0x101, 0x202}));
}

TEST(Png, PalettesOfEveryDepth) {
  const Bytes colors = chunk("PLTE", {10, 20, 30, 40, 50, 60, 70, 80, 90, 1, 2, 3});
  EXPECT_EQ(read({2, 1, 1, palette, {0, 0x40}, colors}).bytes, (Bytes{10, 20, 30, 40, 50, 60}));
  EXPECT_EQ(read({2, 1, 2, palette, {0, 0xb0}, colors}).bytes, (Bytes{70, 80, 90, 1, 2, 3}));
  EXPECT_EQ(read({2, 1, 4, palette, {0, 0x12}, colors}).bytes, (Bytes{40, 50, 60, 70, 80, 90}));
  EXPECT_EQ(read({1, 1, 8, palette, {0, 3}, colors}).bytes, (Bytes{1, 2, 3}));
  const DecodedImage clear = read({2, 1, 8, palette, {0, 0, 1}, colors + chunk("tRNS", {77})});
  EXPECT_EQ(clear.bytes, (Bytes{10, 20, 30, 77, 40, 50, 60, 255}));
  EXPECT_EQ(clear.shape.channels, 4u);
}

TEST(Png, OneTransparentColourBecomesAlpha) {
  EXPECT_EQ(read({2, 1, 8, grey, {0, 5, 6}, chunk("tRNS", {0, 6})}).bytes, (Bytes{5, 255, 6, 0}));
  EXPECT_EQ(read({2, 1, 8, rgb, {0, 1, 2, 3, 4, 5, 6}, chunk("tRNS", {0, 1, 0, 2, 0, 3})}).bytes,
            (Bytes{1, 2, 3, 0, 4, 5, 6, 255}));
  EXPECT_EQ(read({1, 1, 16, grey, {0, 1, 2}, chunk("tRNS", {1, 2})}).words, (Words{0x102, 0}));
}

// Pixel (x, y) holds 16 y + x; the seven passes of Adam7 as the specification (8.2) has them.
TEST(Png, Interlaced) {
  constexpr std::uint32_t kStart[7][2] = {{0, 0}, {4, 0}, {0, 4}, {2, 0}, {0, 2}, {1, 0}, {0, 1}};
  constexpr std::uint32_t kStep[7][2] = {{8, 8}, {8, 8}, {4, 8}, {4, 4}, {2, 4}, {2, 2}, {1, 2}};
  Png png{9, 10, 8, grey, {}, {}, true};
  for (int pass = 0; pass < 7; ++pass)
    for (std::uint32_t y = kStart[pass][1]; y < png.height; y += kStep[pass][1]) {
      png.scanlines.push_back(0);
      for (std::uint32_t x = kStart[pass][0]; x < png.width; x += kStep[pass][0])
        png.scanlines.push_back(static_cast<std::uint8_t>(16 * y + x));
    }
  const Bytes bytes = read(png).bytes;
  ASSERT_EQ(bytes.size(), 90u);
  for (std::uint32_t i = 0; i < 90; ++i) EXPECT_EQ(bytes[i], 16 * (i / 9) + i % 9) << i;
}

TEST(Png, FiltersAreUndone) {
  // Sub, up, average and Paeth below a plain row.
  const Bytes bytes = read({3, 5, 8, grey, {0, 10, 20, 30, 1, 5, 5, 5, 2, 1, 1, 1, 3, 0, 0, 0, 4, 1, 0, 0}}).bytes;
  EXPECT_EQ(bytes, (Bytes{10, 20, 30, 5, 10, 15, 6, 11, 16, 3, 7, 11, 4, 7, 11}));
}

TEST(Png, GammaProfilesAndSignificantBitsArePassedOver) {
  const Bytes gamma = chunk("gAMA", big_endian(100000)), bits = chunk("sBIT", {4, 4, 4}),
              profile = chunk("iCCP", text("no profile")), words = chunk("tEXt", text("malformed")),
              later = chunk("vpAg", {1, 2, 3});
  EXPECT_EQ(read({1, 1, 8, rgb, {0, 200, 100, 50}, gamma + bits + profile + words + later}).bytes,
            (Bytes{200, 100, 50}));
}

TEST(Png, DamageIsTold) {
  const Bytes sound = file_of({2, 1, 8, grey, {0, 1, 2}});
  Bytes flipped = sound;
  flipped[sound.size() - 12 - 6] ^= 1; // the checksum inside of IDAT or the chunk's own
  EXPECT_NE(refusal(flipped).find("damaged or cut short (IDAT"), std::string::npos) << refusal(flipped);
  EXPECT_EQ(refusal({sound.begin(), sound.end() - 12}), "is damaged or cut short (the file ends early)");
  EXPECT_NE(refusal(file_of({2, 2, 8, grey, {0, 1, 2}})).find("damaged"), std::string::npos); // too few rows
  EXPECT_NE(refusal(file_of({1, 1, 8, palette, {0, 0}})).find("damaged"), std::string::npos); // no colours
  EXPECT_NE(refusal(file_of({0, 1, 8, grey, {}})).find("damaged"), std::string::npos);
}

// --- what the writers write ---

DecodedImage noise(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
  DecodedImage image;
  image.shape = {width, height, channels};
  std::mt19937 random(width + 7 * channels);
  for (std::uint64_t i = 0; i < image.shape.pixels() * channels; ++i)
    image.bytes.push_back(static_cast<std::uint8_t>(random()));
  return image;
}

TEST(Png, WhatIsWrittenComesBack) {
  for (std::uint32_t channels = 1; channels <= 4; ++channels) {
    DecodedImage image = noise(31, 17, channels);
    EXPECT_EQ(decode_any(encode_png(image)).bytes, image.bytes);
    image.words.assign(image.bytes.begin(), image.bytes.end());
    for (std::uint16_t& word : image.words) word = static_cast<std::uint16_t>(word * 256 + 3);
    image.bytes.clear();
    const DecodedImage back = decode_any(encode_png(image));
    EXPECT_EQ(back.words, image.words);
    EXPECT_EQ(shape_of(back), shape_of(image));
  }
}

TEST(Png, IsMarkedAsSrgb) {
  const Bytes file = encode_png(noise(1, 1, 3));
  const Bytes mark = chunk("sRGB", {0});
  EXPECT_NE(std::search(file.begin(), file.end(), mark.begin(), mark.end()), file.end());
}

// --- JPEG ---

struct JpegFile {
  J_COLOR_SPACE given = JCS_RGB, stored = JCS_YCbCr;
  bool progressive = false, scan_each = false;
};

// 16 x 16 pixels of one colour, written by libjpeg.
Bytes jpeg_of(const Bytes& color, const JpegFile& kind) {
  jpeg_error_mgr errors;
  jpeg_compress_struct codec{};
  codec.err = jpeg_std_error(&errors);
  jpeg_create_compress(&codec);
  unsigned char* data = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&codec, &data, &size);
  codec.image_width = codec.image_height = 16;
  codec.input_components = static_cast<int>(color.size());
  codec.in_color_space = kind.given;
  jpeg_set_defaults(&codec);
  jpeg_set_colorspace(&codec, kind.stored);
  jpeg_set_quality(&codec, 100, TRUE);
  if (kind.progressive) jpeg_simple_progression(&codec);
  std::vector<jpeg_scan_info> scans;
  for (int c = 0; kind.scan_each && c < codec.num_components; ++c) scans.push_back({1, {c, 0, 0, 0}, 0, 63, 0, 0});
  if (kind.scan_each) codec.scan_info = scans.data(), codec.num_scans = static_cast<int>(scans.size());
  jpeg_start_compress(&codec, TRUE);
  Bytes row;
  for (int x = 0; x < 16; ++x) row = row + color;
  for (JSAMPROW rows = row.data(); codec.next_scanline < 16;) jpeg_write_scanlines(&codec, &rows, 1);
  jpeg_finish_compress(&codec);
  jpeg_destroy_compress(&codec);
  const Bytes file(data, data + size);
  std::free(data);
  return file;
}

void expect_color(const DecodedImage& image, const Bytes& color) {
  ASSERT_EQ(shape_of(image), (std::array<std::uint32_t, 3>{16, 16, static_cast<std::uint32_t>(color.size())}));
  ASSERT_EQ(image.bytes.size(), 256 * color.size());
  for (std::size_t i = 0; i < image.bytes.size(); ++i) ASSERT_NEAR(image.bytes[i], color[i % color.size()], 2) << i;
}

TEST(Jpeg, EveryKindOfColour) {
  expect_color(decode_any(jpeg_of({200, 100, 50}, {})), {200, 100, 50});
  expect_color(decode_any(jpeg_of({200, 100, 50}, {.stored = JCS_RGB})), {200, 100, 50});
  expect_color(decode_any(jpeg_of({120}, {.given = JCS_GRAYSCALE, .stored = JCS_GRAYSCALE})), {120});
  // Inks are stored inverted: 255 is none. Each colour is its ink times black.
  const Bytes inks{255, 128, 0, 204}, expected{204, 102, 0};
  expect_color(decode_any(jpeg_of(inks, {.given = JCS_CMYK, .stored = JCS_CMYK})), expected);
  expect_color(decode_any(jpeg_of(inks, {.given = JCS_CMYK, .stored = JCS_YCCK})), expected);
}

TEST(Jpeg, Progressive) {
  expect_color(decode_any(jpeg_of({200, 100, 50}, {.progressive = true})), {200, 100, 50});
  expect_color(decode_any(jpeg_of({200, 100, 50}, {.scan_each = true})), {200, 100, 50});
}

TEST(Jpeg, EndlessScansAreRefused) {
  Bytes file = jpeg_of({200, 100, 50}, {.scan_each = true});
  const Bytes start{0xff, 0xda};
  const auto last = std::find_end(file.begin(), file.end(), start.begin(), start.end());
  const Bytes scan(last, file.end() - 2);
  Bytes few(file.begin(), file.end() - 2), many = few;
  for (int i = 0; i < 100; ++i) few = few + scan;
  for (int i = 0; i < 600; ++i) many = many + scan;
  EXPECT_EQ(refusal(few + Bytes{0xff, 0xd9}), "was accepted");
  EXPECT_EQ(refusal(many + Bytes{0xff, 0xd9}), "is damaged or cut short (it has more than 500 scans)");
}

TEST(Jpeg, OnlyMissingPixelsAreDamage) {
  const Bytes whole = encode_jpeg(noise(64, 64, 3));
  const Bytes sound = decode_any(whole).bytes;
  EXPECT_EQ(decode_any({whole.begin(), whole.end() - 2}).bytes, sound);                                // no end mark
  EXPECT_EQ(decode_any(Bytes(whole.begin(), whole.end() - 2) + Bytes{1, 2, 0xff, 0xd9}).bytes, sound); // bytes too many
  EXPECT_EQ(decode_any(whole + text("something else")).bytes, sound);
  const Bytes half(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(whole.size() / 2));
  EXPECT_NE(refusal(half).find("is damaged or cut short (Corrupt JPEG data"), std::string::npos) << refusal(half);
  const Bytes mark{0xff, 0xd9};
  EXPECT_NE(refusal(half + mark).find("is damaged or cut short"), std::string::npos) << refusal(half + mark);
}

TEST(Jpeg, WhatIsWrittenComesBackAtFullResolution) {
  DecodedImage image;
  image.shape = {64, 64, 3};
  for (int i = 0; i < 64 * 64; ++i) // red and blue columns in turns: half the resolution would mix them
    for (const int value : {i % 2 ? 255 : 0, 0, i % 2 ? 0 : 255})
      image.bytes.push_back(static_cast<std::uint8_t>(value));
  const DecodedImage back = decode_any(encode_jpeg(image));
  ASSERT_EQ(back.bytes.size(), image.bytes.size());
  double error = 0.0;
  for (std::size_t i = 0; i < image.bytes.size(); ++i) error += std::abs(back.bytes[i] - image.bytes[i]);
  EXPECT_LT(error / static_cast<double>(image.bytes.size()), 6.0);
  image.shape = {70000, 1, 3};
  image.bytes.resize(70000 * 3);
  EXPECT_THROW(encode_jpeg(image), ImageError);
}

// --- WebP ---

Bytes webp_of(const DecodedImage& image, bool lossy) {
  const int width = static_cast<int>(image.shape.width), height = static_cast<int>(image.shape.height);
  const bool alpha = image.shape.channels == 4;
  const int stride = width * (alpha ? 4 : 3);
  const std::uint8_t* in = image.bytes.data();
  std::uint8_t* data = nullptr;
  const std::size_t size =
      lossy ? (alpha ? WebPEncodeRGBA : WebPEncodeRGB)(in, width, height, stride, 95.0f, &data)
            : (alpha ? WebPEncodeLosslessRGBA : WebPEncodeLosslessRGB)(in, width, height, stride, &data);
  const Bytes file(data, data + size);
  WebPFree(data);
  return file;
}

TEST(Webp, LosslessComesBack) {
  const DecodedImage three = noise(13, 9, 3);
  DecodedImage four = noise(13, 9, 4);
  for (std::size_t i = 3; i < four.bytes.size(); i += 4) four.bytes[i] |= 1; // the encoder drops colours under alpha 0
  for (const DecodedImage& image : {three, four}) {
    const DecodedImage back = decode_any(webp_of(image, false));
    EXPECT_EQ(back.bytes, image.bytes);
    EXPECT_EQ(shape_of(back), shape_of(image));
  }
}

TEST(Webp, LossyWithAndWithoutAlpha) {
  for (const Bytes& color : {Bytes{200, 100, 50}, Bytes{200, 100, 50, 128}}) {
    DecodedImage image;
    image.shape = {16, 16, static_cast<std::uint32_t>(color.size())};
    for (int i = 0; i < 256; ++i) image.bytes = image.bytes + color;
    const DecodedImage back = decode_any(webp_of(image, true));
    ASSERT_EQ(shape_of(back), shape_of(image));
    for (std::size_t i = 0; i < back.bytes.size(); ++i) ASSERT_NEAR(back.bytes[i], color[i % color.size()], 5) << i;
  }
}

TEST(Webp, AnimationsAreRefused) {
  // A VP8X header that says "animation" (bit 1 of the flags), of 1 x 1 pixels.
  const Bytes file =
      text("RIFF") + Bytes{22, 0, 0, 0} + text("WEBPVP8X") + Bytes{10, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(refusal(file), "is an animation");
}

// --- files that are not what they say ---

// One small file of every format.
std::vector<Bytes> samples() {
  return {encode_png(noise(9, 7, 4)),
          file_of({2, 2, 8, palette, {0, 0, 1, 0, 1, 0}, chunk("PLTE", {1, 2, 3, 4, 5, 6}) + chunk("tRNS", {9})}),
          encode_jpeg(noise(20, 12, 3)),
          jpeg_of({200, 100, 50}, {.progressive = true}),
          jpeg_of({255, 128, 0, 204}, {.given = JCS_CMYK, .stored = JCS_YCCK}),
          webp_of(noise(11, 6, 4), false),
          webp_of(noise(16, 16, 4), true)};
}

TEST(Images, CutShortAtEveryLengthIsRefusedInSilence) {
  testing::internal::CaptureStderr();
  for (const Bytes& whole : samples()) {
    const DecodedImage sound = decode_any(whole);
    for (std::size_t length = 0; length < whole.size(); ++length) {
      const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
      const std::optional<FileFormat> format = file_format(cut);
      if (!format) continue;
      try { // the last bytes of a JPEG or WebP file, such as its end mark, hold no pixels
        EXPECT_EQ(decode(*format, cut, accept).bytes, sound.bytes) << length << " of " << whole.size();
        EXPECT_GT(length + 8, whole.size());
      } catch (const ImageError&) {
      }
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Images, DamagedBytesDoNoHarm) {
  testing::internal::CaptureStderr();
  std::mt19937 random(1);
  int refused = 0, decoded = 0;
  for (const Bytes& whole : samples())
    for (int i = 0; i < 1000; ++i) {
      Bytes damaged = whole;
      for (std::uint32_t flips = 1 + random() % 4; flips > 0; --flips)
        damaged[random() % damaged.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
      const std::optional<FileFormat> format = file_format(damaged);
      if (!format) continue;
      try {
        const DecodedImage image = decode(*format, damaged, [](const ImageShape& shape) {
          if (shape.pixels() > 1u << 20) throw ImageError("is too large");
        });
        const std::size_t count = image.bytes.size() + image.words.size();
        EXPECT_EQ(count, image.shape.pixels() * image.shape.channels);
        ++decoded;
      } catch (const ImageError&) {
        ++refused;
      }
    }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(decoded, 100);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// Checksums are no defence: whoever damages a file on purpose makes them anew.
TEST(Images, DamagedPngsWithSoundChecksumsDoNoHarm) {
  testing::internal::CaptureStderr();
  std::mt19937 random(2);
  const auto any = [&](std::initializer_list<int> values) {
    return static_cast<std::uint8_t>(values.begin()[random() % values.size()]);
  };
  int decoded = 0;
  for (int i = 0; i < 5000; ++i) {
    Bytes header = big_endian(random() % 12) + big_endian(random() % 12) +
                   Bytes{any({1, 2, 4, 8, 16, 3}), any({0, 2, 3, 4, 6, 1}), 0, 0, any({0, 1})};
    Bytes colors(random() % 12), clear(random() % 8), pixels(random() % 300);
    for (Bytes* bytes : {&colors, &clear, &pixels})
      for (std::uint8_t& byte : *bytes) byte = static_cast<std::uint8_t>(random() % 4);
    Bytes data = zlib(pixels);
    if (random() % 4 == 0) data[random() % data.size()] ^= 1;
    const Bytes file = text("\x89PNG\r\n\x1a\n") + chunk("IHDR", header) + chunk("PLTE", colors) +
                       (i % 2 ? chunk("tRNS", clear) : Bytes()) + chunk("IDAT", data) + chunk("IEND", {});
    try {
      const DecodedImage image = decode_png(file, accept);
      EXPECT_EQ(image.bytes.size() + image.words.size(), image.shape.pixels() * image.shape.channels);
      ++decoded;
    } catch (const ImageError&) {
    }
  }
  EXPECT_GT(decoded, 100);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// Headers that claim the most that their format can say, with next to no data: believed, they would take gigabytes.
TEST(Images, SizesAreTriedBeforeMemoryIsTaken) {
  Bytes jpeg = encode_jpeg(noise(8, 8, 3));
  const Bytes frame{0xff, 0xc0};
  const auto size = std::search(jpeg.begin(), jpeg.end(), frame.begin(), frame.end()) + 5;
  std::fill_n(size, 4, std::uint8_t{0xfd});
  Bytes webp = webp_of(noise(8, 8, 3), false); // "VP8L", its size, 0x2f; 14 bits each of width - 1 and height - 1
  std::fill_n(webp.begin() + 21, 3, std::uint8_t{0xff});
  for (const Bytes& file : {file_of({60000, 60000, 16, rgba, {}}), jpeg, webp}) {
    std::uint64_t pixels = 0;
    const auto refuse = [&](const ImageShape& shape) {
      pixels = shape.pixels();
      throw ImageError("is too large");
    };
    EXPECT_EQ(refusal(file, refuse), "is too large");
    EXPECT_GE(pixels, 1u << 24);
  }
}

TEST(Images, FormatsAreKnownByTheirFirstBytes) {
  EXPECT_EQ(file_format(encode_png(noise(1, 1, 1))), FileFormat::png);
  EXPECT_EQ(file_format(encode_jpeg(noise(1, 1, 1))), FileFormat::jpeg);
  EXPECT_EQ(file_format(webp_of(noise(1, 1, 3), true)), FileFormat::webp);
  for (const char* other : {"", "#?RGBE\n", "RIFF1234WAVE", "GIF89a", "II*"})
    EXPECT_FALSE(file_format(text(other))) << other;
}

} // namespace
} // namespace wavepath::test
