// Shadow maps: what they converge to, what a filter of no size is, how wide a soft shadow's edge is, what is refused.
#include "tests/shadow_scene.h"

#include <numeric>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/shadows/catalogue.h"
#include "host/integrators/hybrid/shadows/sources.h"
#include "host/render/settings/settings_table.h"

namespace wavepath::test {
namespace {

TEST_F(ShadowTest, MapsConvergeToTracedShadows) {
  for (const auto& [name, scene] :
       {std::pair{"sun", lit_by(sun())}, {"spot", lit_by(spot())}, {"lamp", lit_by(lamp())}}) {
    SCOPED_TRACE(name);
    const std::vector<float> truth = light(scene, shadow_settings("traced"));
    const FalseFractions coarse = false_fractions(truth, light(scene, shadow_settings("map", 16))),
                         fine = false_fractions(truth, light(scene, shadow_settings("map", 2048)));
    EXPECT_GT(coarse.total(), 0.015);               // or there would be nothing to converge
    EXPECT_LT(fine.total(), 0.05 * coarse.total()); // 128 times as fine
  }
}

TEST_F(ShadowTest, RasterizedMapsAreTracedMaps) {
  for (const auto& [name, scene] :
       {std::pair{"sun", lit_by(sun())}, {"spot", lit_by(spot())}, {"lamp", lit_by(lamp())}}) {
    SCOPED_TRACE(name);
    RenderPlan raster = shadow_settings("map", 512), traced = raster;
    traced.shadow_source = kShadowSourceTraced;
    // Rasterizers snap corners to a grid of at best 1/256 texel, so that a few texels at edges differ.
    EXPECT_LT(false_fractions(light(scene, traced), light(scene, raster)).total(), 0.002);
  }
}

TEST_F(ShadowTest, UnbiasedMapsHaveAcneAndBiasEndsIt) {
  const Scene scene = lit_by(sun());
  const std::vector<float> truth = light(scene, shadow_settings("traced"));
  RenderPlan settings = shadow_settings("map", 256);
  settings.shadow_bias = gpu::kBiasConstant;
  settings.shadow_bias_amount = 0.0;
  EXPECT_GT(false_fractions(truth, light(scene, settings)).dark, 0.1);
  for (const std::string_view kind : {"slope", "normal", "plane", "cone", "second-depth", "midpoint"}) {
    SCOPED_TRACE(kind);
    settings.shadow_bias = index_of(kShadowBiasNames, kind);
    settings.shadow_bias_amount.reset();
    EXPECT_LT(false_fractions(truth, light(scene, settings)).dark, 0.01);
  }
}

// A sheet has no back that is drawn in its place, but something behind it.
TEST_F(ShadowTest, MidpointsNeedNoClosedBodies) {
  Scene scene = lit_by(sun());
  scene.meshes.clear();
  scene.instances.clear();
  std::vector<glm::vec3> corners = rectangle({0, 0, 0}, {0, 0, 2}, {2, 0, 0});
  for (const glm::vec3& p : rectangle({0, 0.5f, 0}, {0, 0, 0.5f}, {0.5f, 0, 0})) corners.push_back(p);
  add_instance(scene, add_mesh(scene, corners));
  const std::vector<float> truth = light(scene, shadow_settings("traced"));
  RenderPlan settings = shadow_settings("map", 512);
  settings.shadow_bias = gpu::kBiasSecondDepth;
  EXPECT_GT(false_fractions(truth, light(scene, settings)).lit, 0.02);
  settings.shadow_bias = gpu::kBiasMidpoint;
  EXPECT_LT(false_fractions(truth, light(scene, settings)).total(), 0.005);
}

TEST_F(ShadowTest, BiasBySurfacesBehindIsForRasterizedMaps) {
  for (const std::string_view kind : {"second-depth", "midpoint"}) {
    RenderPlan settings = shadow_settings("map", 64);
    settings.shadow_bias = index_of(kShadowBiasNames, kind);
    EXPECT_NO_THROW(kHybrid.check(settings));
    settings.shadow_source = kShadowSourceTraced;
    EXPECT_THROW(kHybrid.check(settings), UsageError);
  }
  RenderPlan settings = shadow_settings("virtual", 64);
  settings.shadow_bias = gpu::kBiasMidpoint;
  EXPECT_THROW(kHybrid.check(settings), UsageError);
}

// Convex bodies do not shade themselves, whatever the bias would have to be.
TEST_F(ShadowTest, MapsOfTrianglesNeedNoBias) {
  for (const auto& [name, scene] : {std::pair{"sun", lit_by(sun())}, {"spot", lit_by(spot())}}) {
    SCOPED_TRACE(name);
    const std::vector<float> truth = light(scene, shadow_settings("traced"));
    RenderPlan unbiased = shadow_settings("map", 256);
    unbiased.shadow_bias = gpu::kBiasConstant;
    unbiased.shadow_bias_amount = 0.0;
    EXPECT_GT(false_fractions(truth, light(scene, unbiased)).dark, 0.05);
    EXPECT_LT(false_fractions(truth, light(scene, shadow_settings("map-id", 256))).total(), 0.01);
    EXPECT_LT(false_fractions(truth, light(scene, shadow_settings("map-id", 2048))).total(), 0.002);
  }
}

// A wall and a floor of one mesh: where their triangles share corners, what should be dark is lit.
TEST_F(ShadowTest, MapsOfTrianglesLeakAlongSharedEdges) {
  Scene scene = lit_by(sun({0.1, -1.0, 0.6}));
  scene.meshes.clear();
  scene.instances.clear();
  std::vector<glm::vec3> corner = rectangle({0, 0, 0}, {0, 0, 1}, {1, 0, 0}); // a floor, z from -1 to 1
  for (const glm::vec3& p : rectangle({0, 0.5f, -1}, {1, 0, 0}, {0, 0.5f, 0})) corner.push_back(p);
  scene.materials[0].double_sided = true;
  add_instance(scene, add_mesh(scene, corner));
  const std::vector<float> truth = light(scene, shadow_settings("traced"));
  EXPECT_LT(false_fractions(truth, light(scene, shadow_settings("map", 1024))).lit, 0.005);
  EXPECT_GT(false_fractions(truth, light(scene, shadow_settings("map-id", 1024))).lit, 0.02);
}

TEST_F(ShadowTest, AFilterOfNoSizeIsTheMap) {
  const Scene scene = lit_by(spot());
  RenderPlan filtered = shadow_settings("pcf", 128);
  filtered.shadow_blur = 0.0;
  EXPECT_EQ(light(scene, filtered), light(scene, shadow_settings("map", 128)));
}

// With a tap for every texel, the filter is the mean of the maps' answers around a place.
TEST_F(ShadowTest, AFilterIsTheMeanOfComparisons) {
  const Scene scene = lit_by(sun());
  RenderPlan few = shadow_settings("pcf", 256), many = few;
  few.shadow_blur = many.shadow_blur = 3.0;
  few.shadow_taps = 36, many.shadow_taps = 1024;
  const std::vector<float> a = light(scene, few), b = light(scene, many),
                           hard = light(scene, shadow_settings("map", 256));
  double difference = 0.0, soft = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference += std::abs(a[i] - b[i]);
    soft += std::abs(b[i] - hard[i]);
  }
  EXPECT_GT(soft, 10.0 * difference / 3.0);
  EXPECT_GT(difference, 0.0);
}

TEST_F(ShadowTest, PatternsAgreeOnAverage) {
  const Scene scene = lit_by(spot());
  std::vector<double> means;
  for (std::uint32_t pattern = 0; pattern < kShadowPatternNames.size(); ++pattern) {
    RenderPlan settings = shadow_settings("pcf", 256);
    settings.shadow_pattern = pattern;
    settings.shadow_taps = 64;
    const std::vector<float> picture = light(scene, settings);
    means.push_back(std::accumulate(picture.begin(), picture.end(), 0.0));
  }
  for (const double mean : means) EXPECT_NEAR(mean / means.front(), 1.0, 0.005);
}

// Fernando's estimate is exact for an edge parallel to the lamp: light * (receiver - blocker) / blocker.
TEST_F(ShadowTest, SoftEdgesAreAsWideAsTheLampMakesThem) {
  constexpr float kHalf = 0.2f, kHeight = 2.0f, kBlocker = 1.0f;
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  add_instance(scene, add_mesh(scene, rectangle({0, 0, 0}, {0, 0, 4}, {4, 0, 0})));
  add_instance(scene, add_mesh(scene, rectangle({-2.0f, kBlocker, 0}, {0, 0, 4}, {2, 0, 0}))); // its edge at x = 0
  Material emitter = plain_material();
  emitter.emission = glm::vec3(30.0f);
  emitter.double_sided = false;
  scene.materials.push_back(emitter);
  add_instance(scene, add_mesh(scene, rectangle({0, kHeight, 0}, {kHalf, 0, 0}, {0, 0, kHalf}), 1));
  Camera camera; // along the floor's middle, from below the blocker's height so that it sees the shadow's edge
  camera.orthographic = true;
  camera.xmag = 0.6, camera.ymag = 0.01; // the picture's width follows from its height
  camera.world_from_camera = {{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 0.5, 0, 1}};
  scene.cameras.push_back(camera);
  RenderPlan settings = shadow_settings("pcss", 1024);
  settings.width = 240, settings.height = 4;
  settings.shadow_taps = 400;
  const std::vector<float> soft = light(scene, settings);
  settings.shadow_ambient = 1.0;
  const std::vector<float> unshadowed = light(scene, settings);
  // Width of the edge in metres, from 10 % to 90 % of the light without a blocker: of a square grid of taps 0.8 of the
  // whole.
  std::size_t first = 0, last = 0;
  for (std::size_t x = 0; x < 240; ++x) {
    if (soft[x] < 0.1f * unshadowed[x]) first = x;
    if (soft[x] < 0.9f * unshadowed[x]) last = x;
  }
  const double metres = static_cast<double>(last - first) * 1.2 / 240.0;
  const double whole = 2.0 * kHalf * (kHeight - kBlocker) / kBlocker;
  EXPECT_NEAR(metres, 0.8 * whole, 0.05 * whole);
}

TEST_F(ShadowTest, LightInShadowIsAFractionOfTheLight) {
  const Scene scene = lit_by(sun());
  RenderPlan settings = shadow_settings("map");
  const std::vector<float> dark = light(scene, settings);
  settings.shadow_ambient = 0.4;
  const std::vector<float> bright = light(scene, settings);
  settings.shadow_ambient = 1.0;
  const std::vector<float> whole = light(scene, settings);
  for (std::size_t i = 0; i < dark.size(); ++i)
    EXPECT_NEAR(bright[i], dark[i] > 0.0f ? dark[i] : 0.4f * whole[i], 1e-5f * whole[i]) << i;
}

// A technique that covers one of two lights answers for that one; the other's rays are traced as without it.
TEST_F(ShadowTest, LightsThatATechniqueDoesNotCoverAreTraced) {
  Scene scene = lit_by_square();
  scene.lights.push_back(sun());
  RenderPlan traced = shadow_settings("traced"), soft = shadow_settings("pcss");
  traced.last_sample = soft.last_sample = 24;
  const std::vector<float> a = light(scene, traced), b = light(scene, soft);
  std::size_t far_apart = 0;
  for (std::size_t i = 0; i < a.size(); ++i) far_apart += std::abs(a[i] - b[i]) > 0.15f * (a[i] + 0.1f);
  EXPECT_LT(far_apart, a.size() / 12);
}

TEST_F(ShadowTest, SameBitsHoweverTheWorkIsCut) {
  const Scene scene = lit_by(spot());
  RenderPlan settings = shadow_settings("pcf", 256);
  settings.shadow_pattern = gpu::kPatternVogel;
  settings.last_sample = 3;
  const std::vector<float> whole = light(scene, settings);
  settings.wave_slots = 1024;
  EXPECT_EQ(light(scene, settings), whole);
}

TEST_F(ShadowTest, TracingBuildsNothing) {
  const auto has_stage = [](const RenderResult& result, const std::string& name) {
    return std::ranges::count(result.stages, name, &StageTime::name) > 0;
  };
  const RenderResult traced = render(lit_by(sun()), shadow_settings("traced")),
                     map = render(lit_by(sun()), shadow_settings("map", 256));
  EXPECT_FALSE(has_stage(traced, "shadow build"));
  EXPECT_FALSE(has_stage(traced, "shadow look-up"));
  EXPECT_FALSE(traced.shadows);
  EXPECT_TRUE(has_stage(map, "shadow build"));
  EXPECT_TRUE(has_stage(map, "shadow look-up"));
  ASSERT_TRUE(map.shadows);
  EXPECT_EQ(map.shadows->views, 1u);
  EXPECT_GE(map.shadows->bytes, 2u * 256 * 256 * 4);
  EXPECT_GE(map.memory.paths, traced.memory.paths + map.shadows->bytes);
}

TEST_F(ShadowTest, RefusesScenesWithoutItsKindOfLight) {
  EXPECT_THROW(render(lit_by(sun()), shadow_settings("pcss")), Error);
  EXPECT_THROW(render(bodies(), shadow_settings("map")), Error);
}

TEST_F(ShadowTest, RefusesMapsThatDoNotFit) {
  // Six views of 16384 x 16384 texels are 6 GiB: more than any buffer of texels here holds.
  try {
    render(lit_by(lamp()), shadow_settings("map", 16384));
    FAIL() << "it fitted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("--shadow-size"), std::string::npos) << error.what();
  }
}

TEST(ShadowSettings, EveryNameHasATechniqueAndItsSettingsAloneHaveAnEffect) {
  expect_names_of_own(kShadowTechniques);
  RenderPlan settings = shadow_settings("map");
  EXPECT_NO_THROW(check_shadow_settings(settings));
  settings.shadow_taps = 9; // of filters
  EXPECT_THROW(check_shadow_settings(settings), UsageError);
  settings = shadow_settings("traced", 512); // which has no map
  EXPECT_THROW(check_shadow_settings(settings), UsageError);
  settings = shadow_settings("map");
  settings.direct = gpu::kDirectBsdf;
  EXPECT_THROW(check_shadow_settings(settings), UsageError);
}

TEST(ShadowSources, RectanglesDiscsAndSpheresAreFoundAmongTriangles) {
  Scene scene = lit_by_square();
  const auto add = [&](const std::vector<glm::vec3>& corners) { add_instance(scene, add_mesh(scene, corners, 1)); };
  std::vector<glm::vec3> disc;
  for (int i = 0; i < 24; ++i) {
    const auto at = [](int k) {
      return glm::vec3(1.0f + 0.5f * std::cos(0.2617994f * k), 3.0f, 0.5f * std::sin(0.2617994f * k));
    };
    for (const glm::vec3& p : {glm::vec3(1.0f, 3.0f, 0.0f), at(i), at(i + 1 == 24 ? 0 : i + 1)}) disc.push_back(p);
  }
  add(disc);
  add(ball({-2, 1, 0}, 0.25f));
  add({{3, 3, 0}, {4, 3, 0}, {3, 3, 1}}); // a triangle is none
  const PackedScene packed = pack(scene, {.direct = gpu::kDirectNee});
  const std::vector<ShadowSource> sources = find_sources(packed);
  EXPECT_EQ(names_of(sources), "1 rectangle, 1 disc, 1 sphere");
  EXPECT_EQ(count_lights(packed), 4u);
  for (const ShadowSource& source : sources) {
    if (source.kind == kSphereSource) {
      EXPECT_LT(glm::distance(source.position + packed.origin, glm::dvec3(-2, 1, 0)), 1e-6);
      EXPECT_NEAR(glm::length(source.u), 0.25, 1e-6);
      EXPECT_EQ(source.lights.size(), ball({}, 1.0f).size() / 3);
      continue;
    }
    EXPECT_NEAR(std::abs(source.direction.y), 1.0, 1e-6);
    EXPECT_NEAR(glm::length(source.u), source.kind == kDiscSource ? 0.5 : 0.25, 1e-5);
    EXPECT_EQ(source.lights.size(), source.kind == kDiscSource ? 24u : 2u);
  }
}

// All corners of a box lie on a sphere; half a ball is open; neither is one.
TEST(ShadowSources, BodiesThatAreNoSphereAreNone) {
  const auto sources_of = [](Scene scene) { return names_of(find_sources(pack(scene, {.direct = gpu::kDirectNee}))); };
  EXPECT_EQ(sources_of(lit_by_lamp(box({0, 2, 0}, {0.1f, 0.1f, 0.1f}))), "6 rectangles");
  std::vector<glm::vec3> half = ball({0, 2, 0}, 0.2f);
  half.resize(half.size() / 2);
  EXPECT_EQ(sources_of(lit_by_lamp(half)), "nothing");
}

} // namespace
} // namespace wavepath::test
