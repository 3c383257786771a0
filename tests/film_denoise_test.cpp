// The filter of finished pictures on pictures whose truth is known: noise goes, edges of every kind stay, light is
// kept.
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "host/picture/filter/denoise.h"

namespace wavepath {
namespace {

using glm::vec3;
using Colors = std::vector<vec3>;

// What a pixel shows.
struct Seen {
  float light = 1.0f; // reflected, relative to the albedo
  vec3 albedo{0.8f}, normal{0.0f, 0.0f, 1.0f}, emission{0.0f};
  float depth = 4.0f;
};
using Subject = std::function<Seen(int x, int y)>;

Colors truth_of(int width, int height, const Subject& subject) {
  Colors truth;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Seen seen = subject(x, y);
      truth.push_back(seen.emission + seen.light * seen.albedo);
    }
  return truth;
}

// A render of `samples` a pixel, in two halves whose difference gives the variance, as a film has them. A sample is
// bright with probability `chance`, else black: relative deviation sqrt((1 - chance) / chance).
NoisyPicture render(int width, int height, const Subject& subject, int samples, double chance, unsigned seed = 1) {
  NoisyPicture picture;
  picture.width = static_cast<unsigned>(width), picture.height = static_cast<unsigned>(height);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Seen seen = subject(x, y);
      double halves[2] = {};
      for (int s = 0; s < samples; ++s) halves[s % 2] += uniform(random) < chance ? 2.0 / (chance * samples) : 0.0;
      const vec3 reflected = seen.light * seen.albedo;
      const auto mean = static_cast<float>(0.5 * (halves[0] + halves[1])),
                 spread = static_cast<float>(0.5 * (halves[0] - halves[1]));
      picture.color.push_back(seen.emission + reflected * mean);
      picture.variance.push_back(reflected * reflected * spread * spread);
      picture.emission.push_back(seen.emission);
      picture.albedo.push_back(seen.albedo);
      picture.normal.push_back(seen.normal);
      picture.depth.push_back(seen.depth);
    }
  return picture;
}

double rms(const Colors& picture, const Colors& truth) {
  double sum = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) sum += glm::dot(picture[i] - truth[i], picture[i] - truth[i]) / 3.0;
  return std::sqrt(sum / static_cast<double>(truth.size()));
}

double total(const Colors& picture) {
  double sum = 0.0;
  for (const vec3& color : picture) sum += double{color.r} + double{color.g} + double{color.b};
  return sum;
}

bool same_bits(const Colors& a, const Colors& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(vec3)) == 0;
}

// Light that falls off over the picture, as near a lamp.
Seen wall(int x, int) { return {.light = 1.0f + 0.01f * static_cast<float>(x)}; }

TEST(FilmDenoise, NoiseGoes) {
  const Colors truth = truth_of(96, 64, wall);
  for (const int samples : {4, 16, 64}) {
    SCOPED_TRACE(samples);
    const NoisyPicture noisy = render(96, 64, wall, samples, 0.5);
    EXPECT_LT(rms(denoise(noisy), truth), 0.15 * rms(noisy.color, truth));
  }
}

TEST(FilmDenoise, RareBrightSamplesAreSpreadAndNotLost) {
  const Colors truth = truth_of(128, 128, wall);
  const NoisyPicture noisy = render(128, 128, wall, 4, 0.01);
  const Colors out = denoise(noisy);
  EXPECT_LT(rms(out, truth), 0.4 * rms(noisy.color, truth));
  EXPECT_NEAR(total(out) / total(noisy.color), 1.0, 1e-3);
}

TEST(FilmDenoise, LightStays) {
  std::mt19937 random(5);
  for (const double chance : {0.9, 0.5, 0.05}) {
    SCOPED_TRACE(chance);
    NoisyPicture noisy = render(
        100, 70,
        [](int x, int y) {
          Seen seen = wall(x, y);
          seen.albedo = (x / 8 + y / 8) % 2 ? vec3(0.9f, 0.5f, 0.2f) : vec3(0.05f, 0.1f, 0.6f);
          seen.normal = glm::normalize(vec3(std::sin(0.1f * static_cast<float>(x)), 0.0f, 1.0f));
          return seen;
        },
        8, chance);
    for (int i = 0; i < 5; ++i) { // one of its samples was a hundred times as bright as it should be
      const std::size_t pixel = random() % noisy.pixels();
      noisy.color[pixel] += 12.0f * noisy.albedo[pixel];
      noisy.variance[pixel] += 144.0f * noisy.albedo[pixel] * noisy.albedo[pixel];
    }
    EXPECT_NEAR(total(denoise(noisy)) / total(noisy.color), 1.0, 0.01);
  }
}

