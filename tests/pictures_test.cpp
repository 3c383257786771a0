// Pictures that OpenImageIO reads: what their channels, parts, windows, colours and encodings mean, every format by
// known bytes, cut short, damaged, and too large to be believed.
#include "host/codecs/linear_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/codecs/picture_module.h"
#include "host/codecs/primaries.h"
#include "tests/temporary_folder.h"

namespace wavepath::test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Color = std::array<double, 3>;

Bytes text(const std::string& words) { return {words.begin(), words.end()}; }

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Bytes from_hex(const std::string& digits) {
  Bytes bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(digits.substr(i, 2), nullptr, 16)));
  return bytes;
}

template <class Value>
Bytes little(Value value) {
  Bytes bytes(sizeof value);
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

class PicturesTest : public ::testing::Test {
protected:
  std::string write(const std::string& name, const Bytes& bytes) const {
    const std::string path = folder_.file(name);
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return path;
  }
  TemporaryFolder folder_;
};

std::string refusal(const std::string& path, const ReadRequest& request = {}) {
  try {
    read_linear(path, request);
  } catch (const Error& error) {
    return error.what();
  }
  return "was accepted";
}

bool has(const std::string& words, const std::string& part) { return words.find(part) != std::string::npos; }

Color color_at(const LinearPicture& picture, std::size_t i = 0) {
  return {picture.planes.at(0).at(i), picture.planes.at(1).at(i), picture.planes.at(2).at(i)};
}

void expect_color(const LinearPicture& picture, const Color& expected, double tolerance = 1e-6, std::size_t i = 0) {
  const Color color = color_at(picture, i);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(color[c], expected[c], tolerance) << "channel " << c;
}

// --- OpenEXR ---

constexpr Color kColor{0.25, 0.5, 0.75};

struct ExrChannel {
  const char* name;
  float value;
};

void fill(Imf::FrameBuffer& pixels, std::vector<std::vector<float>>& planes, const Imf::Header& header,
          std::initializer_list<ExrChannel> channels) {
  const Imath::Box2i window = header.dataWindow();
  const auto width = static_cast<std::size_t>(window.max.x - window.min.x + 1),
             height = static_cast<std::size_t>(window.max.y - window.min.y + 1);
  planes.reserve(channels.size());
  for (const auto& [name, value] : channels) {
    const bool whole = header.channels()[name].type == Imf::UINT;
    const auto number = static_cast<std::uint32_t>(value);
    float stored = value;
    if (whole) std::memcpy(&stored, &number, sizeof stored);
    planes.emplace_back(width * height, stored);
    pixels.insert(name, Imf::Slice::Make(whole ? Imf::UINT : Imf::FLOAT, planes.back().data(), window));
  }
}

// Every pixel alike.
std::string write_exr(const std::string& path, std::initializer_list<ExrChannel> channels,
                      Imf::Header header = Imf::Header(16, 8), Imf::PixelType type = Imf::FLOAT) {
  for (const ExrChannel& channel : channels) header.channels().insert(channel.name, Imf::Channel(type));
  Imf::FrameBuffer pixels;
  std::vector<std::vector<float>> planes;
  fill(pixels, planes, header, channels);
  Imf::OutputFile output(path.c_str(), header);
  output.setFrameBuffer(pixels);
  output.writePixels(header.dataWindow().max.y - header.dataWindow().min.y + 1);
  return path;
}

using Parts = std::initializer_list<std::pair<const char*, std::initializer_list<ExrChannel>>>;

std::string write_parts(const std::string& path, Parts parts) {
  std::vector<Imf::Header> headers;
  for (const auto& [name, channels] : parts) {
    Imf::Header& header = headers.emplace_back(16, 8);
    header.setName(name);
    header.setType(Imf::SCANLINEIMAGE);
    for (const ExrChannel& channel : channels) header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
  }
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), static_cast<int>(headers.size()));
  int index = 0;
  for (const auto& [name, channels] : parts) {
    Imf::OutputPart part(file, index++);
    Imf::FrameBuffer pixels;
    std::vector<std::vector<float>> planes;
    fill(pixels, planes, part.header(), channels);
    part.setFrameBuffer(pixels);
    part.writePixels(8);
  }
  return path;
}

