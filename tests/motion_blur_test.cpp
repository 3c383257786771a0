// Motion blur after the frame: closed forms of edges and streaks, pixels that must keep every bit, the moment that a
// frame shows, and the distance to the shutter of the path tracer.
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/bounce/catalogue.h"
#include "host/integrators/hybrid/motion_blur.h"
#include "host/integrators/hybrid/occlusion/catalogue.h"
#include "host/integrators/hybrid/reflections/catalogue.h"
#include "host/integrators/hybrid/transparency/catalogue.h"
#include "host/integrators/path/kind.h"
#include "host/render/settings/antialias_settings.h"
#include "tests/shadow_scene.h"

namespace wavepath::test {
namespace {

constexpr int kSide = 64; // pixels

Material shining(const glm::vec3& light) {
  Material material = plain_material();
  material.base_color = {0, 0, 0, 1};
  material.emission = light;
  return material;
}

// A pixel is a metre, the middle of the picture is the origin, and the eye looks along -Z.
Scene empty_scene() {
  Scene scene;
  scene.path = "test";
  Camera camera;
  camera.orthographic = true;
  camera.xmag = camera.ymag = kSide / 2;
  camera.world_from_camera[3] = {0, 0, 50, 1};
  scene.cameras.push_back(camera);
  return scene;
}

std::uint32_t add_shape(Scene& scene, const std::vector<glm::vec3>& corners, const glm::vec3& light) {
  scene.materials.push_back(shining(light));
  const std::uint32_t mesh = add_mesh(scene, corners, static_cast<std::uint32_t>(scene.materials.size() - 1));
  add_instance(scene, mesh);
  return mesh;
}

// From its place when the shutter opens, by `by` until it closes, about the place where it stands.
void move(Scene& scene, std::uint32_t index, const glm::vec3& by) {
  Mesh& mesh = scene.meshes[index];
  mesh.end_positions = mesh.positions;
  mesh.end_normals = mesh.normals;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    mesh.end_positions[i] += 0.5f * by;
    mesh.positions[i] -= 0.5f * by;
  }
}

RenderPlan motion_settings(bool moving = true, std::uint32_t samples = 1) {
  RenderPlan settings;
  settings.integrator = &kHybrid;
  settings.width = settings.height = kSide;
  settings.max_depth = 0; // light that is seen directly
  settings.filter = gpu::kFilterBox;
  settings.last_sample = samples;
  settings.moving = moving;
  settings.first_hit = kFirstHitTraced;
  settings.antialias = 1; // none: pixels are seen at their centres
  return settings;
}

class MotionBlurTest : public ShadowTest {
protected:
  static double squared_error(const std::vector<float>& truth, const std::vector<float>& picture) {
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) sum += std::pow(static_cast<double>(picture[i]) - truth[i], 2);
    return sum;
  }
};

// Two half planes in one, which shine differently. The edge between them lies on a border of pixels.
Scene edge_scene(bool upright, const glm::vec3& by) {
  Scene scene = empty_scene();
  const glm::vec3 along = upright ? glm::vec3(0, 300, 0) : glm::vec3(300, 0, 0),
                  across = upright ? glm::vec3(300, 0, 0) : glm::vec3(0, 300, 0);
  move(scene, add_shape(scene, rectangle(across, across, along), glm::vec3(3.0f)), by);
  move(scene, add_shape(scene, rectangle(-across, across, along), glm::vec3(1.0f)), by);
  return scene;
}

// A centre of a pixel sees the edge pass at a moment that follows from its distance: the ramp of a box filter.
TEST_F(MotionBlurTest, UniformMotionIsABoxFilter) {
  for (const bool upright : {true, false})
    for (const float travel : {1.0f, 1.5f, 7.0f, 20.0f, 33.3f})
      for (const float slant : {0.0f, 0.6f}) { // motion along the edge changes nothing
        const glm::vec3 by = upright ? glm::vec3(travel, slant * travel, 0) : glm::vec3(slant * travel, -travel, 0);
        const std::vector<float> picture = light(edge_scene(upright, by), motion_settings());
        for (int i = 0; i < kSide * kSide; ++i) {
          const int x = i % kSide, y = i / kSide;
          const double away = upright ? x + 0.5 - kSide / 2 : kSide / 2 - y - 0.5;
          if (kSide / 2 - std::max(std::abs(x + 0.5 - kSide / 2), std::abs(y + 0.5 - kSide / 2)) < 0.5 * travel + 1)
            continue; // what comes from beyond the picture is not known
          const double expected = 1.0 + 2.0 * std::clamp(away / travel + 0.5, 0.0, 1.0);
          ASSERT_NEAR(picture[i], expected, 2e-5) << travel << " " << slant << ", pixel " << x << " " << y;
        }
      }
}

