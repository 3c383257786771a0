// The built-in environments and the ground, as the device renders them: brightness by every estimator of direct light,
// and a floor that is not seen but for its shadow.
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host/integrators/bidirectional/kind.h"
#include "host/integrators/hybrid/kind.h"
#include "host/integrators/path/kind.h"
#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/environment.h"
#include "host/scene/staging/ground.h"
#include "host/scene/staging/view.h"
#include "tests/scene_builder.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

Scene white_floor(const std::string& environment) {
  Scene scene;
  scene.path = "test";
  scene.materials = {plain_material()};
  scene.materials[0].base_color = glm::vec4(1.0f);
  const glm::vec3 a{-1, 0, -1}, b{1, 0, -1}, c{1, 0, 1}, d{-1, 0, 1};
  add_instance(scene, add_mesh(scene, {a, c, b, a, d, c}));
  scene.environment = load_environment(environment);
  return scene;
}

class StudioTest : public VulkanTest {
protected:
  static inline std::unique_ptr<KernelCompiler> kernels_;
  static void TearDownTestSuite() { kernels_.reset(); }

  Picture render(Scene scene, const ViewRequest& request, const RenderPlan& asked) {
    if (!kernels_) kernels_ = std::make_unique<KernelCompiler>(device());
    const View view = resolve_view(scene, request, asked.width, asked.height);
    const PackedScene packed = pack(scene, {.direct = asked.direct, .eye = view.position, .lights = asked.lights});
    return wavepath::render(device(), packed, view, asked, RenderHooks{}, *kernels_).picture;
  }
  static RenderPlan settings(std::uint32_t side, std::uint32_t spp) {
    RenderPlan asked;
    asked.width = asked.height = side;
    asked.last_sample = spp;
    asked.max_depth = 1;
    asked.filter = gpu::kFilterBox;
    return asked;
  }
};

double luminance(const Picture& picture, std::size_t pixel) {
  return 0.2126 * picture.channels[0].values[pixel] + 0.7152 * picture.channels[1].values[pixel] +
         0.0722 * picture.channels[2].values[pixel];
}

double mean_luminance(const Picture& picture) {
  const std::size_t count = picture.channels[0].values.size();
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) sum += luminance(picture, i);
  return sum / static_cast<double>(count);
}

constexpr std::uint32_t kEstimators[] = {gpu::kDirectMis, gpu::kDirectNee, gpu::kDirectBsdf};

TEST_F(StudioTest, AWhiteFloorHasRadianceOneByEveryEstimator) {
  const ViewRequest above{.eye = glm::dvec3(0, 1, 0.001), .look_at = glm::dvec3(0.0), .yfov = 0.1};
  for (const std::uint32_t direct : kEstimators) {
    RenderPlan asked = settings(16, direct == gpu::kDirectBsdf ? 4096 : 512);
    asked.direct = direct;
    EXPECT_NEAR(mean_luminance(render(white_floor("studio"), above, asked)), 1.0, 5e-3) << direct;
    if (direct == gpu::kDirectBsdf) continue; // which seldom finds the sun
    EXPECT_NEAR(mean_luminance(render(white_floor("sky"), above, asked)), 1.0, 1e-2) << direct;
  }
}

// A dark ball that touches the floor at zero; with a ground, with or without the ball on it.
Scene ball(bool ground, bool shown = true) {
  Scene scene;
  scene.path = "test";
  scene.materials = {plain_material()};
  scene.materials[0].base_color = glm::vec4(0.05f, 0.05f, 0.05f, 1.0f);
  std::vector<glm::vec3> corners;
  constexpr int kAround = 24, kRings = 12;
  const auto at = [&](int ring, int around) {
    const float polar = 3.14159265f * static_cast<float>(ring) / kRings,
                phi = 6.2831853f * static_cast<float>(around) / kAround;
    return glm::vec3(std::sin(polar) * std::sin(phi), 1.0f + std::cos(polar), std::sin(polar) * std::cos(phi));
  };
  for (int ring = 0; ring < kRings; ++ring)
    for (int around = 0; around < kAround; ++around)
      for (const auto& [r, s] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}})
        corners.push_back(at(ring + r, around + s));
  add_instance(scene, add_mesh(scene, corners));
  scene.environment = load_environment("sky");
  const Bounds bounds = world_bounds(scene);
  if (!shown) scene.instances.clear();
  if (ground) add_ground(scene, bounds);
  return scene;
}

// By each integrator: dark where the ball keeps the sun off, and elsewhere as if there were no ground.
TEST_F(StudioTest, OfTheGroundOnlyTheShadowIsSeen) {
  constexpr std::uint32_t kSide = 48;
  const ViewRequest from_the_front{.eye = glm::dvec3(0, 3, 9), .look_at = glm::dvec3(0, 0.6, 0), .yfov = 0.6};
  const View view = resolve_view(ball(false), from_the_front, kSide, kSide);
  const auto pixel_at = [&](const glm::dvec3& place) {
    const glm::dvec3 to = place - view.position;
    const double depth = glm::dot(to, view.forward);
    const double x = glm::dot(to, view.right) / glm::dot(view.right, view.right) / depth,
                 y = glm::dot(to, view.up) / glm::dot(view.up, view.up) / depth;
    return static_cast<std::size_t>(0.5 * kSide * (1.0 - y)) * kSide +
           static_cast<std::size_t>(0.5 * kSide * (1.0 + x));
  };
  const std::size_t shadow = pixel_at({1.5, 0.0, -0.9}), lit[] = {pixel_at({-1.8, 0, 0.5}), pixel_at({1.5, 0.0, 1.5})};
  for (const IntegratorKind* kind : {&kPath, &kBidirectional}) {
    RenderPlan asked = settings(kSide, 512);
    asked.integrator = kind;
    asked.max_depth = 4;
    const Picture without = render(ball(false), from_the_front, asked),
                  with = render(ball(true), from_the_front, asked),
                  empty = render(ball(true, false), from_the_front, asked);
    EXPECT_LT(luminance(with, shadow), 0.5 * luminance(without, shadow)) << kind->name;
    for (const std::size_t pixel : lit) // less of the sky is seen from there
      EXPECT_NEAR(luminance(with, pixel), luminance(without, pixel), 0.15 * luminance(without, pixel)) << kind->name;
    const Picture bare = render(ball(false, false), from_the_front, asked);
    for (std::size_t pixel = 0; pixel < bare.channels[0].values.size(); ++pixel)
      EXPECT_NEAR(luminance(empty, pixel), luminance(bare, pixel), 0.05 * luminance(bare, pixel)) << pixel;
  }
}

} // namespace
} // namespace wavepath::test