// What there is no noise to hide behind stays: error that is there already does not grow by more than 3 %.
TEST(FilmDenoise, ConvergedPicturesStay) {
  const auto detailed = [](int x, int y) {
    Seen seen{.light = 1.0f + 0.5f * std::sin(0.7f * static_cast<float>(x)) * std::cos(0.4f * static_cast<float>(y))};
    if (x % 16 == 3) seen.light = 3.0f;         // a bright line
    if (x == 40 && y == 30) seen.light = 20.0f; // and a glint
    return seen;
  };
  const Colors truth = truth_of(80, 60, detailed);
  const NoisyPicture noisy = render(80, 60, detailed, 4096, 0.9);
  EXPECT_LT(rms(denoise(noisy), truth), 1.03 * rms(noisy.color, truth));
}

TEST(FilmDenoise, TextureStays) {
  const auto checker = [](int x, int y) { return Seen{.albedo = vec3((x + y) % 2 ? 0.9f : 0.15f)}; };
  const Colors truth = truth_of(64, 64, checker);
  const NoisyPicture noisy = render(64, 64, checker, 16, 0.5);
  EXPECT_LT(rms(denoise(noisy), truth), 0.15 * rms(noisy.color, truth));
}

// A mirror shows a checker of light on a surface that is even in itself.
TEST(FilmDenoise, MirrorsStay) {
  const auto mirrored = [](int x, int y) { return Seen{.light = (x / 3 + y / 3) % 2 ? 1.0f : 0.2f}; };
  const Colors truth = truth_of(64, 64, mirrored);
  const NoisyPicture noisy = render(64, 64, mirrored, 64, 0.95); // 3 % of noise
  EXPECT_LT(rms(denoise(noisy), truth), 0.6 * rms(noisy.color, truth));
}

TEST(FilmDenoise, EdgesOfGeometryAndShadowsStay) {
  for (const char* edge : {"normal", "depth", "shadow"}) {
    SCOPED_TRACE(edge);
    const auto two_sides = [&](int x, int) {
      Seen seen;
      if (x < 32) return seen;
      seen.light = 4.0f;
      if (edge == std::string("normal")) seen.normal = vec3(0.8f, 0.0f, 0.6f);
      if (edge == std::string("depth")) seen.depth = 4.8f;
      return seen;
    };
    const Colors truth = truth_of(64, 64, two_sides);
    const Colors out = denoise(render(64, 64, two_sides, 16, 0.5));
    for (const int x : {31, 32}) {
      double column = 0.0, wanted = 0.0;
      for (int y = 0; y < 64; ++y) {
        column += out[static_cast<std::size_t>(64 * y + x)].g;
        wanted += truth[static_cast<std::size_t>(64 * y + x)].g;
      }
      EXPECT_NEAR(column / wanted, 1.0, edge == std::string("shadow") ? 0.2 : 0.08) << x;
    }
  }
}

TEST(FilmDenoise, EmissionIsNotFiltered) {
  const auto lamp = [](int x, int y) {
    Seen seen;
    if (y < 20)
      return Seen{.light = 0.0f, .albedo = vec3(0.0f), .emission = vec3(0.1f * static_cast<float>(x)), .depth = 0.0f};
    if (x == 9) seen.emission = vec3(50.0f);
    return seen;
  };
  const NoisyPicture noisy = render(48, 40, lamp, 8, 0.5);
  const Colors out = denoise(noisy);
  for (std::size_t i = 0; i < 20 * 48; ++i) EXPECT_EQ(out[i], noisy.color[i]) << i; // the sky
  for (std::size_t y = 22; y < 38; ++y) EXPECT_NEAR(out[y * 48 + 9].g, 50.8f, 0.4f);
}

TEST(FilmDenoise, SameBitsForAnyNumberOfThreads) {
  const NoisyPicture noisy = render(150, 90, wall, 4, 0.3);
  const Colors many = denoise(noisy);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE(same_bits(denoise(noisy), many));
}

TEST(FilmDenoise, AnySizeWillAndNoEstimateOfVariance) {
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {1, 50}, {67, 13}, {130, 40}}) {
    SCOPED_TRACE(testing::Message() << width << 'x' << height);
    NoisyPicture noisy = render(width, height, wall, 1, 0.5);
    for (vec3& variance : noisy.variance) variance = vec3(std::numeric_limits<float>::quiet_NaN());
    const Colors out = denoise(noisy);
    for (const vec3& color : out) EXPECT_TRUE(std::isfinite(color.r + color.g + color.b));
    EXPECT_NEAR(total(out), total(noisy.color), 1e-3 * total(noisy.color));
    if (width >= 67) {
      EXPECT_LT(rms(out, truth_of(width, height, wall)), 0.5 * rms(noisy.color, truth_of(width, height, wall)));
    }
  }
}

TEST(FilmDenoise, HugeValuesStayFinite) {
  NoisyPicture noisy = render(40, 30, wall, 4, 0.5);
  noisy.color[300] = vec3(1e18f), noisy.variance[300] = vec3(1e36f);
  noisy.color[700] = vec3(1e30f), noisy.variance[700] = vec3(std::numeric_limits<float>::infinity());
  for (const vec3& color : denoise(noisy)) EXPECT_TRUE(std::isfinite(color.r + color.g + color.b));
}

} // namespace
} // namespace wavepath