TEST_F(PicturesTest, ColoursAreFoundWhateverTheyAreCalled) {
  const std::initializer_list<std::initializer_list<ExrChannel>> files = {
      {{"R", .25f}, {"G", .5f}, {"B", .75f}},
      {{"r", .25f}, {"g", .5f}, {"b", .75f}},
      {{"Red", .25f}, {"Green", .5f}, {"Blue", .75f}},
      {{"diffuse.R", .25f}, {"diffuse.G", .5f}, {"diffuse.B", .75f}, {"Z", 9.0f}},
      {{"a.R", 7.0f}, {"a.G", 7.0f}, {"a.B", 7.0f}, {"R", .25f}, {"G", .5f}, {"B", .75f}, {"A", .5f}},
      {{"View.AO.R", 7.0f},
       {"View.AO.G", 7.0f},
       {"View.AO.B", 7.0f},
       {"View.Combined.R", .25f},
       {"View.Combined.G", .5f},
       {"View.Combined.B", .75f},
       {"View.Depth.Z", 9.0f}},
  };
  for (const auto& channels : files) expect_color(read_linear(write_exr(folder_.file("a.exr"), channels), {}), kColor);
  for (const auto& [name, value] : std::map<std::string, float>{{"Y", .5f}, {"L", .25f}, {"beauty.Y", .75f}}) {
    const std::string path = write_exr(folder_.file("grey.exr"), {{name.c_str(), value}, {"A", 1.0f}, {"Z", 3.0f}});
    expect_color(read_linear(path, {}), {value, value, value});
  }
}

TEST_F(PicturesTest, DepthAndAlphaAreNoColours) {
  for (const char* name : {"Z", "A", "depth.Z", "R", "objectId"}) {
    const std::string words = refusal(write_exr(folder_.file("a.exr"), {{name, .5f}}));
    EXPECT_TRUE(has(words, std::string("has no R, G and B channels (it has ") + name + ")")) << words;
  }
}

TEST_F(PicturesTest, ThePartThatHasColoursIsTaken) {
  const std::string path = folder_.file("parts.exr");
  write_parts(path, {{"depth", {{"Z", 7.0f}}}, {"beauty", {{"R", .25f}, {"G", .5f}, {"B", .75f}}}});
  expect_color(read_linear(path, {}), kColor);
  write_parts(path, {{"mask", {{"Y", 7.0f}}}, {"matte", {{"A", 1.0f}}}, {"x", {{"B", .75f}, {"G", .5f}, {"R", .25f}}}});
  expect_color(read_linear(path, {}), kColor);
  write_parts(path,
              {{"first", {{"R", .25f}, {"G", .5f}, {"B", .75f}}}, {"second", {{"R", 9.f}, {"G", 9.f}, {"B", 9.f}}}});
  expect_color(read_linear(path, {}), kColor);
  write_parts(path, {{"a", {{"Z", 7.0f}}}, {"b", {{"N.X", 7.0f}}}});
  EXPECT_TRUE(has(refusal(path), "(it has Z, N.X)")) << refusal(path);
}

TEST_F(PicturesTest, FurtherChannelsAreReadIfWanted) {
  const std::string path =
      write_exr(folder_.file("a.exr"),
                {{"R", .25f}, {"G", .5f}, {"B", .75f}, {"A", 1.0f}, {"N.X", 2.0f}, {"film.00", 5.0f}, {"Z", 3.0f}});
  ReadRequest request;
  request.wanted = [](const std::string& name) { return !name.starts_with("film."); };
  const LinearPicture picture = read_linear(path, request);
  ASSERT_EQ(picture.channels.size(), 6u);
  std::map<std::string, float> values;
  for (std::size_t i = 0; i < 6; ++i) values[picture.channels[i]] = picture.planes[i].at(77);
  EXPECT_EQ(values,
            (std::map<std::string, float>{{"R", .25f}, {"G", .5f}, {"B", .75f}, {"A", 1}, {"N.X", 2}, {"Z", 3}}));
  EXPECT_EQ(read_linear(path, {}).channels.size(), 3u);
}

TEST_F(PicturesTest, WholeNumbersOfExrKeepTheirValues) {
  const auto path =
      write_exr(folder_.file("a.exr"), {{"R", 2.0f}, {"G", 300.0f}, {"B", 70000.0f}}, Imf::Header(16, 8), Imf::UINT);
  expect_color(read_linear(path, {}), {2.0, 300.0, 70000.0});
  EXPECT_FALSE(read_linear(path, {}).display);
}