// By perspective: metres over depth.
TEST_F(MotionBlurTest, BlurIsAsLongAsTheWayInThePicture) {
  for (const double depth : {10.0, 25.0}) {
    Scene scene = edge_scene(true, {4.0f, 0, 0});
    scene.cameras[0].orthographic = false;
    scene.cameras[0].yfov = 2.0 * std::atan(0.5); // half the picture at unit distance: half a metre
    scene.cameras[0].world_from_camera[3] = {0, 0, depth, 1};
    const double travel = 4.0 / depth * kSide;
    const std::vector<float> picture = light(scene, motion_settings());
    for (int x = 0; x < kSide; ++x) {
      const double away = x + 0.5 - kSide / 2;
      if (kSide / 2 - std::abs(away) < 0.5 * travel + 1) continue;
      ASSERT_NEAR(picture[kSide * kSide / 2 + x], 1.0 + 2.0 * std::clamp(away / travel + 0.5, 0.0, 1.0), 1e-3) << x;
    }
  }
}

// A square before a still background, whose every pixel differs: a trapezoid, and bits that stay.
TEST_F(MotionBlurTest, WhatMovesLeavesAStreakOfItsLength) {
  for (const float travel : {4.0f, 12.0f, 30.0f}) {
    Scene scene = empty_scene();
    for (int i = 0; i < kSide; ++i)
      add_shape(scene, rectangle({i + 0.5f - kSide / 2, 0, -1}, {0.5f, 0, 0}, {0, 100, 0}),
                glm::vec3(1.0f + 0.01f * i));
    const std::uint32_t square = add_shape(scene, rectangle({0, 0, 5}, {10, 0, 0}, {0, 10, 0}), glm::vec3(9.0f));
    move(scene, square, {travel, 0, 0});
    const std::vector<float> picture = light(scene, motion_settings());
    Scene frozen = scene;
    for (glm::vec3& p : frozen.meshes[square].positions) p.x += 0.5f * travel;
    frozen.meshes[square].end_positions.clear();
    frozen.meshes[square].end_normals.clear();
    const std::vector<float> still = light(frozen, motion_settings(false));
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const double away = std::abs(x + 0.5 - kSide / 2), up = std::abs(y + 0.5 - kSide / 2);
        const float value = picture[y * kSide + x], before = still[y * kSide + x];
        if (up > 10 || away > 10 + 0.5 * travel + 0.5) {
          ASSERT_EQ(value, before) << "pixel " << x << " " << y;
          continue;
        }
        if (away < 10) continue; // behind the square there is more than is known
        const double covered = std::clamp((10 + 0.5 * travel - away) / travel, 0.0, 1.0);
        ASSERT_NEAR(value, before + covered * (9.0 - before), 1e-4) << "pixel " << x << " " << y;
        if (covered > 0.0) {
          ASSERT_GT(value, before) << "pixel " << x << " " << y;
        }
      }
  }
}

// Over a background of one colour nothing is unknown: the trapezoid of the whole square, and the light of all of it.
TEST_F(MotionBlurTest, BeforeOneColourTheStreakIsWhole) {
  constexpr double kTravel = 15.0;
  Scene scene = empty_scene();
  add_shape(scene, rectangle({0, 0, -5}, {100, 0, 0}, {0, 100, 0}), glm::vec3(2.0f));
  move(scene, add_shape(scene, rectangle({0, 0, 5}, {10, 0, 0}, {0, 10, 0}), glm::vec3(9.0f)), {kTravel, 0, 0});
  const std::vector<float> picture = light(scene, motion_settings());
  for (int y = kSide / 2 - 10; y < kSide / 2 + 10; ++y)
    for (int x = 0; x < kSide; ++x) {
      const double away = x + 0.5 - kSide / 2;
      const double covered =
          std::max(std::min(away + 10, 0.5 * kTravel) - std::max(away - 10, -0.5 * kTravel), 0.0) / kTravel;
      ASSERT_NEAR(picture[y * kSide + x], 2.0 + 7.0 * covered, 1e-4) << "pixel " << x << " " << y;
    }
}

