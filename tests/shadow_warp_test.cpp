// Warped maps of suns: what they converge to, where their texels are finer than the map's, and where they gain nothing.
#include "tests/long_scene.h"

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/shadows/warped_views.h"

namespace wavepath::test {
namespace {

constexpr std::string_view kWarps[] = {"lispsm", "tsm", "psm"};

// Suns from the side, from behind the camera, from ahead, and from straight above.
const glm::dvec3 kSuns[] = {{0.6, -1.0, -0.1}, {0.1, -1.0, -1.2}, {0.15, -1.0, 0.9}, {0.0, -1.0, 0.0}};

TEST_F(ShadowTest, WarpedMapsConvergeToTracedShadows) {
  for (const glm::dvec3& direction : kSuns) {
    const Scene scene = long_rows(sun(direction));
    const std::vector<float> truth = light(scene, long_settings("traced"));
    for (const std::string_view technique : kWarps) {
      SCOPED_TRACE(technique);
      SCOPED_TRACE(direction.z);
      const double coarse = false_fractions(truth, light(scene, long_settings(technique, 64))).total(),
                   fine = false_fractions(truth, light(scene, long_settings(technique, 2048))).total();
      EXPECT_LT(fine, std::max(0.25 * coarse, 0.0005)); // with a sun straight above there is little to converge
      EXPECT_LT(fine, 0.002);
    }
  }
}

TEST_F(ShadowTest, WarpedMapsMendWhatIsNear) {
  const Scene scene = long_rows(sun());
  const std::vector<float> truth = light(scene, long_settings("traced"));
  const double map = false_fractions(truth, light(scene, long_settings("map", 256))).total();
  for (const std::string_view technique : kWarps) {
    const double warped = false_fractions(truth, light(scene, long_settings(technique, 256))).total();
    EXPECT_LT(warped, 0.7 * map) << technique;
  }
}

TEST_F(ShadowTest, RasterizedWarpedMapsAreTracedOnes) {
  const Scene scene = long_rows(sun());
  for (const std::string_view technique : kWarps) {
    RenderPlan raster = long_settings(technique, 256), traced = raster;
    traced.shadow_source = kShadowSourceTraced;
    EXPECT_LT(false_fractions(light(scene, traced), light(scene, raster)).total(), 0.004) << technique;
  }
}

TEST_F(ShadowTest, EveryBiasEndsAcneOfWarpedMaps) {
  const Scene scene = long_rows(sun());
  const std::vector<float> truth = light(scene, long_settings("traced"));
  for (const std::string_view technique : kWarps)
    for (const std::string_view kind : {"slope", "normal", "plane", "cone", "second-depth", "midpoint"}) {
      RenderPlan settings = long_settings(technique, 256);
      settings.shadow_bias = index_of(kShadowBiasNames, kind);
      const FalseFractions fractions = false_fractions(truth, light(scene, settings));
      EXPECT_LT(fractions.dark, 0.03) << technique << " " << kind;
    }
}

gpu::ShadowView warped(std::string_view technique, const LongFit& of, const glm::dvec3& direction) {
  if (technique == "tsm") return trapezoidal_view(of.fit, direction, of.view);
  if (technique == "psm") return camera_space_view(of.fit, direction, of.view);
  return light_space_perspective_view(of.fit, direction, of.view, std::nullopt);
}

TEST(WarpedViews, ShowAllReceiversAndFallWithDepth) {
  const LongFit of = long_fit(512);
  for (const std::string_view technique : kWarps)
    for (const glm::dvec3& toward : kSuns) {
      SCOPED_TRACE(technique);
      SCOPED_TRACE(toward.z);
      const glm::dvec3 direction = glm::normalize(toward);
      const gpu::ShadowView view = warped(technique, of, direction);
      for (const glm::dvec3& p : of.fit.receivers) {
        const glm::dvec4 q(p, 1.0);
        const double w = glm::dot(glm::dvec4(view.w), q), depth = glm::dot(glm::dvec4(view.depth), q);
        EXPECT_GT(w, 0.0);
        EXPECT_LE(std::abs(glm::dot(glm::dvec4(view.x), q)), w);
        EXPECT_LE(std::abs(glm::dot(glm::dvec4(view.y), q)), w);
        // Along the light, from the near end on.
        double last = 1.0;
        for (int i = 0; i <= 4; ++i) {
          const glm::dvec4 r(p - (1.0 - 0.25 * i) * depth * direction, 1.0);
          EXPECT_NEAR(glm::dot(glm::dvec4(view.w), r), w, 1e-5);
          const double z = glm::dot(glm::dvec4(view.z), r) / glm::dot(glm::dvec4(view.w), r);
          EXPECT_GE(z, -1e-6);
          EXPECT_LT(z, last);
          last = z;
        }
      }
    }
}

TEST(WarpedViews, TexelsAreFinerNearTheCameraAndCoarserFarAway) {
  const LongFit of = long_fit(512);
  const glm::dvec3 direction = sun().direction, near(0, 0, -1), far(0, 0, -55);
  const gpu::ShadowView map = parallel_view(of.fit, direction);
  for (const std::string_view technique : kWarps) {
    const gpu::ShadowView view = warped(technique, of, direction);
    EXPECT_LT(texel_at(view, 512, near), 0.5 * texel_at(map, 512, near)) << technique;
    EXPECT_GT(texel_at(view, 512, far), texel_at(map, 512, far)) << technique;
  }
}

// Where the camera's axis lies in a plane with the light and the vertical, both views stand upright.
TEST(WarpedViews, AnEyeFarAwaySeesTheMap) {
  const LongFit of = long_fit(512);
  const glm::dvec3 direction = glm::normalize(glm::dvec3(0, -1, -0.4));
  const gpu::ShadowView map = parallel_view(of.fit, direction),
                        view = light_space_perspective_view(of.fit, direction, of.view, 1e9);
  for (const glm::dvec3& p : of.fit.receivers) {
    const glm::dvec4 q(p, 1.0);
    EXPECT_NEAR(glm::dot(glm::dvec4(view.x), q), glm::dot(glm::dvec4(map.x), q), 2e-3);
    EXPECT_NEAR(glm::dot(glm::dvec4(view.y), q), glm::dot(glm::dvec4(map.y), q), 2e-3);
    EXPECT_NEAR(glm::dot(glm::dvec4(view.w), q), 1.0, 1e-6);
  }
}

TEST_F(ShadowTest, AnEyeFarAwayLooksUpAsTheMap) {
  const Scene scene = long_rows(sun({0, -1, -0.4}));
  const std::vector<float> map = light(scene, long_settings("map", 128));
  const auto unlike_at = [&](double distance) {
    RenderPlan settings = long_settings("lispsm", 128);
    settings.shadow_exponent = distance;
    return false_fractions(map, light(scene, settings)).total();
  };
  EXPECT_LT(unlike_at(88.0), 0.1 * unlike_at(1.0));
}

// What perspective shadow maps are known for: next to nothing is left for what is far away.
TEST(WarpedViews, CameraSpaceForgetsWhatIsFar) {
  const LongFit of = long_fit(512);
  const glm::dvec3 far(0, 0, -55);
  EXPECT_GT(texel_at(warped("psm", of, sun().direction), 512, far),
            4.0 * texel_at(warped("lispsm", of, sun().direction), 512, far));
}

// "Duelling frusta": a light that shines along the camera's axis leaves nothing to warp; and near to that, views change
// by a leap where a technique gives up.
TEST(WarpedViews, AreMapsWhereTheLightShinesAlongTheCamera) {
  const LongFit of = long_fit(512);
  for (const double sign : {1.0, -1.0})
    for (const std::string_view technique : {"lispsm", "tsm"}) {
      const gpu::ShadowView map = parallel_view(of.fit, sign * of.view.forward),
                            view = warped(technique, of, sign * of.view.forward);
      EXPECT_EQ(view.x, map.x);
      EXPECT_EQ(view.w, map.w);
    }
}

TEST_F(ShadowTest, WarpedMapsAreForSuns) {
  for (const std::string_view technique : kWarps)
    EXPECT_THROW(render(lit_by(lamp()), long_settings(technique, 64)), Error);
}

} // namespace
} // namespace wavepath::test