// AP1 with the white of ACES; the values are those of the conversion after Bradford, by other programs.
TEST_F(PicturesTest, ChromaticitiesBecomeRec709) {
  const std::initializer_list<ExrChannel> color = {{"R", .5f}, {"G", .4f}, {"B", .3f}};
  const auto read = [&](const Imf::Chromaticities& chromaticities, const ReadRequest& request) {
    Imf::Header header(16, 8);
    Imf::addChromaticities(header, chromaticities);
    return read_linear(write_exr(folder_.file("a.exr"), color, header), request);
  };
  const Imf::Chromaticities ap1({.713f, .293f}, {.165f, .83f}, {.128f, .044f}, {.32168f, .33767f});
  expect_color(read(ap1, {}), {.5788, .3880, .2823}, 2e-4);
  EXPECT_EQ(color_at(read({}, {})), (Color{.5f, .4f, .3f})); // Rec. 709: not a bit is changed
  // A green beyond Rec. 709 has less than no red: kept in a reference, clipped where it is to be light.
  const Imf::Chromaticities wide({.708f, .292f}, {.170f, .797f}, {.131f, .046f}, {.3127f, .3290f}); // BT.2020
  Imf::Header header(16, 8);
  Imf::addChromaticities(header, wide);
  const std::string green = write_exr(folder_.file("g.exr"), {{"R", 0.0f}, {"G", 1.0f}, {"B", 0.0f}}, header);
  expect_color(read_linear(green, {}), {-.5876, 1.1329, -.1006}, 2e-4);
  ReadRequest light;
  light.light = true;
  expect_color(read_linear(green, light), {0.0, 1.1329, 0.0}, 2e-4);
  const std::string grey = write_exr(folder_.file("y.exr"), {{"Y", .5f}}, header);
  EXPECT_EQ(color_at(read_linear(grey, {})), (Color{.5, .5, .5}));
  Imf::Header flat(16, 8);
  Imf::addChromaticities(flat, {{.3f, .3f}, {.3f, .3f}, {.3f, .3f}, {.3f, .3f}});
  EXPECT_TRUE(has(refusal(write_exr(folder_.file("f.exr"), color, flat)), "chromaticities that span no colours"));
}

TEST_F(PicturesTest, LuminanceAndChroma) {
  for (const Imf::RgbaChannels channels : {Imf::WRITE_YC, Imf::WRITE_YCA}) {
    const std::string path = folder_.file("yc.exr");
    {
      const std::vector<Imf::Rgba> pixels(128, Imf::Rgba(.25f, .5f, .75f, 1.0f));
      Imf::RgbaOutputFile output(path.c_str(), 16, 8, channels);
      output.setFrameBuffer(pixels.data(), 1, 16);
      output.writePixels(8);
    }
    const LinearPicture picture = read_linear(path, {});
    for (const std::size_t i : {0u, 77u, 127u}) expect_color(picture, kColor, 4e-3, i);
  }
}

TEST_F(PicturesTest, TheDisplayWindowIsShown) {
  const std::initializer_list<ExrChannel> color = {{"R", .25f}, {"G", .5f}, {"B", .75f}};
  const Imath::Box2i display({10, 20}, {25, 27});
  ReadRequest environment;
  environment.environment = true;
  const std::string same = write_exr(folder_.file("a.exr"), color, Imf::Header(display, display)),
                    more = write_exr(folder_.file("b.exr"), color, Imf::Header(display, {{8, 19}, {27, 28}})),
                    less = write_exr(folder_.file("c.exr"), color, Imf::Header(display, {{12, 21}, {19, 26}}));
  for (const std::string& path : {same, more, less}) {
    const LinearPicture picture = read_linear(path, {});
    EXPECT_EQ(picture.width, 16u);
    EXPECT_EQ(picture.height, 8u);
    ASSERT_EQ(picture.planes[0].size(), 128u);
    EXPECT_EQ(color_at(picture, 0), path == less ? Color{} : kColor);
    EXPECT_EQ(color_at(picture, 16 + 2), kColor);
    EXPECT_EQ(color_at(picture, 16 + 1), path == less ? Color{} : kColor);
    EXPECT_EQ(color_at(picture, 6 * 16 + 9), kColor);
    EXPECT_EQ(color_at(picture, 7 * 16 + 9), path == less ? Color{} : kColor);
  }
  EXPECT_EQ(color_at(read_linear(more, environment)), kColor);
  EXPECT_TRUE(has(refusal(less, environment), "data window (8 x 6) that differs")) << refusal(less, environment);
}

TEST_F(PicturesTest, DeepImagesAreRefused) {
  Imf::Header header(16, 8);
  for (const char* name : {"R", "G", "B"}) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = Imf::ZIPS_COMPRESSION;
  const std::string path = folder_.file("deep.exr");
  {
    Imf::DeepScanLineOutputFile output(path.c_str(), header);
    std::vector<unsigned> counts(128, 1);
    std::vector<float> values(128, .5f);
    std::vector<float*> places;
    for (float& value : values) places.push_back(&value);
    Imf::DeepFrameBuffer pixels;
    pixels.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), 4, 64));
    for (const char* name : {"R", "G", "B"})
      pixels.insert(name, Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(places.data()), 8, 128, 4));
    output.setFrameBuffer(pixels);
    output.writePixels(8);
  }
  EXPECT_TRUE(has(refusal(path), "is a deep image")) << refusal(path);
}

