// Shadow rays and surfaces that let light through: panes of BLEND dim a light by their exact fraction, whatever the
// tree, and unlit surfaces neither give light nor take it.
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/integrators/hybrid/kind.h"
#include "host/integrators/path/kind.h"
#include "host/integrators/whitted/kind.h"
#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/scene_builder.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

std::vector<glm::vec3> square(float half, float y, bool up) {
  const glm::vec3 a{-half, y, -half}, b{half, y, -half}, c{half, y, half}, d{-half, y, half};
  return up ? std::vector<glm::vec3>{a, c, b, a, d, c} : std::vector<glm::vec3>{a, b, c, a, c, d};
}

// A white floor under a sun of pi lux, seen from below the panes: radiance 1 without them. Panes hang askew, so that
// spatial splits would cut them.
Scene floor_under(const std::vector<float>& alphas) {
  Scene scene;
  scene.materials = {plain_material()};
  scene.materials[0].base_color = glm::vec4(1.0f);
  add_instance(scene, add_mesh(scene, square(1.0f, 0.0f, true), 0));
  for (std::size_t i = 0; i < alphas.size(); ++i) {
    Material pane = plain_material();
    pane.alpha_mode = AlphaMode::blend;
    pane.base_color = glm::vec4(0.0f, 0.0f, 0.0f, alphas[i]);
    scene.materials.push_back(pane);
    const glm::dmat4 turn =
        glm::rotate(glm::translate(glm::dmat4(1.0), glm::dvec3(0, 3.0 + 0.5 * double(i), 0)), 0.4, glm::dvec3(1, 0, 1));
    add_instance(scene, add_mesh(scene, square(3.0f, 0.0f, true), static_cast<std::uint32_t>(i + 1)), turn);
  }
  PunctualLight sun;
  sun.kind = LightKind::directional;
  sun.direction = {0, -1, 0};
  sun.intensity = glm::vec3(3.14159265f);
  scene.lights = {sun};
  return scene;
}

class ShadowTest : public VulkanTest {
protected:
  // Compiles each of them once, and waits for what is being compiled before the driver's own statics go.
  static inline std::unique_ptr<KernelCompiler> kernels_;
  static void TearDownTestSuite() { kernels_.reset(); }

  Picture render(Scene scene, const IntegratorKind* integrator, std::uint32_t spp, std::uint32_t depth,
                 bvh::Quality quality = bvh::Quality::fast) {
    if (!kernels_) kernels_ = std::make_unique<KernelCompiler>(device());
    RenderPlan settings;
    settings.width = 8, settings.height = 8;
    settings.last_sample = spp;
    settings.max_depth = depth;
    settings.integrator = integrator;
    settings.filter = gpu::kFilterBox;
    ViewRequest request;
    request.eye = glm::dvec3(0, 1, 0.001);
    request.look_at = glm::dvec3(0, 0, 0);
    request.yfov = 0.7;
    const View view = resolve_view(scene, request, settings.width, settings.height);
    const PackedScene packed = pack(scene, {.quality = quality, .eye = view.position});
    return wavepath::render(device(), packed, view, settings, RenderHooks{}, *kernels_).picture;
  }
  void expect_even(const Picture& picture, double value, double tolerance) {
    for (int c = 0; c < 3; ++c)
      for (const float v : picture.channels[c].values) ASSERT_NEAR(v, value, tolerance);
  }
};

TEST_F(ShadowTest, PanesDimByTheirExactFraction) {
  const Scene scene = floor_under({0.5f, 0.5f, 0.5f});
  for (const IntegratorKind* kind : {&kPath, &kHybrid, &kWhitted}) expect_even(render(scene, kind, 2, 1), 0.125, 1e-6);
  expect_even(render(floor_under({0.1f, 0.7f, 0.999f}), &kPath, 2, 1), (1.0 - 0.1f) * (1.0 - 0.7f) * (1.0 - 0.999f),
              1e-9);
  expect_even(render(floor_under({0.5f, 1.0f}), &kPath, 2, 1), 0.0, 0.0);
  expect_even(render(floor_under({0.0f}), &kPath, 2, 1), 1.0, 1e-6);
}

TEST_F(ShadowTest, ManyPanesLeaveNothingAndBreakNothing) {
  expect_even(render(floor_under(std::vector<float>(40, 0.5f)), &kPath, 2, 1), std::exp2(-40.0), 1e-17);
  expect_even(render(floor_under(std::vector<float>(200, 0.9f)), &kPath, 2, 1), 0.0, 0.0);
}

// A tree with spatial splits holds copies of triangles, but not of panes: a ray would pay twice.
TEST_F(ShadowTest, TheTreeChangesNoBit) {
  Scene scene = floor_under({0.3f, 0.45f, 0.6f, 0.8f, 0.35f});
  for (int i = 0; i < 64; ++i) { // small things among the panes make splits pay
    const glm::dmat4 place =
        glm::translate(glm::dmat4(1.0), glm::dvec3(-2.8 + 0.35 * (i % 16), 2.5 + 0.8 * (i / 16), 2.9));
    add_instance(scene, add_mesh(scene, square(0.02f, 0.0f, true), 0), place);
  }
  const Picture fast = render(scene, &kPath, 2, 1, bvh::Quality::fast);
  for (const bvh::Quality quality : {bvh::Quality::balanced, bvh::Quality::best}) {
    const Picture other = render(scene, &kPath, 2, 1, quality);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(fast.channels[c].values, other.channels[c].values);
  }
  expect_even(fast, 0.7 * 0.55 * 0.4 * 0.2 * 0.65, 1e-6);
}

// An unlit sheet between sun and floor, and unlit walls: the floor is as bright as without.
TEST_F(ShadowTest, UnlitSurfacesNeitherShadeNorShine) {
  for (const bool over : {true, false}) {
    Scene scene = floor_under({});
    Material sign = plain_material();
    sign.unlit = true;
    sign.base_color = glm::vec4(5.0f, 5.0f, 5.0f, 1.0f);
    scene.materials.push_back(sign);
    add_instance(scene, add_mesh(scene, square(9.0f, over ? 2.0f : -1.0f, true), 1));
    for (const IntegratorKind* kind : {&kPath, &kHybrid, &kWhitted}) expect_even(render(scene, kind, 4, 3), 1.0, 1e-5);
  }
}

// What the eye sees of them is their colour; so does a mirror.
TEST_F(ShadowTest, UnlitSurfacesAreSeenByEyeAndMirror) {
  Scene scene;
  Material sign = plain_material(), mirror = plain_material();
  sign.unlit = true;
  sign.base_color = glm::vec4(0.25f, 0.25f, 0.25f, 1.0f);
  mirror.metallic = 1.0f, mirror.roughness = 0.0f;
  mirror.base_color = glm::vec4(1.0f);
  scene.materials = {sign, mirror};
  add_instance(scene, add_mesh(scene, square(1.0f, 0.0f, true), 0));
  expect_even(render(scene, &kPath, 2, 1), 0.25, 1e-6);
  scene.instances.clear();
  scene.meshes.clear();
  add_instance(scene, add_mesh(scene, square(1.0f, 0.0f, true), 1));
  add_instance(scene, add_mesh(scene, square(9.0f, 2.0f, false), 0));
  expect_even(render(scene, &kPath, 2, 1), 0.25, 1e-3);
}

} // namespace
} // namespace wavepath::test
