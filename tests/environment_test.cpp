// Environments: values of flags, valid and broken files, the lat-long convention, and the importance table.
#include "host/scene/staging/environment.h"

#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>
#include <random>
#include <span>

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/codecs/picture_module.h"
#include "host/scene/pack/emission.h"
#include "host/scene/pack/environment_light.h"
#include "host/scene/pack/intervals.h"

namespace wavepath {
namespace {

constexpr double kPi = std::numbers::pi;

std::string temporary_file(const std::string& name) {
  return (std::filesystem::path(testing::TempDir()) / ("wavepath_environment_" + name)).string();
}

struct FileOptions {
  Imf::PixelType type = Imf::FLOAT;
  int tile = 0; // 0: scanlines
  bool mip = false;
  std::vector<std::string> channels{"R", "G", "B"};
};

// `values` interleaved, as OpenEXR takes them: halfs or floats.
struct Samples {
  Samples(const std::vector<float>& values, bool as_half) : floats(values), halves(as_half ? values.size() : 0) {
    for (std::size_t i = 0; i < halves.size(); ++i) halves[i] = floats[i];
  }
  Imf::FrameBuffer frame(const FileOptions& options, int width) {
    Imf::FrameBuffer pixels;
    const std::size_t count = options.channels.size(), bytes = halves.empty() ? sizeof(float) : sizeof(Imath::half);
    char* first = halves.empty() ? reinterpret_cast<char*>(floats.data()) : reinterpret_cast<char*>(halves.data());
    for (std::size_t c = 0; c < count; ++c)
      pixels.insert(options.channels[c], Imf::Slice(options.type, first + c * bytes, count * bytes,
                                                    count * bytes * static_cast<std::size_t>(width)));
    return pixels;
  }
  std::vector<float> floats;
  std::vector<Imath::half> halves;
};

// Writes `values` (interleaved) and, with `mip`, further MIP levels full of 99.
std::string write_exr_map(const std::string& name, int width, int height, const std::vector<float>& values,
                          const FileOptions& options = {}) {
  const std::string file = temporary_file(name);
  const bool as_half = options.type == Imf::HALF;
  Imf::Header header(width, height);
  for (const std::string& channel : options.channels) header.channels().insert(channel, Imf::Channel(options.type));
  Samples samples(values, as_half), filler(std::vector<float>(values.size(), 99.0f), as_half);
  if (options.tile == 0) {
    Imf::OutputFile output(file.c_str(), header);
    output.setFrameBuffer(samples.frame(options, width));
    output.writePixels(height);
    return file;
  }
  const auto tile = static_cast<unsigned>(options.tile);
  header.setTileDescription(Imf::TileDescription(tile, tile, options.mip ? Imf::MIPMAP_LEVELS : Imf::ONE_LEVEL));
  Imf::TiledOutputFile output(file.c_str(), header);
  for (int level = 0; level < output.numLevels(); ++level) {
    output.setFrameBuffer((level == 0 ? samples : filler).frame(options, output.levelWidth(level)));
    output.writeTiles(0, output.numXTiles(level) - 1, 0, output.numYTiles(level) - 1, level);
  }
  return file;
}

std::string write_hdr_map(const std::string& name, std::uint32_t width, std::uint32_t height,
                          const std::vector<float>& values) {
  const std::string file = temporary_file(name);
  const std::vector<std::uint8_t> bytes = picture_module(file).encode_radiance(width, height, values);
  write_file(file, {bytes.begin(), bytes.end()});
  return file;
}

// Pixel i holds (i, i + 1/4, i + 1/2): exact in half and in RGBE for small images.
std::vector<float> counting_pixels(int count) {
  std::vector<float> values;
  for (int i = 0; i < count; ++i)
    for (int c = 0; c < 3; ++c) values.push_back(static_cast<float>(i) + 0.25f * static_cast<float>(c));
  return values;
}

void expect_counting(const Environment& environment, std::uint32_t width, std::uint32_t height) {
  ASSERT_EQ(environment.width, width);
  ASSERT_EQ(environment.height, height);
  for (std::size_t i = 0; i < environment.map.size(); ++i) {
    const auto value = static_cast<float>(i);
    ASSERT_EQ(environment.map[i], glm::vec3(value, value + 0.25f, value + 0.5f)) << i;
  }
}

std::string message_of(const std::string& argument) {
  try {
    load_environment(argument);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

bool has(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

TEST(Environment, ReadsConstants) {
  const Environment environment = load_environment("0.5,1,2e1", 2.0, 0.25);
  EXPECT_TRUE(environment.map.empty());
  EXPECT_EQ(environment.radiance, glm::vec3(1.0f, 2.0f, 40.0f));
  EXPECT_EQ(environment.rotation, 0.25);
  EXPECT_TRUE(environment.present());
  EXPECT_FALSE(load_environment("0,0,0").present());
}

TEST(Environment, RefusesWhatIsNeitherConstantNorMap) {
  EXPECT_TRUE(has(message_of("1,2"), "neither R,G,B nor"));
  EXPECT_TRUE(has(message_of("1,2,x"), "neither R,G,B nor"));
  EXPECT_TRUE(has(message_of("1,2,3,4"), "neither R,G,B nor"));
  EXPECT_TRUE(has(message_of("studioo"), "neither R,G,B nor"));
  EXPECT_TRUE(has(message_of("sky.png"), "does not exist"));
  EXPECT_TRUE(has(message_of("-1,0,0"), "not negative"));
  EXPECT_TRUE(has(message_of(temporary_file("missing.exr")), "does not exist"));
  EXPECT_THROW(load_environment("1,1,1", -1.0), UsageError);
  EXPECT_THROW(load_environment("1,1,1", 1.0, std::numeric_limits<double>::quiet_NaN()), UsageError);
}

TEST(Environment, ReadsFloatHalfTiledMippedAndRadianceFiles) {
  const std::vector<float> values = counting_pixels(32);
  expect_counting(load_environment(write_exr_map("float.exr", 8, 4, values)), 8, 4);
  expect_counting(load_environment(write_exr_map("half.exr", 8, 4, values, {.type = Imf::HALF})), 8, 4);
  expect_counting(load_environment(write_exr_map("UPPER.EXR", 8, 4, values)), 8, 4);
  const std::vector<float> many = counting_pixels(32 * 16);
  expect_counting(load_environment(write_exr_map("tiled.exr", 32, 16, many, {.tile = 16})), 32, 16);
  expect_counting(load_environment(write_exr_map("mipped.exr", 32, 16, many, {.tile = 16, .mip = true})), 32, 16);
  expect_counting(load_environment(write_hdr_map("radiance.hdr", 8, 4, values)), 8, 4);
}

TEST(Environment, FindsChannelsByName) {
  std::vector<float> values;
  for (int i = 0; i < 8; ++i) values.insert(values.end(), {1.0f, 7.0f, 3.0f, 2.0f, 1.0f}); // A, Z, B, G, R
  const Environment environment =
      load_environment(write_exr_map("names.exr", 4, 2, values, {.channels = {"A", "Z", "B", "G", "R"}}));
  EXPECT_EQ(environment.map[5], glm::vec3(1.0f, 2.0f, 3.0f));
  const Environment grey =
      load_environment(write_exr_map("grey.exr", 4, 2, std::vector<float>(8, 0.5f), {.channels = {"Y"}}));
  EXPECT_EQ(grey.map[7], glm::vec3(0.5f));
  const std::string message =
      message_of(write_exr_map("uv.exr", 4, 2, std::vector<float>(16, 0.5f), {.channels = {"R", "G"}}));
  EXPECT_TRUE(has(message, "no R, G and B channels (it has R, G)")) << message;
}

TEST(Environment, NamesTheTexelThatIsNoRadiance) {
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -0.5f};
  for (const float value : bad) {
    std::vector<float> values = counting_pixels(32);
    values[3 * (2 * 8 + 5) + 1] = value;
    const std::string message = message_of(write_exr_map("bad.exr", 8, 4, values));
    EXPECT_TRUE(has(message, "pixel (5, 2)")) << message;
  }
}

TEST(Environment, RefusesCroppedAndSubsampledFiles) {
  const auto write = [](const std::string& name, const Imf::Header& header) {
    const std::string file = temporary_file(name);
    std::vector<float> values(64, 1.0f);
    Imf::FrameBuffer pixels;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
      pixels.insert(c.name(), Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), 4, 16,
                                         c.channel().xSampling, c.channel().ySampling));
    Imf::OutputFile output(file.c_str(), header);
    output.setFrameBuffer(pixels);
    output.writePixels(4);
    return file;
  };
  Imf::Header cropped(4, 4);
  cropped.displayWindow().max.x = 9;
  for (const char* name : {"R", "G", "B"}) cropped.channels().insert(name, Imf::Channel(Imf::FLOAT));
  EXPECT_TRUE(has(message_of(write("cropped.exr", cropped)), "data window (4 x 4) that differs"));
  Imf::Header subsampled(4, 4);
  subsampled.channels().insert("Y", Imf::Channel(Imf::FLOAT, 2, 2));
  const std::string message = message_of(write("subsampled.exr", subsampled));
  EXPECT_TRUE(has(message, "channel Y at less than full resolution")) << message;
}

TEST(Environment, RefusesBrokenFilesInWords) {
  const std::string garbage = temporary_file("garbage.exr");
  std::ofstream(garbage) << "this is no image";
  EXPECT_TRUE(has(message_of(garbage), "cannot be opened as an image")) << message_of(garbage);
  const std::string whole = write_exr_map("whole.exr", 64, 32, counting_pixels(64 * 32));
  std::filesystem::resize_file(whole, std::filesystem::file_size(whole) / 2);
  EXPECT_NE(message_of(whole), "no error");
  const std::string radiance = write_hdr_map("cut.hdr", 8, 4, counting_pixels(32));
  std::filesystem::resize_file(radiance, std::filesystem::file_size(radiance) - 1);
  EXPECT_TRUE(has(message_of(radiance), "cannot be opened as an image: is damaged")) << message_of(radiance);
  EXPECT_NE(message_of(testing::TempDir()), "no error");
}

TEST(Environment, TurnsDirectionsIntoPositions) {
  const auto expect_uv = [](const glm::dvec3& d, double rotation, double u, double v) {
    const glm::dvec2 uv = environment_uv(d, rotation);
    EXPECT_NEAR(uv.x, u, 1e-12);
    EXPECT_NEAR(uv.y, v, 1e-12);
  };
  expect_uv({1, 0, 0}, 0.0, 0.5, 0.5);   // the centre looks along +X
  expect_uv({0, 0, 1}, 0.0, 0.75, 0.5);  // three quarters across is +Z
  expect_uv({0, 0, -2}, 0.0, 0.25, 0.5); // one quarter is -Z, at any length
  EXPECT_NEAR(environment_uv({0, 1, 0}, 0.0).y, 0.0, 1e-12);
  EXPECT_NEAR(environment_uv({0, -1, 0}, 0.0).y, 1.0, 1e-12);
  // Turned a quarter counter-clockwise seen from above, what showed along +X shows along -Z.
  expect_uv({0, 0, -1}, kPi / 2, 0.5, 0.5);
  expect_uv({1, 0, 0}, kPi / 2, 0.75, 0.5);
}

TEST(Environment, InvertsTheConvention) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.001, 0.999);
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec2 uv{uniform(random), uniform(random)};
    const double rotation = 10.0 * uniform(random) - 5.0;
    const glm::dvec3 d = environment_direction(uv, rotation);
    EXPECT_NEAR(glm::length(d), 1.0, 1e-12);
    const glm::dvec2 back = environment_uv(3.0 * d, rotation);
    EXPECT_NEAR(back.x, uv.x, 1e-10);
    EXPECT_NEAR(back.y, uv.y, 1e-10);
  }
}