// Faces of OpenEXR's cube, each of a colour of its own.
TEST_F(PicturesTest, CubesBecomeLatLongMaps) {
  constexpr Color kFaces[] = {{1, 0, 0}, {.5, 0, 0}, {0, 1, 0}, {0, .5, 0}, {0, 0, 1}, {0, 0, .5}};
  const std::string path = folder_.file("cube.exr");
  Imf::Header header(8, 48);
  Imf::addEnvmap(header, Imf::ENVMAP_CUBE);
  std::vector<float> values;
  for (std::size_t i = 0; i < 8 * 48; ++i)
    for (const double value : kFaces[i / 64]) values.push_back(static_cast<float>(value));
  Imf::FrameBuffer pixels;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string name(1, "RGB"[c]);
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    pixels.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data() + c), 12, 96));
  }
  {
    Imf::OutputFile output(path.c_str(), header);
    output.setFrameBuffer(pixels);
    output.writePixels(48);
  }
  ReadRequest request;
  request.environment = request.light = true;
  const LinearPicture map = read_linear(path, request);
  ASSERT_EQ(map.width, 32u);
  ASSERT_EQ(map.height, 16u);
  // The centre looks along +X, three quarters across along +Z, the top row up.
  const std::size_t middle = 8 * 32;
  EXPECT_EQ(color_at(map, middle + 16), kFaces[0]);
  EXPECT_EQ(color_at(map, middle), kFaces[1]);
  EXPECT_EQ(color_at(map, 3), kFaces[2]);
  EXPECT_EQ(color_at(map, 15 * 32 + 3), kFaces[3]);
  EXPECT_EQ(color_at(map, middle + 24), kFaces[4]);
  EXPECT_EQ(color_at(map, middle + 8), kFaces[5]);
  request.environment = false; // what a lamp is shone through is no cube
  EXPECT_TRUE(has(refusal(path, request), "is a cube map")) << refusal(path, request);
}

// --- Radiance ---

Bytes radiance(const std::string& size, const Bytes& pixels, const std::string& header = "FORMAT=32-bit_rle_rgbe\n") {
  return text("#?RADIANCE\n" + header + "\n" + size + "\n") + pixels;
}

TEST_F(PicturesTest, RadianceFlatAndInRuns) {
  const LinearPicture flat = read_linear(write("a.hdr", radiance("-Y 2 +X 1", {128, 64, 0, 129, 255, 1, 2, 0})), {});
  EXPECT_EQ(flat.height, 2u);
  EXPECT_FALSE(flat.display);
  EXPECT_EQ(color_at(flat, 0), (Color{1, .5, 0}));
  EXPECT_EQ(color_at(flat, 1), (Color{0, 0, 0}));                                       // exponent 0 is black
  const auto header = "# words\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\nVIEW= -vp 0 0 0\n"; // exposure is not divided out
  EXPECT_EQ(color_at(read_linear(write("a.hdr", radiance("-Y 1 +X 1", {1, 2, 3, 136}, header)), {})), (Color{1, 2, 3}));
  const Bytes red{128 + 10, 16}, green{3, 1, 2, 3, 128 + 7, 4}, blue{10, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9},
      exponent{128 + 4, 136, 6, 137, 137, 137, 137, 137, 137};
  const LinearPicture runs =
      read_linear(write("a.hdr", radiance("-Y 1 +X 10", Bytes{2, 2, 0, 10} + red + green + blue + exponent)), {});
  for (std::size_t x = 0; x < 10; ++x) {
    const double scale = x < 4 ? 1.0 : 2.0, step = static_cast<double>(x);
    EXPECT_EQ(color_at(runs, x), (Color{16 * scale, std::min(step + 1, 4.0) * scale, step * scale}));
  }
}

// Mantissas of 1, 1, 1 are a colour, not a run of Radiance's first encoding, which no one else reads.
TEST_F(PicturesTest, RadianceHasDarkPixels) {
  const LinearPicture picture =
      read_linear(write("a.hdr", radiance("-Y 1 +X 3", {128, 64, 0, 129, 1, 1, 1, 130, 128, 64, 0, 129})), {});
  EXPECT_EQ(color_at(picture, 0), (Color{1, .5, 0}));
  EXPECT_EQ(color_at(picture, 1), (Color{1.0 / 64, 1.0 / 64, 1.0 / 64}));
  EXPECT_EQ(color_at(picture, 2), (Color{1, .5, 0}));
}

TEST_F(PicturesTest, RadianceTurnedAndMirrored) {
  const Bytes one{1, 1, 1, 137}, two{2, 2, 2, 137}, three{3, 3, 3, 137}, four{4, 4, 4, 137};
  const auto reds = [&](const std::string& size) {
    const LinearPicture picture = read_linear(write("a.hdr", radiance(size, one + two + three + four)), {});
    return picture.width == 2 ? picture.planes[0] : std::vector<float>();
  };
  EXPECT_EQ(reds("-Y 2 +X 2"), (std::vector<float>{2, 4, 6, 8}));
  EXPECT_EQ(reds("-Y 2 -X 2"), (std::vector<float>{4, 2, 8, 6}));
  EXPECT_EQ(reds("+Y 2 +X 2"), (std::vector<float>{6, 8, 2, 4}));
  EXPECT_EQ(reds("+Y 2 -X 2"), (std::vector<float>{8, 6, 4, 2}));
  EXPECT_EQ(reds("+X 2 -Y 2"), (std::vector<float>{2, 6, 4, 8})); // column by column, each from the top
  EXPECT_EQ(reds("+X 2 +Y 2"), (std::vector<float>{6, 2, 8, 4}));
  const LinearPicture tall = read_linear(write("a.hdr", radiance("+X 1 -Y 2", one + two)), {});
  EXPECT_EQ(tall.width, 1u);
  EXPECT_EQ(tall.planes[0], (std::vector<float>{2, 4}));
}

