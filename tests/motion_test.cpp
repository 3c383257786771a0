// Motion blur against exact answers: the streak of a disc, shadows of what moves, normals that turn; all rays of a path
// see one moment, and those moments are stratified.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "host/integrators/path/kind.h"
#include "host/picture/files/picture_io.h"
#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/shining_disc.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

constexpr double kDepth = 3.0;

void move(Mesh& mesh, const glm::vec3& by) {
  mesh.end_positions = mesh.positions;
  for (glm::vec3& p : mesh.end_positions) p += by;
  mesh.end_normals = mesh.normals;
}

class MotionTest : public VulkanTest {
protected:
  static inline std::unique_ptr<KernelCompiler> kernels_;
  static void TearDownTestSuite() { kernels_.reset(); }

  static RenderPlan settings(std::uint32_t spp, std::uint32_t depth = 0) {
    RenderPlan asked;
    asked.width = asked.height = kSide;
    asked.last_sample = spp;
    asked.max_depth = depth;
    asked.filter = gpu::kFilterBox;
    asked.moving = true;
    return asked;
  }
  RenderResult render(Scene scene, const RenderPlan& asked) {
    if (!kernels_) kernels_ = std::make_unique<KernelCompiler>(device());
    const PackedScene packed = pack(scene);
    EXPECT_TRUE(packed.moves());
    return wavepath::render(device(), packed, view_along_z(true), asked, RenderHooks{}, *kernels_);
  }
  std::vector<float> red(const Scene& scene, const RenderPlan& asked) {
    return render(scene, asked).picture.channels[0].values;
  }
};

// Fraction of the time, and of the pixel [x, x + 1] x [y, y + 1], for which a disc covers it whose middle moves from
// -travel / 2 to travel / 2 along x. Numbers in pixels; a row of the disc leaves a trapezoid.
double streak(double x, double y, double radius, double travel) {
  constexpr int kSteps = 200;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double height = y + (i + 0.5) / kSteps, chord = std::sqrt(std::max(radius * radius - height * height, 0.0));
    for (int k = 0; k < 4; ++k) {
      const double at = x + (k + 0.5) / 4; // the middle covers it from at - chord to at + chord
      sum += std::max(std::min(at + chord, 0.5 * travel) - std::max(at - chord, -0.5 * travel), 0.0) / travel;
    }
  }
  return sum / (4 * kSteps);
}

TEST_F(MotionTest, StreakOfADisc) {
  constexpr double kRadius = 6.0, kTravel = 20.0; // pixels
  Scene scene = disc_scene(kDepth, kRadius / kScale);
  for (glm::vec3& p : scene.meshes[0].positions) p.x -= static_cast<float>(0.5 * kTravel / kScale);
  move(scene.meshes[0], {static_cast<float>(kTravel / kScale), 0, 0});
  const auto image = red(scene, settings(2048));
  for (std::size_t i = 0; i < image.size(); ++i) {
    const double x = static_cast<double>(i % kSide) - 0.5 * kSide, y = static_cast<double>(i / kSide) - 0.5 * kSide;
    const double expected = kRadiance * streak(x, y, kRadius, kTravel);
    ASSERT_NEAR(image[i], expected, 0.012 * kRadiance) << "pixel " << x << " " << y;
    if (std::abs(y + 0.5) > kRadius + 1.0) {
      ASSERT_EQ(image[i], 0.0f);
    }
  }
}

// A white floor across the view, lit by a sun from the camera, and a black sheet between the two.
Scene floor_behind_sheet(float half) {
  Scene scene;
  scene.path = "test";
  scene.materials = {plain_material(), plain_material()};
  scene.materials[0].base_color = glm::vec4(1.0f);
  scene.materials[1].base_color = glm::vec4(0.0f, 0.0f, 0.0f, 1.0f);
  const auto square = [](float h, float z) {
    const glm::vec3 a{-h, -h, z}, b{h, -h, z}, c{h, h, z}, d{-h, h, z};
    return std::vector<glm::vec3>{a, b, c, a, c, d};
  };
  add_instance(scene, add_mesh(scene, square(8.0f, -4.0f)));
  add_instance(scene, add_mesh(scene, square(half, 2.0f), 1)); // behind the camera: only its shadow is seen
  PunctualLight sun;
  sun.kind = LightKind::directional;
  sun.intensity = glm::vec3(static_cast<float>(kPi));
  scene.lights.push_back(sun); // along -Z
  return scene;
}

// The sheet covers all until it has moved through half of its way.
TEST_F(MotionTest, ShadowOfWhatMovesLastsAsLongAsItIsThere) {
  Scene scene = floor_behind_sheet(4.0f);
  move(scene.meshes[1], {9.0f, 0, 0}); // its left edge passes the picture, 1 m wide, from 3.5/9 to 4.5/9 of the time
  RenderPlan asked = settings(256, 1);
  const auto image = red(scene, asked);
  for (std::size_t i = 0; i < image.size(); ++i) {
    const double x = (static_cast<double>(i % kSide) + 0.5) / kSide - 0.5;
    ASSERT_NEAR(image[i], 1.0 - (4.0 + x) / 9.0, 0.01) << "pixel " << i;
  }
}