// The probabilities that the packed texels really have, from the intervals of rows and columns.
std::vector<double> table_probabilities(const PackedScene& packed) {
  const std::size_t width = packed.environment_width, height = packed.environment_height;
  const std::span<const std::uint32_t> ends = packed.environment_ends;
  std::vector<double> probabilities;
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) {
      const double row = interval_probability(ends.first(height), y);
      const double column = interval_probability(ends.subspan(height + y * width, width), x);
      probabilities.push_back(row > 0.0 ? row * column : 0.0);
    }
  return probabilities;
}

TEST(EnvironmentLight, WeighsTexelsByTentAndSolidAngle) {
  Environment environment;
  environment.radiance = glm::vec3(2.0f);
  environment.width = 8;
  environment.height = 4;
  environment.map.assign(32, glm::vec3(0.0f));
  environment.map[0] = glm::vec3(1.0f); // top left: its neighbours are across the seam, and itself beyond the pole
  PackedScene packed;
  const double integral = pack_environment(environment, gpu::kDirectNee, packed);
  const double ring[] = {2 * kPi / 8 * (1 - std::sqrt(0.5)),
                         2 * kPi / 8 * std::sqrt(0.5)}; // of a texel in rows 0 and 1
  const double top = (4.0 + 2.0) / 16.0, side = (2.0 + 1.0) / 16.0, below = 2.0 / 16.0, corner = 1.0 / 16.0;
  EXPECT_NEAR(integral, 2.0 * ((top + 2 * side) * ring[0] + (below + 2 * corner) * ring[1]), 1e-12);
  const std::vector<double> probability = table_probabilities(packed);
  const auto expect = [&](std::size_t texel, double weight) {
    EXPECT_NEAR(probability[texel], 2.0 * weight / integral, 1e-7) << texel;
    EXPECT_FLOAT_EQ(packed.environment[texel].w, static_cast<float>(probability[texel]));
  };
  expect(0, top * ring[0]);
  expect(1, side * ring[0]);
  expect(7, side * ring[0]);
  expect(8, below * ring[1]);
  expect(9, corner * ring[1]);
  expect(15, corner * ring[1]);
  for (const std::size_t dark : {2u, 6u, 10u, 16u, 31u}) EXPECT_EQ(packed.environment[dark].w, 0.0f);
}

