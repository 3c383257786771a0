// What a window compares shadows with: the truth is the bits of a traced render, goes on while the technique's settings
// change, and finds nothing false in itself; the split display shows both.
#include "host/render/progressive/shadow_comparison.h"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "host/picture/files/picture_io.h"
#include "host/render/progressive/display.h"
#include "tests/shadow_scene.h"

namespace wavepath::test {
namespace {

class ShadowComparisonTest : public ShadowTest {
protected:
  void SetUp() override {
    ShadowTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    scene_ = lit_by(spot());
    settings_ = shadow_settings("map", 32);
    settings_.width = 48, settings_.height = 36;
    settings_.last_sample = settings_.sample_total = 3;
    settings_.aovs = {"direct"};
    packed_ = pack(scene_, {.direct = direct_of(settings_)});
    view_ = resolve_view(scene_, {}, settings_.width, settings_.height);
  }
  Progressive begin() { return Progressive(device(), packed_, view_, settings_, shared_kernels(device())); }
  static void finish(ShadowComparison& comparison, const Progressive& shown) {
    while (!shown.is_done() || !comparison.is_done())
      if (!comparison.step()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  Picture rendered(const RenderPlan& settings) { return render(scene_, settings).picture; }
  RenderPlan traced() const {
    RenderPlan settings = settings_;
    settings.shadows = kShadowsTraced;
    return settings;
  }
  static void expect_same(const Picture& a, const Picture& b) {
    ASSERT_EQ(a.channels.size(), b.channels.size());
    for (std::size_t c = 0; c < a.channels.size(); ++c) EXPECT_EQ(a.channels[c].values, b.channels[c].values);
  }

  Scene scene_;
  PackedScene packed_;
  RenderPlan settings_;
  View view_;
};

TEST_F(ShadowComparisonTest, TruthIsTheTracedRenderAndJudgesTheTechnique) {
  Progressive shown = begin();
  ShadowComparison comparison(shown, kShadowsTraced);
  finish(comparison, shown);
  EXPECT_EQ(comparison.common_spp(), 3u);
  const Picture picture = rendered(settings_), truth = rendered(traced());
  expect_same(shown.picture(), picture);
  expect_same(comparison.truth().picture(), truth);

  // A map of 32 texels is coarse enough for both errors; by the study's own measure.
  RenderPlan unshadowed = settings_;
  unshadowed.shadow_ambient = 1.0;
  const Picture light = rendered(unshadowed);
  const auto expected = score_shadows({picture, light}, {truth, light});
  const ShadowVerdict verdict = comparison.judge();
  ASSERT_TRUE(verdict.score && expected);
  EXPECT_GT(verdict.score->falsely_lit, 0.0);
  EXPECT_GT(verdict.score->falsely_dark, 0.0);
  EXPECT_DOUBLE_EQ(verdict.score->falsely_lit, expected->falsely_lit);
  EXPECT_DOUBLE_EQ(verdict.score->falsely_dark, expected->falsely_dark);
  EXPECT_DOUBLE_EQ(verdict.score->relative_rms, expected->relative_rms);
}

TEST_F(ShadowComparisonTest, FindsNothingFalseInItself) {
  settings_.shadows = kShadowsTraced;
  Progressive shown = begin();
  ShadowComparison comparison(shown, kShadowsTraced);
  finish(comparison, shown);
  const ShadowVerdict verdict = comparison.judge();
  ASSERT_TRUE(verdict.score);
  EXPECT_EQ(verdict.score->relative_rms, 0.0);
  EXPECT_EQ(verdict.score->falsely_lit + verdict.score->falsely_dark, 0.0);
  ASSERT_EQ(verdict.map.channels.size(), 3u);
  EXPECT_EQ(verdict.map.channels[0].values, verdict.map.channels[1].values); // grey
  EXPECT_EQ(verdict.map.channels[0].values, verdict.map.channels[2].values);
  EXPECT_GT(*std::ranges::max_element(verdict.map.channels[0].values), 0.5f);
}

TEST_F(ShadowComparisonTest, TruthGoesOnWhileTheTechniqueChanges) {
  Progressive shown = begin();
  ShadowComparison comparison(shown, kShadowsTraced);
  finish(comparison, shown);
  settings_.shadow_size = 256;
  settings_.shadows = index_of(kShadowTechniques.names(), "pcf");
  shown.set_settings(settings_, view_);
  comparison.follow(view_);
  EXPECT_EQ(shown.spp(), 0u);
  EXPECT_EQ(comparison.truth().spp(), 3u);
  finish(comparison, shown);
  expect_same(shown.picture(), rendered(settings_));

  settings_.seed = 7; // which is the truth's too
  shown.set_settings(settings_, view_);
  comparison.follow(view_);
  EXPECT_EQ(comparison.truth().spp(), 0u);
  finish(comparison, shown);
  expect_same(comparison.truth().picture(), rendered(traced()));
}

TEST_F(ShadowComparisonTest, RefusesATechniqueWithoutALight) {
  Progressive shown = begin();
  EXPECT_THROW(ShadowComparison(shown, index_of(kShadowTechniques.names(), "cascades")), Error); // there is no sun
}

TEST_F(ShadowComparisonTest, DisplayAndFilesAreSplitAtOneColumn) {
  Progressive shown = begin();
  ShadowComparison comparison(shown, kShadowsTraced);
  finish(comparison, shown);
  Display display(device());
  const auto words = [&] {
    return download<std::uint32_t>(display.pixels(), std::size_t{settings_.width} * settings_.height);
  };
  display.draw(comparison.truth(), {});
  const std::vector<std::uint32_t> right = words();
  display.draw(shown, {});
  const std::vector<std::uint32_t> left = words();
  ASSERT_NE(left, right);
  for (const double at : {0.0, 0.4, 1.0}) {
    display.draw(shown, {});
    const std::uint32_t first = split_column(at, settings_.width);
    display.draw(comparison.truth(), {}, first);
    const Picture ours = shown.picture(), truth = comparison.truth().picture(), file = split_picture(ours, truth, at);
    const std::vector<std::uint32_t> both = words();
    for (std::size_t i = 0; i < both.size(); ++i) {
      const bool is_right = i % settings_.width >= first;
      ASSERT_EQ(both[i], (is_right ? right : left)[i]) << i;
      ASSERT_EQ(file.channels[1].values[i], (is_right ? truth : ours).channels[1].values[i]);
    }
  }
}

TEST_F(ShadowComparisonTest, DisplayShowsThePictureThatItIsGiven) {
  Progressive shown = begin();
  while (!shown.is_done())
    if (!shown.step()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  Display display(device());
  display.draw(shown, {});
  Picture picture{settings_.width, settings_.height, {}};
  const std::size_t pixels = std::size_t{settings_.width} * settings_.height;
  for (const float value : {2.0f, 0.214f, 0.0f}) picture.channels.push_back({"", std::vector<float>(pixels, value)});
  display.show(picture, false);
  EXPECT_EQ(download<std::uint32_t>(display.pixels(), pixels), std::vector<std::uint32_t>(pixels, 0xff007fffu));
  display.show(picture, true);
  EXPECT_EQ(download<std::uint32_t>(display.pixels(), pixels), std::vector<std::uint32_t>(pixels, 0xffff7f00u));
}

} // namespace
} // namespace wavepath::test