// A near still body hides what moves behind it, and stays sharp.
TEST_F(MotionBlurTest, WhatIsBehindDoesNotPassInFront) {
  Scene scene = empty_scene();
  move(scene, add_shape(scene, rectangle({0, 0, -5}, {10, 0, 0}, {0, 10, 0}), glm::vec3(9.0f)), {16, 0, 0});
  add_shape(scene, rectangle({11, 0, 5}, {3, 0, 0}, {0, 30, 0}), glm::vec3(1.0f));
  const std::vector<float> picture = light(scene, motion_settings());
  for (int y = kSide / 2 - 10; y < kSide / 2 + 10; ++y)
    for (int x = kSide / 2 + 8; x < kSide / 2 + 14; ++x) ASSERT_EQ(picture[y * kSide + x], 1.0f) << x << " " << y;
}

TEST_F(MotionBlurTest, NoMotionKeepsEveryBit) {
  Scene scene = bodies();
  scene.lights.push_back(lamp());
  const RenderPlan still = [] {
    RenderPlan settings = shadow_settings("traced");
    settings.last_sample = 3;
    settings.max_depth = 4;
    settings.first_hit = kFirstHitTraced;
    return settings;
  }();
  const RenderResult expected = render(scene, still);
  EXPECT_EQ(std::ranges::count(expected.stages, kMotionBlurStage, &StageTime::name), 0);
  move(scene, 1, glm::vec3(0.0f));
  RenderPlan moving = still;
  moving.moving = true;
  const RenderResult result = render(scene, moving);
  EXPECT_TRUE(*result.film == *expected.film);
  EXPECT_EQ(std::ranges::count(result.stages, kMotionBlurStage, &StageTime::name), 1);
}

// A sheet behind the eye, whose shadow has left the floor in the middle of the time; vertices go with it.
TEST_F(MotionBlurTest, FramesAreOfTheMiddleOfTheShutter) {
  Scene scene = empty_scene();
  scene.materials.push_back(plain_material());
  add_instance(scene, add_mesh(scene, rectangle({0, 0, 0}, {100, 0, 0}, {0, 100, 0})));
  add_instance(scene, add_mesh(scene, rectangle({0, 0, 70}, {40, 0, 0}, {0, 40, 0})));
  scene.lights.push_back(sun({0, 0, -1}));
  RenderPlan settings = motion_settings();
  settings.max_depth = 1;
  settings.direct = gpu::kDirectNee;
  const auto lit = [&](float from, float to) {
    Scene moved = scene;
    Mesh& sheet = moved.meshes[1];
    sheet.end_positions = sheet.positions;
    for (glm::vec3& p : sheet.positions) p.x += from;
    for (glm::vec3& p : sheet.end_positions) p.x += to;
    const std::vector<float> picture = light(moved, settings);
    return std::ranges::count_if(picture, [](float v) { return v > 0.0f; });
  };
  EXPECT_EQ(lit(0.0f, 160.0f), kSide * kSide);
  EXPECT_EQ(lit(-80.0f, 80.0f), 0);
  EXPECT_EQ(lit(0.0f, 80.0f), kSide * kSide / 2);
}