TEST_F(PicturesTest, RadianceDamagedIsRefused) {
  const Bytes pixel{9, 8, 7, 136};
  const auto expect = [&](const Bytes& bytes) {
    const std::string words = refusal(write("a.hdr", bytes));
    EXPECT_TRUE(has(words, "cannot be opened as an image: ") || has(words, "more pixels than can be read")) << words;
  };
  for (const char* size : {"-Y 0 +X 1", "-Y 1 +X 0", "-Y -1 +X 1", "-Y 1", "1 1", "-Y x +X 1", "-Y 2 +X 1"})
    expect(radiance(size, pixel));
  expect(radiance("-Y 1 +X 1", pixel, "FORMAT=32-bit_rle_xyze\n"));
  expect(text("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n"));
  expect(radiance("-Y 1 +X 9", {2, 2, 0, 10}));
  expect(radiance("-Y 1 +X 9", {2, 2, 0, 9, 128 + 10, 1}));
  expect(radiance("-Y 1 +X 9", {2, 2, 0, 9, 0}));
}

TEST_F(PicturesTest, RadianceWrittenComesBack) {
  for (const std::uint32_t width : {1u, 7u, 8u, 300u, 40000u}) {
    std::vector<float> rgb;
    std::mt19937 random(width);
    while (rgb.size() < width * 9) { // runs of 1 to 300 equal pixels, exact in 8 bits
      const float scale = std::ldexp(1.0f, static_cast<int>(random() % 200) - 100);
      const float color[] = {static_cast<float>(128 + random() % 128), static_cast<float>(random() % 256), 0.0f};
      for (std::size_t run = 1 + random() % (random() % 300 + 1); run > 0; --run)
        for (const float value : color) rgb.push_back(value * scale);
    }
    rgb.resize(width * 9);
    const LinearPicture back = read_linear(write("a.hdr", picture_module("").encode_radiance(width, 3, rgb)), {});
    ASSERT_EQ(back.width, width);
    for (std::size_t i = 0; i < rgb.size(); ++i)
      ASSERT_FLOAT_EQ(back.planes[i % 3][i / 3], rgb[i]) << width << " " << i;
  }
}

TEST_F(PicturesTest, RadianceRoundsToNearest) {
  const std::vector<float> rgb = {255.6f, 1.4f, 0.6f, 255.4f, 1.6f, 0.4f, 1e-45f, 0.0f, 0.0f, 1.6e38f, 1e30f, 0.0f};
  const LinearPicture back = read_linear(write("a.hdr", picture_module("").encode_radiance(4, 1, rgb)), {});
  EXPECT_EQ(color_at(back, 0), (Color{256, 2, 0}));
  EXPECT_EQ(color_at(back, 1), (Color{255, 2, 0}));
  EXPECT_EQ(color_at(back, 2), (Color{0, 0, 0}));
  EXPECT_NEAR(back.planes[0][3] / 1.6e38f, 1.0f, 1.0f / 256.0f);
}

// --- other formats: bytes by hand, or by an encoder where there is no other way ---

double from_byte(double value) { return std::pow((value / 255.0 + 0.055) / 1.055, 2.4); }
const Color kBytes{from_byte(204), from_byte(102), from_byte(51)};

Bytes targa(const Bytes& pixel) {
  return Bytes{0,
               0,
               2,
               0,
               0,
               0,
               0,
               0,
               0,
               0,
               0,
               0,
               2,
               0,
               1,
               0,
               static_cast<std::uint8_t>(8 * pixel.size()),
               static_cast<std::uint8_t>(0x20 | (pixel.size() == 4 ? 8 : 0))} +
         pixel + pixel;
}

Bytes bitmap() {
  return text("BM") + little(62u) + little(0u) + little(54u) + little(40u) + little(2) + little(1) +
         little(std::uint16_t{1}) + little(std::uint16_t{24}) + little(0u) + little(8u) + little(0) + little(0) +
         little(0u) + little(0u) + Bytes{51, 102, 204, 51, 102, 204, 0, 0};
}

