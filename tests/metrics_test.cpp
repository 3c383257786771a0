// Metrics against values worked out by hand, FLIP against what follows from its definition.
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <gtest/gtest.h>
#include <glm/glm.hpp>

#include "host/base/error.h"
#include "host/picture/metrics/metrics.h"

namespace wavepath {
namespace {

Picture constant(std::uint32_t width, std::uint32_t height, glm::vec3 color) {
  Picture picture{width, height, {}};
  for (int c = 0; c < 3; ++c)
    picture.channels.push_back({std::string(1, "RGB"[c]), std::vector<float>(width * height, color[c])});
  return picture;
}

double mean(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

TEST(Metrics, ByHand) {
  Picture picture = constant(2, 1, glm::vec3(0.0f)), reference = picture;
  picture.channels[0].values = {1.0f, 2.0f};
  reference.channels[0].values = {0.5f, 2.0f};
  reference.channels[1].values = {0.0f, 4.0f};
  picture.channels[1].values = {0.0f, 3.0f};
  const PictureMetrics m = compare_pictures(picture, reference);
  EXPECT_NEAR(m.mse, (0.25 + 1.0) / 6.0, 1e-12);
  EXPECT_NEAR(m.relmse, (0.25 / 0.26 + 1.0 / 16.01) / 6.0, 1e-9);
  EXPECT_NEAR(m.mrse, (0.25 / (0.51 * 0.51) + 1.0 / (4.01 * 4.01)) / 6.0, 1e-9);
  EXPECT_NEAR(m.psnr, 10.0 * std::log10(16.0 / m.mse), 1e-9);
  EXPECT_NEAR(compare_pictures(picture, reference, 1.0).psnr, 10.0 * std::log10(1.0 / m.mse), 1e-9);
  EXPECT_DOUBLE_EQ(m.max, 1.0);
  EXPECT_DOUBLE_EQ(m.mean_ratio[0], 3.0 / 2.5);
  EXPECT_DOUBLE_EQ(m.mean_ratio[1], 0.75);
  EXPECT_TRUE(std::isnan(m.mean_ratio[2]));
}

TEST(Metrics, HighPercentileIgnoresOnePixelInAThousand) {
  const Picture reference = constant(100, 100, glm::vec3(1.0f));
  Picture picture = constant(100, 100, glm::vec3(1.25f));
  for (std::size_t i = 0; i < 29; ++i) picture.channels[0].values[i] = 100.0f; // of 30,000 values
  EXPECT_DOUBLE_EQ(compare_pictures(picture, reference).p999, 0.25);
  for (std::size_t i = 29; i < 40; ++i) picture.channels[0].values[i] = 100.0f;
  EXPECT_DOUBLE_EQ(compare_pictures(picture, reference).p999, 99.0);
}

TEST(Metrics, NonFiniteValuesAreCountedAndGiveNoScore) {
  const Picture good = constant(4, 4, glm::vec3(1.0f));
  Picture bad = good;
  bad.channels[0].values[3] = std::numeric_limits<float>::quiet_NaN();
  bad.channels[2].values[0] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(compare_pictures(bad, good).nonfinite_image, 2u);
  EXPECT_EQ(compare_pictures(good, bad).nonfinite_reference, 2u);
  EXPECT_FALSE(compare_pictures(good, bad).finite());
}

TEST(Metrics, OtherSizesAreRefused) {
  EXPECT_THROW(compare_pictures(constant(4, 4, glm::vec3(1.0f)), constant(4, 5, glm::vec3(1.0f))), Error);
}

// The largest distance in the color space is between green and blue, and redistribution maps it to one.
TEST(Flip, GreenAgainstBlueIsOne) {
  for (const float value : ldr_flip(constant(8, 8, {0, 1, 0}), constant(8, 8, {0, 0, 1})))
    EXPECT_NEAR(value, 1.0f, 1e-5f);
}

// Flat black and white have no features, so their error is the redistributed distance of 100^0.7 = 25.119 alone. The
// largest distance is 203.30 (green 87.736, -75.610, 72.981; blue 32.298, 25.578, -34.836), 203.30^0.7 = 41.276, 0.4 of
// it 16.510.
TEST(Flip, BlackAgainstWhite) {
  const float value = ldr_flip(constant(8, 8, glm::vec3(0.0f)), constant(8, 8, glm::vec3(1.0f)))[20];
  EXPECT_NEAR(value, 0.95 + 0.05 * (25.1189 - 16.5104) / (41.2761 - 16.5104), 1e-5);
}

TEST(Flip, EqualPicturesHaveNoError) {
  const Picture picture = constant(16, 9, {0.2f, 0.5f, 3.0f});
  for (const float value : ldr_flip(picture, picture)) EXPECT_EQ(value, 0.0f);
  for (const float value : hdr_flip(picture, picture)) EXPECT_EQ(value, 0.0f);
}

TEST(Flip, GrowsWithNoiseAndIsLocal) {
  const Picture reference = constant(64, 64, glm::vec3(0.5f));
  const auto noisy = [&](float amount) {
    Picture picture = reference;
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(-amount, amount);
    for (Channel& channel : picture.channels)
      for (float& value : channel.values) value += uniform(random);
    return picture;
  };
  const double little = mean(ldr_flip(noisy(0.02f), reference)), more = mean(ldr_flip(noisy(0.1f), reference));
  EXPECT_GT(little, 0.0);
  EXPECT_GT(more, 2.0 * little);
  EXPECT_GT(mean(hdr_flip(noisy(0.1f), reference)), mean(hdr_flip(noisy(0.02f), reference)));

  Picture spot = reference;
  spot.channels[0].values[32 * 64 + 32] = 1.0f;
  const std::vector<float> map = ldr_flip(spot, reference);
  EXPECT_GT(map[32 * 64 + 32], 0.1f);
  EXPECT_EQ(map[0], 0.0f);
  EXPECT_FLOAT_EQ(map[32 * 64 + 30], map[30 * 64 + 32]); // no axis is special
}

// Exposure follows the reference, so scaling both pictures changes nothing; LDR-FLIP would see only black or white.
TEST(Flip, HdrSeesDifferencesAtAnyBrightness) {
  const auto half_doubled = [](float scale) {
    const Picture reference = constant(32, 32, glm::vec3(scale));
    Picture picture = reference;
    for (Channel& channel : picture.channels)
      for (std::size_t i = 0; i < 512; ++i) channel.values[i] *= 2.0f;
    return mean(hdr_flip(picture, reference));
  };
  EXPECT_GT(half_doubled(1.0f), 0.02);
  EXPECT_NEAR(half_doubled(1e-3f), half_doubled(1.0f), 1e-4);
  EXPECT_NEAR(half_doubled(1e4f), half_doubled(1.0f), 1e-4);
}

TEST(Flip, ABlackReferenceIsNoTrap) {
  EXPECT_GT(mean(hdr_flip(constant(8, 8, glm::vec3(1.0f)), constant(8, 8, glm::vec3(0.0f)))), 0.5);
}

} // namespace
} // namespace wavepath