// The weights by their formula, a texel at a time.
std::vector<double> plain_weights(const Environment& map, double& integral) {
  std::vector<double> weights;
  for (std::size_t y = 0; y < map.height; ++y)
    for (std::size_t x = 0; x < map.width; ++x) {
      const std::size_t columns[3] = {(x + map.width - 1) % map.width, x, (x + 1) % map.width};
      const std::size_t rows[3] = {y > 0 ? y - 1 : 0, y, std::min<std::size_t>(y + 1, map.height - 1)};
      double sum = 0.0;
      for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i)
          sum += (i == 1 ? 2.0 : 1.0) * (j == 1 ? 2.0 : 1.0) *
                 luminance(glm::dvec3(map.radiance) * glm::dvec3(map.map[rows[j] * map.width + columns[i]]));
      weights.push_back(sum / 16.0 * texel_solid_angle(y, map.width, map.height));
    }
  integral = std::accumulate(weights.begin(), weights.end(), 0.0);
  return weights;
}

// Pictures keep their bits, whatever the size, and whatever was packed there before.
TEST(EnvironmentLight, IsPackedToTheBitByThreadsAndInMemoryOfAnother) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0.0f, 3.0f);
  PackedScene again;
  for (const glm::uvec2 size : {glm::uvec2(1, 1), {2, 1}, {1, 3}, {64, 32}, {37, 53}, {64, 32}, {300, 130}, {5, 17}}) {
    Environment map;
    map.radiance = {0.5f, 2.0f, 1.25f};
    map.width = size.x, map.height = size.y;
    for (std::size_t i = 0; i < std::size_t{size.x} * size.y; ++i)
      map.map.push_back(i / size.x % 5 == 3 ? glm::vec3(0.0f)
                                            : glm::vec3(uniform(random), uniform(random), uniform(random)));
    if (size.x == 64) // a row that is never picked
      for (std::size_t x = 0; x < 3 * 64; ++x) map.map[4 * 64 + x] = glm::vec3(0.0f);
    double integral = 0.0;
    const std::vector<double> weights = plain_weights(map, integral);
    PackedScene fresh;
    EXPECT_EQ(pack_environment(map, gpu::kDirectNee, fresh), integral);
    EXPECT_EQ(fresh.environment_ends, environment_intervals(weights, size.x, size.y)) << size.x << "x" << size.y;
    EXPECT_EQ(pack_environment(map, gpu::kDirectNee, again), integral);
    EXPECT_EQ(again.environment_ends, fresh.environment_ends);
    EXPECT_EQ(again.environment, fresh.environment);
    const std::vector<double> probabilities = table_probabilities(fresh);
    for (std::size_t i = 0; i < weights.size(); ++i)
      EXPECT_EQ(fresh.environment[i], glm::vec4(map.map[i], static_cast<float>(probabilities[i]))) << i;
  }
  Environment dark;
  dark.radiance = glm::vec3(0.25f);
  pack_environment(dark, gpu::kDirectNee, again);
  EXPECT_TRUE(again.environment.empty() && again.environment_ends.empty());
  EXPECT_EQ(again.environment_width, 0u);
  EXPECT_EQ(again.environment_radiance, glm::vec3(0.25f));
}