// One strip of two pixels; `orientation` as in EXIF.
Bytes tiff(std::uint16_t bits, const Bytes& pixels, std::uint16_t orientation = 1) {
  const auto entry = [](std::uint16_t tag, std::uint16_t type, std::uint32_t value) {
    return little(tag) + little(type) + little(1u) + little(value);
  };
  const std::uint32_t at = 8 + 2 + 11 * 12 + 4;
  Bytes file = text("II*") + Bytes{0} + little(8u) + little(std::uint16_t{11}) + entry(256, 3, 2) + entry(257, 3, 1) +
               little(std::uint16_t{258}) + little(std::uint16_t{3}) + little(3u) + little(at) + entry(259, 3, 1) +
               entry(262, 3, 2) + entry(273, 4, at + 6) + entry(274, 3, orientation) + entry(277, 3, 3) +
               entry(278, 3, 1) + entry(279, 4, static_cast<std::uint32_t>(pixels.size())) +
               entry(339, 3, bits == 32 ? 3 : 1) + little(0u);
  for (int c = 0; c < 3; ++c) file = file + little(bits);
  return file + pixels;
}

Bytes dds(std::uint32_t caps = 0) {
  std::array<std::uint32_t, 32> words{};
  words[0] = 0x20534444;
  words[1] = 124, words[2] = 0x1007, words[3] = 1, words[4] = 2, words[19] = 32, words[20] = 0x41, words[22] = 32;
  words[23] = 0xff0000, words[24] = 0xff00, words[25] = 0xff, words[26] = 0xff000000,
  words[27] = caps != 0 ? 0x1008 : 0x1000;
  words[28] = caps;
  const Bytes pixel{51, 102, 204, 255};
  Bytes file = little(words) + pixel + pixel;
  for (int i = 1; caps != 0 && i < 6; ++i) file = file + pixel + pixel;
  return file;
}

// Channels one after another, not packed.
Bytes photoshop(std::uint8_t channels = 3) {
  return text("8BPS") + Bytes{0, 1, 0, 0, 0, 0, 0, 0, 0, channels, 0, 0, 0, 1, 0, 0, 0, 2, 0, 8, 0, 3} + Bytes(12, 0) +
         Bytes{0, 0, 204, 204, 102, 102, 51, 51};
}

Bytes floatmap() { // from the bottom row up
  return text("PF\n2 2\n-1.0\n") + little(std::array<float, 12>{1, 2, 3, 4, 5, 6, .25f, .5f, .75f, 7, 8, 9});
}

// 64 x 64, 16 x 16 and 16 x 16 pixels of (204, 102, 51).
constexpr const char* kJpeg2000 =
    "0000000c6a5020200d0a870a00000014667479706a703220000000006a7032200000002d6a703268000000166968647200000040"
    "000000400003070700000000000f636f6c7201000000000010000000ba6a703263ff4fff51002f00000000004000000040000000"
    "0000000000000000400000004000000000000000000003070101070101070101ff52000c00000001000504040001ff5c00134040"
    "484850484850484850484850484850ff640025000143726561746564206279204f70656e4a5045472076657273696f6e20322e35"
    "2e30ff90000a0000000000330001ff93cfb41401d78a9e1fc3e7060884dccfb414088f9e9dbf8080808080808080808080808080"
    "80ffd9";
constexpr const char* kAvif =
    "0000001c667479706176696600000000617669666d6966316d6961660000012b6d657461000000000000002168646c7200000000"
    "0000000070696374000000000000000000000000000000000e7069746d00000000000100000034696c6f63000000004440000200"
    "0100000000014f0001000000000000001e000200000000016d000100000000000000180000003869696e66000000000002000000"
    "15696e66650200000000010000617630310000000015696e6665020000010002000045786966000000006a697072700000004b69"
    "70636f00000013636f6c726e636c78000200020006800000000c6176314381000c00000000146973706500000000000000100000"
    "0010000000107069786900000000030808080000001769706d610000000000000001000104818203840000001a69726566000000"
    "000000000e636473630002000100010000003e6d64617412000a09180cffd8204040d080320f118000004039a542a2fa81a093ea"
    "40000000104578696600004d4d2a0000000008000000000000";
constexpr const char* kHeic =
    "0000001c6674797068656963000000006d696631686569636d696166000001e46d657461000000000000002168646c7200000000"
    "0000000070696374000000000000000000000000000000000e7069746d0000000000020000001069646174000000000010001000"
    "00004c696c6f63010000004440000300010000000000000208000100000000000000310002000100000000000000010000000000"
    "00000800030000000000000239000100000000000000180000004d69696e6600000000000300000015696e666502000001000100"
    "00687663310000000015696e66650200000000020000677269640000000015696e666502000001000300004578696600000000d8"
    "69707270000000b66970636f00000076687663430103700000000000000000001ef000fcfdf8f800000f03200001001840010c01"
    "ffff03700000030090000003000003001eba0240210001002a42010103700000030090000003000003001ea020810596eaae9ae6"
    "e04040c0800000030080000003008422000100064401c173c1890000001469737065000000000000004000000040000000146973"
    "7065000000000000001000000010000000107069786900000000030808080000001a69706d610000000000000002000102810200"
    "020203840000002869726566000000000000000e64696d670002000100010000000e63647363000300010002000000516d646174"
    "0000002d2801af1321606340f52722ffcaa7ff2ad67fc69d9616772ba0c15bf2fac0f6649bc0f3aa919e808769a7301578000000"
    "104578696600004d4d2a0000000008000000000000";

