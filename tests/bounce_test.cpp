// Techniques of one diffuse bounce: rays against path tracing, cones against rays.
#include "tests/shadow_scene.h"

#include <numeric>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/antialias/catalogue.h"
#include "host/integrators/hybrid/bounce/catalogue.h"
#include "host/integrators/hybrid/occlusion/catalogue.h"
#include "host/integrators/hybrid/reflections/catalogue.h"
#include "host/integrators/path/kind.h"
#include "host/scene/pack/plan.h"

namespace wavepath::test {
namespace {

RenderPlan settings_for(std::string_view technique, std::uint32_t voxels = 64) {
  RenderPlan settings = shadow_settings("traced");
  settings.width = settings.height = 32;
  settings.max_depth = 2;
  settings.last_sample = 16;
  settings.shadow_size = RenderPlan{}.shadow_size;
  settings.shadow_samples = 4;
  settings.ao_samples = 4;
  settings.bounce = index_of(kBounceTechniques.names(), technique);
  if (technique == "cones") settings.voxels = voxels;
  return settings;
}

Material matt(const glm::vec3& color) {
  Material material = plain_material();
  material.base_color = glm::vec4(color, 1.0f);
  return material;
}

// An eye at `from` that looks along -z.
Camera camera_inside(glm::dvec3 from) {
  Camera camera;
  camera.yfov = 1.2;
  camera.world_from_camera = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, glm::dvec4(from, 1)};
  return camera;
}

// The inside of a closed box, seen from within, under a lamp.
Scene closed_box() {
  Scene scene;
  scene.path = "test";
  scene.materials = {matt(glm::vec3(0.7f))};
  add_instance(scene, add_mesh(scene, box({0, 0, 0}, {1.0f, 0.8f, 1.1f})));
  PunctualLight light = lamp({0.1, 0.45, 0.1});
  scene.lights.push_back(light);
  scene.cameras.push_back(camera_inside({0, 0, 0.9}));
  return scene;
}

// Grey floor and a coloured wall along its side x = -1, seen from above.
constexpr glm::vec3 kWall(0.8f, 0.4f, 0.1f);
Scene wall_beside_floor() {
  Scene scene;
  scene.path = "test";
  scene.materials = {matt(glm::vec3(0.5f)), matt(kWall)};
  add_instance(scene, add_mesh(scene, rectangle({0, 0, 0}, {0, 0, 1}, {1, 0, 0})));
  add_instance(scene, add_mesh(scene, rectangle({-1, 1, 0}, {0, 1, 0}, {0, 0, 1}), 1));
  scene.lights.push_back(sun({-1.0, -0.4, 0.0}));
  scene.cameras.push_back(camera_above({0, 0, 0}, 0.8));
  return scene;
}

double mean(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

class BounceTest : public ShadowTest {
protected:
  // Mean over the picture of what a bounce adds to direct light, by channel.
  glm::dvec3 bounce(const Scene& scene, const RenderPlan& settings) {
    RenderPlan direct = settings;
    direct.bounce = 0;
    direct.voxels = RenderPlan{}.voxels;
    direct.max_depth = 1;
    const Picture with = render(scene, settings).picture, without = render(scene, direct).picture;
    glm::dvec3 sums;
    for (std::size_t c = 0; c < 3; ++c)
      sums[static_cast<int>(c)] = mean(with.channels[c].values) - mean(without.channels[c].values);
    return sums;
  }
  void expect_refused(RenderPlan settings, const std::string& flag) {
    try {
      kHybrid.check(settings);
      FAIL() << flag;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find(flag), std::string::npos) << error.what();
    }
  }
};

TEST(Bounce, EveryValueIsATechnique) { expect_names_of_own(kBounceTechniques); }

// Of matt surfaces, direct light and one bounce are all light of paths of two bounces.
TEST_F(BounceTest, RaysAgreeWithPaths) {
  for (const Scene& scene : {closed_box(), wall_beside_floor(), lit_by_square(1.0f)}) {
    RenderPlan traced = settings_for("traced"), paths = traced;
    traced.last_sample = 32;
    paths.last_sample = 128;
    paths.bounce = 0;
    paths.integrator = &kPath;
    const Picture by_rays = render(scene, traced).picture, by_paths = render(scene, paths).picture;
    for (std::size_t c = 0; c < 3; ++c) {
      const double a = mean(by_rays.channels[c].values), b = mean(by_paths.channels[c].values);
      EXPECT_NEAR(a, b, 0.005 * b) << c;
    }
    EXPECT_GT(bounce(scene, traced).y, 0.01 * mean(by_paths.channels[1].values)); // there is something to find
  }
}

TEST_F(BounceTest, ConesFindTheLightInABoxAndMoreVoxelsFindItBetter) {
  const Scene scene = closed_box();
  const double truth = bounce(scene, settings_for("traced")).y;
  double error = 1.0;
  for (const std::uint32_t voxels : {16u, 32u, 96u}) {
    const double cones = bounce(scene, settings_for("cones", voxels)).y, now = std::abs(cones / truth - 1.0);
    EXPECT_LT(now, error) << voxels;
    error = now;
  }
  EXPECT_LT(error, 0.06);
}

// What a wall sends on has its colour: the ratio of channels is that of its reflectances.
TEST_F(BounceTest, AColouredWallTintsTheFloor) {
  const Scene scene = wall_beside_floor();
  const glm::dvec3 truth = bounce(scene, settings_for("traced")), cones = bounce(scene, settings_for("cones", 96));
  EXPECT_NEAR(truth.x / truth.y, kWall.x / kWall.y, 0.01 * kWall.x / kWall.y);
  EXPECT_NEAR(cones.x / cones.y, kWall.x / kWall.y, 0.02 * kWall.x / kWall.y);
  EXPECT_NEAR(cones.z / cones.y, kWall.z / kWall.y, 0.02 * kWall.z / kWall.y);
  EXPECT_NEAR(cones.y, truth.y, 0.15 * truth.y);
}

TEST_F(BounceTest, TheSameTwice) {
  for (const std::string_view technique : {"traced", "cones"})
    EXPECT_EQ(light(closed_box(), settings_for(technique)), light(closed_box(), settings_for(technique))) << technique;
}

TEST_F(BounceTest, RefusesWhatItTakesThePlaceOf) {
  for (const std::string_view technique : {"traced", "cones"}) {
    RenderPlan settings = settings_for(technique);
    EXPECT_NO_THROW(kHybrid.check(settings));
    settings.max_depth = 1;
    expect_refused(settings, "--bounce");
    settings = settings_for(technique);
    settings.reflections = 1;
    expect_refused(settings, "--reflections");
    settings = settings_for(technique);
    settings.ambient = glm::vec3(0.0f);
    expect_refused(settings, "--ambient");
    settings = settings_for(technique);
    settings.occlusion = 1;
    expect_refused(settings, "--occlusion");
    settings = settings_for(technique);
    settings.antialias = index_of(kAntialiasTechniques.names(), "upscale");
    expect_refused(settings, "--bounce");
  }
  RenderPlan rays = settings_for("traced");
  rays.voxels = 64;
  expect_refused(rays, "--voxels");
}

// Without one, nothing of it is there: neither memory nor bias.
TEST_F(BounceTest, NoneCostsNothing) {
  const RenderPlan none = settings_for("none");
  for (const MemoryItem& item : kHybrid.items(none, ScenePlan{}, 0)) EXPECT_EQ(item.bytes, 0u) << item.name;
  std::uint64_t most = 0;
  for (const MemoryItem& item : kHybrid.items(settings_for("cones"), ScenePlan{}, 0)) most += item.bytes;
  EXPECT_GT(most, 64u * 64 * 64 * 12);
}

} // namespace
} // namespace wavepath::test
