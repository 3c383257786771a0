// Scores of shadows on pictures made for it: each kind of error is counted as what it is.
#include "host/picture/metrics/shadow_score.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "host/picture/files/picture_io.h"

namespace wavepath::test {
namespace {

constexpr std::uint32_t kWidth = 64, kHeight = 48;

// Direct light of a value for every column; the same in all rows and channels.
Picture columns(const std::function<float(std::uint32_t)>& light) {
  Picture picture{kWidth, kHeight, {}};
  for (const char* name : {"direct.R", "direct.G", "direct.B"}) {
    Channel channel{name, {}};
    for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) channel.values.push_back(light(i % kWidth));
    picture.channels.push_back(channel);
  }
  return picture;
}
Picture even(float light) {
  return columns([=](std::uint32_t) { return light; });
}
// Dark to the left of a column.
Picture edge_at(std::uint32_t column, float light = 2.0f) {
  return columns([=](std::uint32_t x) { return x < column ? 0.0f : light; });
}

TEST(ShadowScore, TheTruthIsWithoutError) {
  const Picture truth = edge_at(20), whole = even(2.0f);
  const auto score = score_shadows({truth, whole}, {truth, whole});
  ASSERT_TRUE(score);
  EXPECT_EQ(score->relative_rms, 0.0);
  EXPECT_EQ(score->falsely_lit, 0.0);
  EXPECT_EQ(score->falsely_dark, 0.0);
  EXPECT_EQ(score->edge_displacement, 0.0);
  EXPECT_FALSE(score->penumbra_ratio); // nothing is partly lit
}

TEST(ShadowScore, AnEdgeThatIsOffFalselyLightsOrDarkens) {
  const Picture truth = edge_at(20), whole = even(2.0f), left = edge_at(17), right = edge_at(25);
  const auto lit = score_shadows({left, whole}, {truth, whole}), dark = score_shadows({right, whole}, {truth, whole});
  EXPECT_DOUBLE_EQ(lit->falsely_lit, 3.0 / kWidth);
  EXPECT_EQ(lit->falsely_dark, 0.0);
  EXPECT_DOUBLE_EQ(*lit->edge_displacement, 3.0);
  EXPECT_DOUBLE_EQ(dark->falsely_dark, 5.0 / kWidth);
  EXPECT_EQ(dark->falsely_lit, 0.0);
  EXPECT_DOUBLE_EQ(*dark->edge_displacement, 5.0);
  // All of the light is missing in 5 columns, over 1 squared and 0.1 squared; too much in 3 of them, over 0.1 squared.
  EXPECT_NEAR(dark->relative_rms, std::sqrt(5.0 / kWidth * 1.0 / 1.01), 1e-9);
  EXPECT_NEAR(lit->relative_rms, std::sqrt(3.0 / kWidth * 100.0), 1e-9);
}

TEST(ShadowScore, PenumbraeAreComparedByArea) {
  const auto ramp = [](double width) {
    return columns([=](std::uint32_t x) { return static_cast<float>(std::clamp((x + 0.5) / width, 0.0, 1.0)); });
  };
  const Picture whole = even(1.0f), narrow = ramp(20.0), wide = ramp(40.0);
  EXPECT_NEAR(*score_shadows({wide, whole}, {narrow, whole})->penumbra_ratio, 2.0, 0.1);
  EXPECT_NEAR(*score_shadows({narrow, whole}, {wide, whole})->penumbra_ratio, 0.5, 0.05);
}

// What samples of lights make brighter or darker is no error of a shadow.
TEST(ShadowScore, LightThatIsSampledOtherwiseCountsNothing) {
  const Picture truth = edge_at(20), whole = even(2.0f), bright = edge_at(20, 3.0f), brighter = even(3.0f);
  EXPECT_EQ(score_shadows({bright, brighter}, {truth, whole})->relative_rms, 0.0);
}

TEST(ShadowScore, BrighterLampsChangeNothing) {
  const Picture truth = edge_at(20), whole = even(2.0f), off = edge_at(17);
  const Picture truth_1000 = edge_at(20, 2000.0f), whole_1000 = even(2000.0f), off_1000 = edge_at(17, 2000.0f);
  EXPECT_NEAR(score_shadows({off_1000, whole_1000}, {truth_1000, whole_1000})->relative_rms,
              score_shadows({off, whole}, {truth, whole})->relative_rms, 1e-9);
}

// Next to a lamp, light is a million times that of the room.
TEST(ShadowScore, APixelNextToALampWeighsNoMoreThanAnother) {
  const auto room = [](std::uint32_t lit_from) {
    return columns([=](std::uint32_t x) { return x < lit_from ? 0.0f : x == 30 ? 1e6f : 1.0f; });
  };
  const Picture whole = room(0), truth = room(40), near = room(30), far = room(31);
  const double with_near = score_shadows({near, whole}, {truth, whole})->relative_rms,
               without = score_shadows({far, whole}, {truth, whole})->relative_rms;
  EXPECT_NEAR(with_near, std::sqrt(10.0 / kWidth * 100.0), 1e-9);
  EXPECT_NEAR(without, std::sqrt(9.0 / kWidth * 100.0), 1e-9);
}

TEST(ShadowScore, WhatNoLightReachesIsNotJudged) {
  const Picture whole = edge_at(32), truth = edge_at(40), off = edge_at(48);
  EXPECT_DOUBLE_EQ(score_shadows({off, whole}, {truth, whole})->falsely_dark, 8.0 / 32.0);
}

// Four samples are often half lit, but for rounding.
TEST(ShadowScore, RoundingMovesNoEdge) {
  const auto stairs = [](float half) {
    return columns([=](std::uint32_t x) { return x < 20 ? 0.0f : x < 30 ? half : x < 40 ? 0.25f : 1.0f; });
  };
  const Picture whole = even(1.0f);
  const std::optional<ShadowScore> score = score_shadows({stairs(0.5f - 1e-7f), whole}, {stairs(0.5f + 1e-7f), whole});
  EXPECT_EQ(score->edge_displacement, 0.0);
  const Picture truth = even(0.75f), off = even(0.5f - 1e-7f), near = even(0.5f + 1e-7f);
  EXPECT_EQ(score_shadows({off, whole}, {truth, whole})->falsely_dark,
            score_shadows({near, whole}, {truth, whole})->falsely_dark);
}

TEST(ShadowScore, PicturesWithoutDirectLightHaveNone) {
  const Picture none{kWidth, kHeight, {}}, whole = even(1.0f);
  EXPECT_FALSE(score_shadows({none, whole}, {whole, whole}));
}

TEST(ShadowScore, MapsShowTheTwoErrorsInTwoColours) {
  const Picture truth = edge_at(20), whole = even(2.0f), left = edge_at(10), right = edge_at(30);
  const Picture lit = false_shadow_map({left, whole}, {truth, whole}),
                dark = false_shadow_map({right, whole}, {truth, whole});
  const auto at = [](const Picture& map, std::size_t channel, std::size_t x) {
    return map.channels[channel].values[x];
  };
  EXPECT_GT(at(lit, 0, 15), at(lit, 2, 15) + 0.5f);   // orange
  EXPECT_GT(at(dark, 2, 25), at(dark, 0, 25) + 0.5f); // blue
  EXPECT_EQ(at(lit, 0, 40), at(lit, 2, 40));          // grey
}

} // namespace
} // namespace wavepath::test
