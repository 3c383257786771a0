// Ambient occlusion from what the picture shows: against planes, pits and wedges whose occlusion is known, against rays
// where everything that occludes is seen, and where the techniques are known to be wrong.
#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/occlusion/catalogue.h"
#include "tests/shadow_scene.h"

namespace wavepath::test {
namespace {

constexpr double kPi = 3.14159265358979;

RenderPlan occlusion_settings(std::string_view technique, double radius = 100.0) {
  RenderPlan settings;
  settings.integrator = &kAo;
  settings.width = settings.height = 48;
  settings.last_sample = 4;
  settings.filter = gpu::kFilterBox;
  settings.ao_samples = 8;
  settings.ao_radius = radius;
  settings.occlusion = index_of(kOcclusionTechniques.names(), technique);
  return settings;
}

Scene made_of(const std::vector<std::vector<glm::vec3>>& meshes) {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  for (const std::vector<glm::vec3>& corners : meshes) add_instance(scene, add_mesh(scene, corners));
  return scene;
}

// A camera at `eye` that looks at `target`; orthographic with that half extent, in perspective without.
void look(Scene& scene, glm::dvec3 eye, glm::dvec3 target, double half = 0.0, glm::dvec3 above = {0, 1, 0}) {
  Camera camera;
  camera.orthographic = half > 0.0;
  camera.xmag = camera.ymag = half;
  const glm::dvec3 forward = glm::normalize(target - eye), right = glm::normalize(glm::cross(forward, above)),
                   up = glm::cross(right, forward);
  camera.world_from_camera = {glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(-forward, 0), glm::dvec4(eye, 1)};
  scene.cameras = {camera};
}

std::vector<glm::vec3> floor_of(float half) { return rectangle({0, 0, 0}, {0, 0, half}, {half, 0, 0}); }

// A box open at the top: a square of side 1 at y = 0, walls as high as `depth`, level ground around their rims.
std::vector<std::vector<glm::vec3>> pit(float depth) {
  std::vector<std::vector<glm::vec3>> meshes = {floor_of(0.5f)};
  for (const float side : {-1.0f, 1.0f}) {
    meshes.push_back(rectangle({0.5f * side, 0.5f * depth, 0}, {0, 0.5f * depth, 0}, {0, 0, 0.5f}));
    meshes.push_back(rectangle({0, 0.5f * depth, 0.5f * side}, {0, 0.5f * depth, 0}, {0.5f, 0, 0}));
    meshes.push_back(rectangle({side, depth, 0}, {0, 0, 0.5f}, {0.5f, 0, 0}));
    meshes.push_back(rectangle({0, depth, side}, {0, 0, 0.5f}, {1.5f, 0, 0}));
  }
  return meshes;
}

// Fraction of the cosine-weighted hemisphere over the middle of a square that a parallel one of side 1 takes, `depth`
// above (the form factor of a parallel rectangle, four times that of its corner).
double opening(double depth) {
  const double x = 0.5 / depth, r = std::sqrt(1.0 + x * x);
  return 4.0 / (2.0 * kPi) * 2.0 * x / r * std::atan(x / r);
}

// What a wall takes of a point on the floor before its middle, at `distance`; as high as 1 and from -`half` to `half`
// (the form factor of a perpendicular rectangle).
double wall_fraction(double distance, double half) {
  const double slant = std::sqrt(distance * distance + 1.0);
  return (std::atan(half / distance) - distance / slant * std::atan(half / slant)) / kPi;
}

class OcclusionTest : public ShadowTest {
protected:
  static double mean_of(const std::vector<float>& picture) {
    return std::accumulate(picture.begin(), picture.end(), 0.0) / static_cast<double>(picture.size());
  }
  // The mean of the 4 x 4 pixels in the middle.
  static double middle_of(const std::vector<float>& picture, const RenderPlan& settings) {
    double sum = 0.0;
    for (std::uint32_t y = settings.height / 2 - 2; y < settings.height / 2 + 2; ++y)
      for (std::uint32_t x = settings.width / 2 - 2; x < settings.width / 2 + 2; ++x)
        sum += picture[y * settings.width + x];
    return sum / 16.0;
  }
  double in_the_middle(const Scene& scene, const RenderPlan& settings) {
    return middle_of(light(scene, settings), settings);
  }
};

TEST_F(OcclusionTest, APlaneIsOpen) {
  for (const double half : {0.0, 0.5}) { // in perspective, and without
    Scene scene = made_of({floor_of(50.0f)});
    look(scene, {0.3, 1.0, 1.5}, {0.1, 0.0, 0.0}, half);
    for (const char* technique : {"traced", "hbao", "gtao"})
      for (const float value : light(scene, occlusion_settings(technique, 0.5)))
        ASSERT_NEAR(value, 1.0f, 1e-3f) << technique << half;
  }
}

// Half of the ball is the plane's own: what Crytek's pictures are known for.
TEST_F(OcclusionTest, SsaoOfAPlaneIsGrey) {
  Scene scene = made_of({floor_of(50.0f)});
  look(scene, {0, 3, 0}, {0, 0, 0}, 0.0, {0, 0, -1});
  RenderPlan settings = occlusion_settings("ssao", 0.2);
  settings.ao_samples = 64;
  EXPECT_NEAR(in_the_middle(scene, settings), 0.5, 0.03); // of 16 * 256 points: 0.008 is one standard deviation
}

// A right angle that the camera looks into takes three quarters of the ball, one that points at the camera one quarter.
TEST_F(OcclusionTest, SsaoIsTheFractionOfTheBall) {
  const std::vector<glm::vec3> level = floor_of(5.0f), upright = rectangle({0, 0, 0}, {5, 0, 0}, {0, 5, 0});
  RenderPlan settings = occlusion_settings("ssao", 0.3);
  settings.ao_samples = 64;
  Scene valley = made_of({level, upright});
  look(valley, {0, 2, 2}, {0, 0, 0}, 0.5);
  // The pixels looked at are one pixel off the edge in the mean, which brings half a slab of the ball, 3/4 of the
  // offset in radii.
  const double slab = 0.5 * 0.75 * std::sqrt(2.0) / 48.0 / 0.3;
  EXPECT_NEAR(in_the_middle(valley, settings), 0.25 + slab, 0.02);
  Scene ridge = made_of({rectangle({0, 0, -5}, {0, 0, 5}, {5, 0, 0}), rectangle({0, -5, 0}, {5, 0, 0}, {0, 5, 0})});
  look(ridge, {0, 2, 2}, {0, 0, 0}, 0.5);
  EXPECT_NEAR(in_the_middle(ridge, settings), 0.75 - slab, 0.02);
}

// What is hidden by a body far in front of it is not darkened by that: it becomes brighter instead, as the body hides
// the surface around the point as well.
TEST_F(OcclusionTest, SsaoIgnoresWhatIsFartherThanItsRadius) {
  const std::vector<glm::vec3> ground = floor_of(50.0f), plate = rectangle({0, 1.5f, 0}, {0, 0, 0.3f}, {0.3f, 0, 0});
  Scene alone = made_of({ground}), hidden = made_of({ground, plate});
  for (Scene* scene : {&alone, &hidden}) look(*scene, {0, 3, 0}, {0, 0, 0}, 1.0, {0, 0, -1});
  const RenderPlan settings = occlusion_settings("ssao", 0.2);
  const std::vector<float> open = light(alone, settings), covered = light(hidden, settings);
  std::size_t brighter = 0;
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (std::abs(static_cast<int>(i % 48) - 24) < 9 && std::abs(static_cast<int>(i / 48) - 24) < 9)
      continue; // the plate
    EXPECT_GE(covered[i], open[i]) << i;
    brighter += covered[i] > open[i];
  }
  EXPECT_GT(brighter, 100u);
}

// A pit under a camera above it hides nothing, so that horizons are exact.
TEST_F(OcclusionTest, GtaoOfAPitIsItsFormFactor) {
  for (const float depth : {0.25f, 0.5f, 1.0f}) {
    Scene scene = made_of(pit(depth));
    look(scene, {0, 5, 0}, {0, 0, 0}, 0.75, {0, 0, -1});
    const double gtao = in_the_middle(scene, occlusion_settings("gtao")),
                 traced = in_the_middle(scene, occlusion_settings("traced"));
    EXPECT_NEAR(traced, opening(depth), 0.04) << depth;
    // Its 16 steps across 24 pixels are 2.5 pixels apart at the rim, so that it is found up to 15 % too far away.
    EXPECT_GT(gtao, opening(depth) - 0.01) << depth;
    EXPECT_LT(gtao, opening(depth / 1.15)) << depth;
    EXPECT_NEAR(gtao, opening(depth), 0.05) << depth;
  }
}

// By its own integral: the mean over all directions of the sine of the horizon less that of the bias.
TEST_F(OcclusionTest, HbaoOfAPitIsTheRiseOfItsHorizon) {
  constexpr float kDepth = 0.5f;
  Scene scene = made_of(pit(kDepth));
  look(scene, {0, 5, 0}, {0, 0, 0}, 0.75, {0, 0, -1});
  for (const double bias : {0.0, 20.0}) {
    RenderPlan settings = occlusion_settings("hbao");
    settings.ao_bias = bias;
    double sum = 0.0;
    constexpr int kDirections = 1000; // of an eighth
    for (int i = 0; i < kDirections; ++i) {
      const double distance = 0.5 / std::cos((i + 0.5) / kDirections * 0.25 * kPi);
      sum += kDepth / std::hypot(distance, kDepth) - std::sin(bias * kPi / 180.0);
    }
    EXPECT_NEAR(in_the_middle(scene, settings), 1.0 - sum / kDirections, 0.04) << bias;
  }
}

TEST_F(OcclusionTest, GtaoOfAWedgeIsItsFormFactor) {
  for (const float distance : {0.25f, 0.5f, 1.0f}) {
    Scene scene =
        made_of({rectangle({0, 0, 1}, {0, 0, 1}, {2, 0, 0}), rectangle({0, 0.5f, 0}, {2, 0, 0}, {0, 0.5f, 0})});
    look(scene, {0, 3, distance + 3}, {0, 0, distance}, 1.9);
    const double exact = 1.0 - wall_fraction(distance, 2.0);
    EXPECT_NEAR(in_the_middle(scene, occlusion_settings("traced")), exact, 0.04) << distance;
    EXPECT_NEAR(in_the_middle(scene, occlusion_settings("gtao")), exact, 0.04) << distance;
  }
}

// Bodies whose every side that matters is seen: from above, boxes are what their tops say.
TEST_F(OcclusionTest, GtaoIsNearestToRays) {
  Scene scene = made_of(
      {floor_of(4.0f), box({-0.4f, 0.3f, 0.1f}, {0.3f, 0.3f, 0.3f}), box({0.5f, 0.15f, -0.3f}, {0.35f, 0.15f, 0.35f})});
  look(scene, {0, 5, 0}, {0, 0, 0}, 1.2, {0, 0, -1});
  const auto error = [&](const char* technique) {
    const std::vector<float> rays = light(scene, occlusion_settings("traced", 1.5)),
                             ours = light(scene, occlusion_settings(technique, 1.5));
    double sum = 0.0;
    for (std::size_t i = 0; i < rays.size(); ++i) sum += std::abs(rays[i] - ours[i]);
    return sum / static_cast<double>(rays.size());
  };
  const double gtao = error("gtao"), hbao = error("hbao"), ssao = error("ssao");
  EXPECT_LT(gtao, 0.05); // of which 0.02 is noise of the rays
  EXPECT_LT(gtao, hbao);
  EXPECT_LT(hbao, ssao);
}

TEST_F(OcclusionTest, WhatThePictureDoesNotShowDoesNotOcclude) {
  Scene scene = made_of({floor_of(4.0f), rectangle({-0.7f, 1, 0}, {0, 0, 4}, {0, 1, 0})});
  look(scene, {0, 3, 0}, {0, 0, 0}, 0.6, {0, 0, -1}); // the wall stands beyond its left edge
  EXPECT_LT(in_the_middle(scene, occlusion_settings("traced", 5.0)), 0.85);
  for (const char* technique : {"hbao", "gtao"})
    for (const float value : light(scene, occlusion_settings(technique, 5.0))) ASSERT_NEAR(value, 1.0f, 1e-3f);
}

TEST_F(OcclusionTest, TheBiasOfHbaoLeavesShallowHorizonsOpen) {
  const float rise = std::tan(12.0f * static_cast<float>(kPi) / 180.0f); // to both sides of a valley
  Scene scene =
      made_of({rectangle({-1, rise, 0}, {0, 0, 2}, {1, -rise, 0}), rectangle({1, rise, 0}, {0, 0, 2}, {1, rise, 0})});
  look(scene, {0, 5, 0}, {0, 0, 0}, 0.5, {0, 0, -1});
  RenderPlan settings = occlusion_settings("hbao", 0.4);
  settings.ao_bias = 0.0;
  EXPECT_LT(in_the_middle(scene, settings), 0.92);
  settings.ao_bias = 30.0; // more than the 24 degrees between the sides
  for (const float value : light(scene, settings)) ASSERT_EQ(value, 1.0f);
}

// A plate in the air has a back, which horizons do not know: they are darker than rays, the less so the thinner bodies
// are taken for.
TEST_F(OcclusionTest, ThinnessLightensWhatThinBodiesDarken) {
  Scene scene = made_of({floor_of(4.0f), rectangle({0, 0.6f, 0}, {0, 0, 3}, {0.06f, 0, 0})});
  look(scene, {0, 4, 0}, {0, 0, 0}, 0.8, {0, 0, -1});
  RenderPlan settings = occlusion_settings("gtao", 1.2);
  const double rays = mean_of(light(scene, occlusion_settings("traced", 1.2))), thick = mean_of(light(scene, settings));
  settings.ao_thinness = 0.3;
  const double thin = mean_of(light(scene, settings));
  EXPECT_LT(thick, rays - 0.03);
  EXPECT_GT(thin, thick + 0.01);
  EXPECT_LT(std::abs(thin - rays), std::abs(thick - rays));
}

TEST_F(OcclusionTest, HybridDimsItsAmbientTermByIt) {
  const Scene scene = lit_by(sun());
  RenderPlan hybrid = shadow_settings("traced");
  hybrid.max_depth = 2;
  hybrid.ambient = glm::vec3(1.0f);
  hybrid.ao_radius = 0.5;
  hybrid.occlusion = index_of(kOcclusionTechniques.names(), "gtao");
  hybrid.aovs = {"ao"};
  RenderPlan ao = hybrid;
  ao.integrator = &kAo;
  const Picture picture = render(scene, hybrid).picture;
  const auto channel = std::ranges::find_if(picture.channels, [](const auto& c) { return c.name.starts_with("ao"); });
  ASSERT_NE(channel, picture.channels.end());
  const std::vector<float> alone = light(scene, ao);
  EXPECT_EQ(channel->values, alone);
  RenderPlan dark = hybrid;
  dark.ambient = glm::vec3(0.0f);
  const std::vector<float> direct = light(scene, dark);
  const float albedo = bodies().materials[0].base_color.g * (1.0f - bodies().materials[0].metallic);
  for (std::size_t i = 0; i < alone.size(); ++i)
    ASSERT_NEAR(picture.channels[1].values[i] - direct[i], albedo * alone[i], 1e-5f) << i;
}

TEST_F(OcclusionTest, SendsNoRays) {
  const auto has_stage = [](const RenderResult& result, const std::string& name) {
    return std::ranges::count(result.stages, name, &StageTime::name) > 0;
  };
  const RenderResult rays = render(bodies(), occlusion_settings("traced", 1.0));
  EXPECT_TRUE(has_stage(rays, "occlusion"));
  EXPECT_FALSE(has_stage(rays, "screen-space occlusion"));
  EXPECT_FALSE(rays.occlusion);
  for (const OcclusionKind* kind : kOcclusionTechniques.rows) {
    const RenderPlan settings = occlusion_settings(kind->name, 1.0);
    const RenderResult result = render(bodies(), settings);
    EXPECT_FALSE(has_stage(result, "occlusion"));
    EXPECT_TRUE(has_stage(result, kind->voxels ? "cone-traced occlusion" : "screen-space occlusion"));
    ASSERT_TRUE(result.occlusion);
    EXPECT_GT(result.occlusion->cost.least, 0.0);
    EXPECT_LE(result.occlusion->cost.least, result.occlusion->cost.median);
    EXPECT_LE(result.occlusion->cost.median, result.occlusion->cost.most);
    const std::vector<std::string> bias = kAo.bias(settings, result);
    ASSERT_EQ(bias.size(), 1u);
    EXPECT_NE(bias[0].find("--occlusion " + std::string(kind->name)), std::string::npos);
    EXPECT_TRUE(kAo.is_biased(settings));
  }
}

TEST_F(OcclusionTest, SameBitsHoweverTheWorkIsCut) {
  for (const OcclusionKind* kind : kOcclusionTechniques.rows) {
    RenderPlan settings = occlusion_settings(kind->name, 1.0);
    const std::vector<float> whole = light(bodies(), settings);
    settings.wave_slots = 1024;
    EXPECT_EQ(light(bodies(), settings), whole);
  }
}

TEST(OcclusionSettings, EveryNameHasATechniqueAndItsSettingsAloneHaveAnEffect) {
  expect_names_of_own(kOcclusionTechniques);
  RenderPlan settings = occlusion_settings("hbao");
  settings.ao_bias = 5.0;
  EXPECT_NO_THROW(check_occlusion_settings(settings));
  settings.occlusion = index_of(kOcclusionTechniques.names(), "gtao");
  EXPECT_THROW(check_occlusion_settings(settings), UsageError);
  settings = occlusion_settings("traced");
  settings.ao_thinness = 0.5;
  EXPECT_THROW(check_occlusion_settings(settings), UsageError);
  EXPECT_THROW(check_occlusion_settings(occlusion_settings("ssao", 0.0)), UsageError); // unlimited
  settings = occlusion_settings("ssao");
  settings.integrator = &kHybrid;
  settings.max_depth = 1; // without an ambient term
  EXPECT_THROW(check_occlusion_settings(settings), UsageError);
}

} // namespace
} // namespace wavepath::test