TEST_F(PicturesTest, EveryFormat) {
  const auto expect = [&](const char* name, const Bytes& bytes, double tolerance = 1e-6) {
    const std::string path = write(name, bytes);
    SCOPED_TRACE(name);
    ASSERT_EQ(refusal(path), "was accepted");
    const LinearPicture picture = read_linear(path, {});
    EXPECT_TRUE(picture.display);
    expect_color(picture, kBytes, tolerance);
    expect_color(picture, kBytes, tolerance, 1);
  };
  expect("a.tga", targa({51, 102, 204}));
  expect("a.bmp", bitmap());
  expect("a.tif", tiff(8, {204, 102, 51, 204, 102, 51}));
  const auto word = [](int byte) { return little(static_cast<std::uint16_t>(257 * byte)); };
  const Bytes words = word(204) + word(102) + word(51);
  expect("b.tif", tiff(16, words + words));
  expect("a.dds", dds());
  expect("a.psd", photoshop());
  expect("a.ppm", text("P6\n2 1\n255\n") + Bytes{204, 102, 51, 204, 102, 51});
  expect("a.jp2", from_hex(kJpeg2000), 0.01);
  expect("picture", bitmap());                                // formats are known by their first bytes
  const Bytes avif = from_hex(kAvif), heic = from_hex(kHeic); // where the installed library decodes them
  for (const Bytes& bytes : {avif, heic}) {
    const std::string path = write("a.heif", bytes);
    if (const std::string words_of_it = refusal(path); words_of_it == "was accepted")
      expect_color(read_linear(path, {}), kBytes, 0.02);
    else
      EXPECT_TRUE(has(words_of_it, "cannot be opened as an image")) << words_of_it;
  }
}

TEST_F(PicturesTest, FloatsAreLinear) {
  const LinearPicture map = read_linear(write("a.pfm", floatmap()), {});
  EXPECT_EQ(color_at(map, 0), kColor);
  EXPECT_EQ(color_at(map, 2), (Color{1, 2, 3}));
  EXPECT_FALSE(map.display);
  const LinearPicture deep =
      read_linear(write("a.tif", tiff(32, little(std::array<float, 6>{.25f, .5f, .75f, 4, 5, 6}))), {});
  EXPECT_EQ(color_at(deep, 0), kColor);
  EXPECT_EQ(color_at(deep, 1), (Color{4, 5, 6}));
  EXPECT_FALSE(deep.display);
}

TEST_F(PicturesTest, OrientationIsUndone) {
  const Bytes pixels{255, 0, 0, 0, 0, 255};
  expect_color(read_linear(write("a.tif", tiff(8, pixels)), {}), {1, 0, 0});
  expect_color(read_linear(write("a.tif", tiff(8, pixels, 2)), {}), {0, 0, 1});
  const LinearPicture turned = read_linear(write("a.tif", tiff(8, pixels, 6)), {}); // a quarter clockwise: left is up
  EXPECT_EQ(turned.height, 2u);
  expect_color(turned, {1, 0, 0});
}

// In linear light, as EXR has it.
TEST_F(PicturesTest, ColoursCountTimesAlpha) {
  const double alpha = 51.0 / 255.0;
  expect_color(read_linear(write("a.tga", targa({51, 102, 204, 51})), {}),
               {alpha * kBytes[0], alpha * kBytes[1], alpha * kBytes[2]});
  const auto exr = write_exr(folder_.file("a.exr"), {{"R", .25f}, {"G", .5f}, {"B", .75f}, {"A", .5f}});
  EXPECT_EQ(color_at(read_linear(exr, {})), kColor); // multiplied already
}

TEST_F(PicturesTest, CubesOfOtherFormatsAreRefusedAsLight) {
  ReadRequest request;
  request.environment = request.light = true;
  EXPECT_TRUE(has(refusal(write("cube.dds", dds(0xfe00)), request), "is a cube map"))
      << refusal(write("cube.dds", dds(0xfe00)), request);
}

// --- files that are not what they say ---