// With MIS dim texels get less than their fraction, and none gets nothing.
TEST(EnvironmentLight, LeavesDimTexelsToBsdfSampling) {
  Environment environment;
  environment.radiance = glm::vec3(1.0f);
  environment.width = 64;
  environment.height = 32;
  environment.map.assign(64 * 32, glm::vec3(0.1f));
  for (std::size_t x = 0; x < 64; ++x)
    for (std::size_t y = 8; y < 16; ++y) environment.map[y * 64 + x] = glm::vec3(5.0f);
  PackedScene plain, compensated;
  const double integral = pack_environment(environment, gpu::kDirectNee, plain);
  EXPECT_EQ(pack_environment(environment, gpu::kDirectMis, compensated), integral);
  const std::size_t dim = 25 * 64 + 3, bright = 12 * 64 + 3;
  const double taken = 0.5 * integral / (4 * kPi);
  const auto ratio = [&](std::size_t texel) { return compensated.environment[texel].w / plain.environment[texel].w; };
  EXPECT_NEAR(ratio(dim) / ratio(bright), 0.125 / (1.0 - taken / 5.0), 1e-3);
  double sum = 0.0;
  for (const glm::vec4& texel : compensated.environment) {
    EXPECT_GT(texel.w, 0.0f);
    sum += texel.w;
  }
  EXPECT_NEAR(sum, 1.0, 1e-6);
}