// Sheet and floor move together: their shadow goes with them, and no ray of a path sees another moment than the others.
TEST_F(MotionTest, AllRaysOfAPathSeeOneMoment) {
  Scene scene = floor_behind_sheet(1.0f);
  for (glm::vec3& p : scene.meshes[0].positions) p = {p.x / 8.0f, p.y / 8.0f, p.z}; // as large as the sheet
  move(scene.meshes[0], {3.0f, 0, 0});
  move(scene.meshes[1], {3.0f, 0, 0});
  scene.materials[0].emission = glm::vec3(1.0f);
  RenderPlan asked = settings(256, 1);
  asked.aovs = {"direct", "emission"};
  const Picture picture = render(scene, asked).picture;
  const auto& direct = find_channel(picture, "direct.R")->values;
  const auto& emission = find_channel(picture, "emission.R")->values;
  for (std::size_t i = 0; i < direct.size(); ++i) {
    ASSERT_EQ(direct[i], 0.0f) << "pixel " << i;
    ASSERT_GT(emission[i], 0.1f) << "the floor is there for a part of the time";
  }
}

// What shines and moves is found by chance, and lights as much as if it stood still: a large sheet that moves in its
// plane.
TEST_F(MotionTest, WhatShinesAndMovesLights) {
  Scene scene = floor_behind_sheet(3.0f);
  scene.lights.clear();
  scene.materials[1].emission = glm::vec3(2.0f);
  const auto still = [&] {
    PackedScene packed = pack(scene);
    RenderPlan asked = settings(256, 1);
    asked.moving = false;
    return wavepath::render(device(), packed, view_along_z(true), asked, RenderHooks{}, *kernels_)
        .picture.channels[0]
        .values;
  };
  Scene moving = scene;
  if (!kernels_) kernels_ = std::make_unique<KernelCompiler>(device());
  double a = 0.0, b = 0.0;
  for (const float v : still()) a += v;
  move(moving.meshes[1], {1e-6f, 0, 0});
  for (const float v : red(moving, settings(1024, 1))) b += v;
  EXPECT_NEAR(b, a, 0.01 * a);
}

// Vertex normals turn while corners stand still.
TEST_F(MotionTest, NormalsTurnWithTheSurface) {
  Scene scene = floor_behind_sheet(0.1f);
  Mesh& mesh = scene.meshes[0];
  mesh.normals.assign(mesh.positions.size(), {0, 0, 1});
  mesh.primitives[0].has_normals = true;
  move(mesh, {0, 0, 0});
  mesh.end_normals.assign(mesh.positions.size(), glm::normalize(glm::vec3(1, 0, 1)));
  RenderPlan asked = settings(1024, 1);
  asked.aovs = {"normal"};
  const Picture picture = render(scene, asked).picture;
  double expected = 0.0;
  for (int i = 0; i < 1000; ++i)
    expected +=
        glm::normalize(glm::mix(glm::dvec3(0, 0, 1), glm::normalize(glm::dvec3(1, 0, 1)), (i + 0.5) / 1000)).x / 1000;
  for (const float x : find_channel(picture, "N.X")->values) ASSERT_NEAR(x, expected, 1e-3);
}

TEST_F(MotionTest, SameBitsHoweverTheWorkIsCut) {
  Scene scene = disc_scene(kDepth, 0.2);
  move(scene.meshes[0], {0.2f, 0.1f, 0.5f});
  RenderPlan asked = settings(5, 2);
  const RenderResult expected = render(scene, asked);
  asked.wave_slots = 700;
  EXPECT_TRUE(*render(scene, asked).film == *expected.film);
  asked.wave_slots = 0, asked.specialize = false;
  EXPECT_TRUE(*render(scene, asked).film == *expected.film);
}

// A shadow that passes in a moment: each pixel sees a step in time. Independent moments: variance by 1/n; stratified
// ones by its square.
TEST_F(MotionTest, MomentsAreStratified) {
  Scene scene = floor_behind_sheet(4.0f);
  move(scene.meshes[1], {9.0f, 0, 0});
  const auto variance = [&](std::uint32_t sampler, std::uint32_t spp) {
    constexpr std::uint32_t kSeeds = 6;
    RenderPlan asked = settings(spp, 1);
    asked.sampler = sampler;
    asked.probes_from = 0;
    std::vector<double> sum(kSide * kSide), squares(kSide * kSide);
    for (asked.seed = 0; asked.seed < kSeeds; ++asked.seed) {
      const auto image = red(scene, asked);
      for (std::size_t i = 0; i < image.size(); ++i) sum[i] += image[i], squares[i] += double{image[i]} * image[i];
    }
    double total = 0.0;
    for (std::size_t i = 0; i < sum.size(); ++i) total += (squares[i] - sum[i] * sum[i] / kSeeds) / (kSeeds - 1);
    return total;
  };
  EXPECT_NEAR(variance(gpu::kSamplerIndependent, 16) / variance(gpu::kSamplerIndependent, 256), 16.0, 3.0);
  EXPECT_GT(variance(gpu::kSamplerSobol, 16) / variance(gpu::kSamplerSobol, 256), 100.0);
}

// Nothing of it where nothing moves.
TEST(Motion, ScenesThatStandStillPayNothing) {
  Scene scene = disc_scene(kDepth, 0.2);
  const PackedScene still = pack(scene);
  EXPECT_FALSE(still.moves());
  EXPECT_EQ(still.end_normals, 0u);
  EXPECT_EQ(kernel_config(still.features, still.stack_size, RenderPlan{}).motion, 0u);
}

} // namespace
} // namespace wavepath::test
