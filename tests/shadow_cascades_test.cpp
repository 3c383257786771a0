// Cascades: one is the map; more of them show what is near in finer texels. Those fitted to a frame's points know its
// bounds exactly.
#include "tests/long_scene.h"

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/shadows/cascade_views.h"
#include "host/integrators/hybrid/shadows/catalogue.h"

namespace wavepath::test {
namespace {

RenderPlan cascades(std::string_view technique, std::uint32_t count, std::uint32_t size) {
  RenderPlan settings = long_settings(technique, size);
  settings.shadow_cascades = count;
  return settings;
}

TEST_F(ShadowTest, OneCascadeIsTheMap) {
  for (const Scene& scene : {lit_by(sun()), long_rows(sun())})
    EXPECT_EQ(light(scene, cascades("cascades", 1, 256)), light(scene, long_settings("map", 256)));
}

TEST_F(ShadowTest, CascadesMendWhatIsNear) {
  const Scene scene = long_rows(sun());
  const std::vector<float> truth = light(scene, long_settings("traced"));
  for (const std::string_view technique : {"cascades", "sdsm"}) {
    SCOPED_TRACE(technique);
    double last = false_fractions(truth, light(scene, long_settings("map", 128))).total();
    for (const std::uint32_t count : {2u, 4u, 8u}) {
      const double errors = false_fractions(truth, light(scene, cascades(technique, count, 128))).total();
      EXPECT_LT(errors, last) << count;
      last = errors;
    }
  }
}

TEST_F(ShadowTest, CascadesConvergeToTracedShadows) {
  const Scene scene = long_rows(sun());
  const std::vector<float> truth = light(scene, long_settings("traced"));
  for (const std::string_view technique : {"cascades", "sdsm"}) {
    SCOPED_TRACE(technique);
    const double coarse = false_fractions(truth, light(scene, cascades(technique, 4, 64))).total(),
                 fine = false_fractions(truth, light(scene, cascades(technique, 4, 2048))).total();
    EXPECT_LT(fine, 0.2 * coarse);
    EXPECT_LT(fine, 0.006);
  }
}

TEST(CascadeViews, SplitsLieBetweenEqualAndProportionalParts) {
  const std::vector<double> depths = split_depths(1.0, 100.0, 2);
  ASSERT_EQ(depths.size(), 3u);
  EXPECT_DOUBLE_EQ(depths[1], 0.5 * (10.0 + 50.5));
  EXPECT_EQ(split_depths(2.0, 9.0, 1), (std::vector<double>{2.0, 9.0}));
  EXPECT_GT(split_depths(0.0, 10.0, 4)[1], 1.0); // of a range from 0 on
}

// The seams that cascades are known for: texels become wider from one to the next by leaps.
TEST(CascadeViews, TexelsGrowWithDistanceByLeaps) {
  const LongFit of = long_fit(512);
  const glm::dvec3 direction = sun().direction;
  const std::vector<gpu::ShadowView> views = cascade_views(of.fit, direction, of.view, 4);
  ASSERT_EQ(views.size(), 4u);
  EXPECT_LT(views.front().texel, 0.3f * parallel_view(of.fit, direction).texel);
  for (std::size_t i = 1; i < views.size(); ++i) EXPECT_GT(views[i].texel, 1.3f * views[i - 1].texel) << i;
}

TEST(CascadeViews, TogetherTheyShowAllReceivers) {
  const LongFit of = long_fit(512);
  const std::vector<gpu::ShadowView> views = cascade_views(of.fit, sun().direction, of.view, 8);
  for (const glm::dvec3& a : of.fit.receivers)
    for (const glm::dvec3& b : of.fit.receivers)
      for (const double fraction : {0.0, 0.1, 0.35, 0.5}) {
        const glm::dvec4 p(glm::mix(a, b, fraction), 1.0);
        EXPECT_TRUE(std::ranges::any_of(views,
                                        [&](const gpu::ShadowView& view) {
                                          return std::abs(glm::dot(glm::dvec4(view.x), p)) <= 1.0 &&
                                                 std::abs(glm::dot(glm::dvec4(view.y), p)) <= 1.0 &&
                                                 glm::dot(glm::dvec4(view.depth), p) >= 0.0 &&
                                                 glm::dot(glm::dvec4(view.depth), p) <= view.far;
                                        }))
            << p.x << " " << p.y << " " << p.z;
      }
}

// The picture's own depths are the reference.
TEST_F(ShadowTest, BoundsAreTheFramesExactDepths) {
  for (const Scene& scene : {lit_by(sun()), long_rows(sun())}) {
    RenderPlan settings = cascades("sdsm", 4, 64);
    settings.aovs = {"depth"};
    const RenderResult result = render(scene, settings);
    float nearest = gpu::kFar, farthest = 0.0f;
    for (const Channel& channel : result.picture.channels)
      if (channel.name == "Z")
        for (const float depth : channel.values)
          if (depth < 1e9f) nearest = std::min(nearest, depth), farthest = std::max(farthest, depth);
    ASSERT_TRUE(result.shadows);
    EXPECT_EQ(result.shadows->nearest, nearest);
    EXPECT_EQ(result.shadows->farthest, farthest);
    EXPECT_GT(farthest, nearest);
  }
}

// What is planned from the scene's box alone is wasted where the camera sees little of it.
TEST_F(ShadowTest, FittedCascadesAreNotWastedOnWhatIsHidden) {
  Scene scene = lit_by(sun());
  add_instance(scene, add_mesh(scene, box({0, -60, 0}, {20, 1, 20}))); // below the floor
  const std::vector<float> truth = light(scene, shadow_settings("traced"));
  RenderPlan settings = shadow_settings("cascades", 128);
  const double planned = false_fractions(truth, light(scene, settings)).total();
  settings.shadows = index_of(kShadowTechniques.names(), "sdsm");
  const double fitted = false_fractions(truth, light(scene, settings)).total();
  EXPECT_LT(fitted, 0.5 * planned);
}

TEST_F(ShadowTest, FramesAreFittedOneByOne) {
  const Scene scene = long_rows(sun());
  RenderPlan settings = cascades("sdsm", 3, 128);
  settings.last_sample = 3;
  const std::vector<float> whole = light(scene, settings);
  settings.wave_slots = 1024;
  EXPECT_EQ(light(scene, settings), whole);
}

TEST_F(ShadowTest, EverySunHasItsCascades) {
  Scene scene = long_rows(sun());
  scene.lights.push_back(sun({-0.7, -1.0, 0.3}));
  const std::vector<float> truth = light(scene, long_settings("traced"));
  for (const std::string_view technique : {"cascades", "sdsm"}) {
    const RenderResult result = render(scene, cascades(technique, 3, 1024));
    EXPECT_EQ(result.shadows->views, 6u);
    EXPECT_LT(false_fractions(truth, result.picture.channels[1].values).total(), 0.003) << technique;
  }
}

TEST_F(ShadowTest, CascadesAreForSuns) {
  for (const std::string_view technique : {"cascades", "sdsm"})
    EXPECT_THROW(render(lit_by(lamp()), cascades(technique, 4, 64)), Error);
}

} // namespace
} // namespace wavepath::test