TEST(EnvironmentLight, SumsToTheSphereAndToOne) {
  Environment environment;
  environment.radiance = glm::vec3(1.0f);
  environment.width = 64;
  environment.height = 32;
  environment.map.assign(64 * 32, glm::vec3(3.0f));
  PackedScene packed;
  EXPECT_NEAR(pack_environment(environment, gpu::kDirectNee, packed), 4 * kPi * 3.0, 1e-9);
  double sum = 0.0;
  for (const glm::vec4& texel : packed.environment) sum += texel.w;
  EXPECT_NEAR(sum, 1.0, 1e-6);
  EXPECT_EQ(packed.environment_radiance, glm::vec3(1.0f)); // the scale; texels hold the map as it is
  EXPECT_EQ(packed.environment[5], glm::vec4(glm::vec3(3.0f), packed.environment[5].w));
}

TEST(EnvironmentLight, FindsOneBrightTexelAmongMillions) {
  Environment environment;
  environment.radiance = glm::vec3(1.0f);
  environment.width = 1024;
  environment.height = 512;
  environment.map.assign(1024 * 512, glm::vec3(1e-3f));
  environment.map[256 * 1024 + 100] = glm::vec3(1e9f);
  PackedScene packed;
  pack_environment(environment, gpu::kDirectNee, packed);
  const std::vector<double> probability = table_probabilities(packed);
  EXPECT_NEAR(probability[256 * 1024 + 100], 0.25, 1e-4); // 4/16 of the tent
  EXPECT_NEAR(probability[256 * 1024 + 101], 0.125, 1e-4);
  double smallest = 1.0;
  for (const double p : probability) smallest = std::min(smallest, p);
  EXPECT_GT(smallest, 0.0);
}

TEST(EnvironmentLight, TreatsBlackMapsAsNone) {
  Environment environment;
  environment.radiance = glm::vec3(1.0f);
  environment.width = 4;
  environment.height = 2;
  environment.map.assign(8, glm::vec3(0.0f));
  PackedScene packed;
  EXPECT_EQ(pack_environment(environment, gpu::kDirectNee, packed), 0.0);
  EXPECT_TRUE(packed.environment.empty() && packed.environment_ends.empty());
  EXPECT_EQ(packed.environment_radiance, glm::vec3(0.0f));
  EXPECT_EQ(packed.environment_width, 0u);
}

} // namespace
} // namespace wavepath