// Instances: displacements turn and grow with them. A square that moves along its own x, placed twice.
TEST_F(MotionBlurTest, InstancesMoveInTheirOwnSpace) {
  Scene scene = empty_scene();
  const std::uint32_t square = add_shape(scene, rectangle({0, 0, 0}, {2, 0, 0}, {0, 2, 0}), glm::vec3(4.0f));
  move(scene, square, {3, 0, 0});
  scene.instances[0].world_from_object = {{2, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 2, 0}, {-16, 0, 0, 1}};
  add_instance(scene, square, {{0, 2, 0, 0}, {-2, 0, 0, 0}, {0, 0, 2, 0}, {16, 0, 0, 1}}); // along y
  const std::vector<float> picture = light(scene, motion_settings());
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const double px = x + 0.5 - kSide / 2, py = kSide / 2 - y - 0.5;
      const double along = px < 0 ? px + 16 : py, aside = px < 0 ? py : px - 16;
      const double covered = std::max(std::min(along + 4, 3.0) - std::max(along - 4, -3.0), 0.0) / 6.0;
      ASSERT_NEAR(picture[y * kSide + x], std::abs(aside) < 4 ? 4.0 * covered : 0.0, 1e-4) << x << " " << y;
    }
}

TEST_F(MotionBlurTest, SameBitsHoweverTheWorkIsCut) {
  Scene scene = bodies();
  scene.lights.push_back(lamp());
  move(scene, 1, {0.4f, 0.1f, 0.2f});
  RenderPlan settings = shadow_settings("traced");
  settings.last_sample = 3;
  settings.max_depth = 4;
  settings.moving = true;
  const RenderResult expected = render(scene, settings);
  settings.wave_slots = 700;
  EXPECT_TRUE(*render(scene, settings).film == *expected.film);
  settings.wave_slots = 0, settings.specialize = false;
  EXPECT_TRUE(*render(scene, settings).film == *expected.film);
}

// A box flies through light and shadow: against the shutter of paths the blurred frames have less than half of the
// squared error of frozen ones. What is left is the box's shadow, which no velocity tells of.
TEST_F(MotionBlurTest, IsNearerToTheShutterThanAFrozenFrame) {
  Scene scene = bodies();
  scene.lights.push_back(lamp());
  const glm::vec3 by(0.5f, 0.0f, -0.1f);
  move(scene, 1, by);
  RenderPlan settings = shadow_settings("traced");
  settings.filter = gpu::kFilterBox;
  settings.last_sample = 32;
  settings.moving = true;
  const std::vector<float> blurred = light(scene, settings);
  RenderPlan traced = settings;
  traced.integrator = &kPath;
  traced.last_sample = 1024;
  const std::vector<float> truth = light(scene, traced);
  Scene middle = bodies();
  middle.lights.push_back(lamp());
  settings.moving = false;
  const std::vector<float> frozen = light(middle, settings);
  EXPECT_LT(squared_error(truth, blurred), 0.5 * squared_error(truth, frozen));
}

TEST(MotionBlurSettings, RefuseWhatDrawsSurfacesAsTheShutterOpens) {
  EXPECT_NO_THROW(check_motion_settings(motion_settings()));
  const std::vector<std::function<void(RenderPlan&)>> changes = {
      [](RenderPlan& s) { s.first_hit = kFirstHitRaster; },
      [](RenderPlan& s) { s.shadows = index_of(kShadowTechniques.names(), "map"); },
      [](RenderPlan& s) { s.transparency = 1; },
      [](RenderPlan& s) { s.reflections = 1; },
      [](RenderPlan& s) { s.bounce = index_of(kBounceTechniques.names(), "traced"); },
      [](RenderPlan& s) {
        s.max_depth = 2; // with an ambient term
        s.occlusion = index_of(kOcclusionTechniques.names(), "cones");
      }};
  for (const auto& change : changes) {
    RenderPlan settings = motion_settings();
    change(settings);
    EXPECT_THROW(check_motion_settings(settings), UsageError);
    settings.moving = false;
    EXPECT_NO_THROW(check_motion_settings(settings));
  }
}

TEST(MotionBlurSettings, IsABias) {
  const auto names_it = [](const RenderPlan& settings) {
    return std::ranges::any_of(kHybrid.bias(settings, RenderResult{}),
                               [](const std::string& text) { return text.find("--shutter") != std::string::npos; });
  };
  EXPECT_TRUE(names_it(motion_settings(true)));
  EXPECT_FALSE(names_it(motion_settings(false)));
  EXPECT_GT(kHybrid.bytes_per_pixel(motion_settings(true)), kHybrid.bytes_per_pixel(motion_settings(false)));
}

} // namespace
} // namespace wavepath::test