std::map<std::string, Bytes> samples(const TemporaryFolder& folder) {
  const auto read = [](const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return Bytes(std::istreambuf_iterator<char>(file), {});
  };
  const Bytes exr = read(write_exr(folder.file("s.exr"), {{"R", .25f}, {"G", .5f}, {"B", .75f}}));
  const Bytes parts = read(write_parts(folder.file("p.exr"),
                                       {{"depth", {{"Z", 7.0f}}}, {"beauty", {{"R", .25f}, {"G", .5f}, {"B", .75f}}}}));
  return {{"a.exr", exr},
          {"parts.exr", parts},
          {"a.hdr", radiance("-Y 1 +X 9", Bytes{2, 2, 0, 9, 137, 1, 137, 2, 137, 3, 137, 136})},
          {"flat.hdr", radiance("-Y 2 +X 1", {128, 64, 0, 129, 255, 1, 2, 0})},
          {"a.tga", targa({51, 102, 204, 51})},
          {"a.bmp", bitmap()},
          {"a.tif", tiff(8, {204, 102, 51, 204, 102, 51})},
          {"a.dds", dds()},
          {"a.psd", photoshop()},
          {"a.pfm", floatmap()},
          {"a.jp2", from_hex(kJpeg2000)}};
}

TEST_F(PicturesTest, CutShortIsRefused) {
  testing::internal::CaptureStderr();
  for (const auto& [name, whole] : samples(folder_)) {
    const std::string path = write(name, whole);
    if (refusal(path) != "was accepted") continue; // a format that the installed library does not decode
    const LinearPicture sound = read_linear(path, {});
    const std::size_t step = 1 + whole.size() / 60;
    for (std::size_t length = 0; length < whole.size(); length += step) {
      write(name, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)});
      if (const std::string words = refusal(path); words == "was accepted") {
        EXPECT_EQ(read_linear(path, {}).planes, sound.planes) << name << ": " << length << " of " << whole.size();
      }
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(PicturesTest, DamagedBytesDoNoHarm) {
  testing::internal::CaptureStderr();
  std::mt19937 random(1);
  int refused = 0, decoded = 0;
  ReadRequest request;
  request.check = [](std::uint32_t width, std::uint32_t height) {
    if (std::uint64_t{width} * height > 1u << 20) throw Error("it", "is too large", "shrink it");
  };
  for (const auto& [name, whole] : samples(folder_))
    for (int i = 0; i < 100; ++i) {
      Bytes damaged = whole;
      for (std::uint32_t flips = 1 + random() % 4; flips > 0; --flips)
        damaged[random() % std::min<std::size_t>(damaged.size(), 400)] ^=
            static_cast<std::uint8_t>(i % 2 ? 1u << random() % 8 : random());
      try {
        const LinearPicture picture = read_linear(write(name, damaged), request);
        for (const std::vector<float>& plane : picture.planes)
          EXPECT_EQ(plane.size(), std::size_t{picture.width} * picture.height);
        ++decoded;
      } catch (const Error&) {
        ++refused;
      }
    }
  EXPECT_GT(refused, 300);
  EXPECT_GT(decoded, 100);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// Headers that claim the most that their format can say, with next to no data: believed, they would take gigabytes.
TEST_F(PicturesTest, SizesAreTriedBeforeMemoryIsTaken) {
  Bytes wide_tga = targa({1, 2, 3}), wide_bmp = bitmap(), wide_tif = tiff(8, Bytes(6)), wide_psd = photoshop();
  std::fill_n(wide_tga.begin() + 12, 4, std::uint8_t{255});
  wide_bmp[20] = wide_bmp[24] = 2;
  wide_tif[8 + 2 + 8 + 1] = wide_tif[8 + 2 + 12 + 8 + 1] = 0xff;
  wide_psd[15] = wide_psd[19] = 4;
  const std::map<std::string, Bytes> files = {{"a.hdr", radiance("-Y 2147483647 +X 2147483647", {})},
                                              {"a.tga", wide_tga},
                                              {"a.bmp", wide_bmp},
                                              {"a.tif", wide_tif},
                                              {"a.psd", wide_psd},
                                              {"a.pfm", text("PF\n200000 200000\n-1.0\n")}};
  ReadRequest request;
  request.check = [](std::uint32_t width, std::uint32_t height) {
    if (std::uint64_t{width} * height > 1u << 20) throw Error("it", "is too large", "shrink it");
  };
  for (const auto& [name, bytes] : files) EXPECT_NE(refusal(write(name, bytes), request), "was accepted") << name;
}

TEST_F(PicturesTest, OtherFilesAreNoPictures) {
  for (const char* other : {"", "#", "RIFF1234WAVE", "GIF89a", "II*", "\x1a\x45\xdf\xa3 a film", "P7 x"})
    EXPECT_TRUE(has(refusal(write("a.tga", text(other))), "is no picture of a format that can be read")) << other;
  EXPECT_TRUE(has(refusal(folder_.path().string()), "cannot be read"));
  EXPECT_TRUE(has(refusal("/dev/zero"), "cannot be read"));
  EXPECT_TRUE(has(refusal(folder_.file("absent.tif")), "cannot be read"));
}

} // namespace
} // namespace wavepath::test
