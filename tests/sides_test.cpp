// Single-sided surfaces: the camera sees through them from behind, light does not; --cull says otherwise.
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/integrators/bidirectional/kind.h"
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

// Counter-clockwise seen from above.
std::vector<glm::vec3> square(float half, float y) {
  const glm::vec3 a{-half, y, -half}, b{half, y, -half}, c{half, y, half}, d{-half, y, half};
  return {a, c, b, a, d, c};
}

std::uint32_t add_material(Scene& scene, bool double_sided, float albedo = 1.0f, float emission = 0.0f) {
  Material material = plain_material();
  material.base_color = glm::vec4(glm::vec3(albedo), 1.0f);
  material.emission = glm::vec3(emission);
  material.double_sided = double_sided;
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

void add_sun(Scene& scene) { // of pi lux: a white floor under it has radiance 1
  PunctualLight sun;
  sun.kind = LightKind::directional;
  sun.direction = {0, -1, 0};
  sun.intensity = glm::vec3(std::numbers::pi_v<float>);
  scene.lights.push_back(sun);
}

// A white floor under a single-sided roof that faces the sky; a shining ceiling high above both.
Scene roofed_floor() {
  Scene scene;
  scene.path = "test";
  add_instance(scene, add_mesh(scene, square(10.0f, 0.0f), add_material(scene, true)));
  add_instance(scene, add_mesh(scene, square(3.0f, 2.0f), add_material(scene, false)));
  return scene;
}

class Sides : public VulkanTest {
protected:
  static inline std::unique_ptr<KernelCompiler> kernels_;
  static void TearDownTestSuite() { kernels_.reset(); }

  static RenderPlan settings(std::uint32_t cull, const IntegratorKind& integrator = kPath, std::uint32_t depth = 1) {
    RenderPlan asked;
    asked.width = asked.height = 8;
    asked.last_sample = 16;
    asked.max_depth = depth;
    asked.filter = gpu::kFilterBox;
    asked.integrator = &integrator;
    asked.cull = cull;
    if (asked.integrator == &kHybrid) asked.ambient = glm::vec3(0.0f);
    return asked;
  }
  Picture render(Scene scene, const RenderPlan& asked, const glm::dvec3& eye, const glm::dvec3& target) {
    if (!kernels_) kernels_ = std::make_unique<KernelCompiler>(device());
    ViewRequest request;
    request.eye = eye, request.look_at = target, request.up = glm::dvec3(0, 0, 1), request.yfov = 0.3;
    const View view = resolve_view(scene, request, asked.width, asked.height);
    const PackedScene packed = pack(scene);
    return wavepath::render(device(), packed, view, asked, RenderHooks{}, *kernels_).picture;
  }
  static void expect_all(const Picture& picture, float value, float tolerance = 1e-4f) {
    for (const float v : picture.channels[0].values) ASSERT_NEAR(v, value, tolerance);
  }
};

const std::vector<const IntegratorKind*> kAllKinds = {&kPath, &kWhitted, &kBidirectional, &kHybrid};
const glm::dvec3 kBelow{0, 1, 0}, kFloor{0, 0, 0}, kRoof{0, 2, 0};

TEST_F(Sides, ARoofThatFacesTheSunThrowsItsShadow) {
  Scene scene = roofed_floor();
  add_sun(scene);
  for (const IntegratorKind* kind : kAllKinds) {
    SCOPED_TRACE(kind->name);
    // Of light paths, splats alone are told apart in the sum by being few: their noise is that of where they fall.
    const float noise = kind == &kBidirectional ? 0.2f : 1e-4f;
    expect_all(render(scene, settings(gpu::kCullCamera, *kind), kBelow, kFloor), 0.0f);
    expect_all(render(scene, settings(gpu::kCullAll, *kind), kBelow, kFloor), 1.0f, noise);
    if (kind != &kBidirectional) // whose kernels take long to compile
      expect_all(render(scene, settings(gpu::kCullNone, *kind), kBelow, kFloor), 0.0f);
  }
}

// The roof's front reflects the sun to a camera above it in any case.
TEST_F(Sides, TheFrontIsLitWhateverIsCulled) {
  Scene scene = roofed_floor();
  add_sun(scene);
  for (const IntegratorKind* kind : {&kPath, &kWhitted, &kHybrid})
    for (const std::uint32_t cull : {gpu::kCullCamera, gpu::kCullAll, gpu::kCullNone})
      expect_all(render(scene, settings(cull, *kind), {0, 5, 0}, kRoof), 1.0f);
}

TEST_F(Sides, TheCameraSeesThroughTheRoofFromBelow) {
  Scene scene = roofed_floor();
  add_instance(scene, add_mesh(scene, square(30.0f, 4.0f), add_material(scene, true, 0.0f, 3.0f)));
  for (const IntegratorKind* kind : kAllKinds) {
    SCOPED_TRACE(kind->name);
    expect_all(render(scene, settings(gpu::kCullCamera, *kind, 0), kBelow, kRoof), 3.0f);
    if (kind != &kBidirectional) expect_all(render(scene, settings(gpu::kCullAll, *kind, 0), kBelow, kRoof), 3.0f);
    expect_all(render(scene, settings(gpu::kCullNone, *kind, 0), kBelow, kRoof), 0.0f);
  }
}

// A mirror shows what light does: the roof.
TEST_F(Sides, AMirrorDoesNotSeeThroughTheRoof) {
  Scene scene = roofed_floor();
  scene.materials[0].metallic = 1.0f, scene.materials[0].roughness = 0.0f;
  add_instance(scene, add_mesh(scene, square(30.0f, 4.0f), add_material(scene, true, 0.0f, 3.0f)));
  expect_all(render(scene, settings(gpu::kCullCamera, kBidirectional), kBelow, kFloor), 0.0f);
  for (const IntegratorKind* kind : {&kPath, &kWhitted}) {
    SCOPED_TRACE(kind->name);
    expect_all(render(scene, settings(gpu::kCullCamera, *kind), kBelow, kFloor), 0.0f);
    expect_all(render(scene, settings(gpu::kCullAll, *kind), kBelow, kFloor), 3.0f, 1e-2f);
    expect_all(render(scene, settings(gpu::kCullNone, *kind), kBelow, kFloor), 0.0f);
  }
}

// Its material is that of the front, lit on the side that is seen: here by a lamp where the camera is.
TEST_F(Sides, TheBackShadesAsTheFrontDoes) {
  Scene scene = roofed_floor();
  PunctualLight lamp;
  lamp.position = kBelow;
  lamp.intensity = glm::vec3(2.0f);
  scene.lights.push_back(lamp);
  for (const IntegratorKind* kind : {&kPath, &kWhitted, &kHybrid}) {
    RenderPlan asked = settings(gpu::kCullNone, *kind);
    asked.width = asked.height = 1;
    const Picture back = render(scene, asked, {0, 1.999, 0}, kRoof); // of a roof 1 m away from the lamp
    expect_all(back, 2.0f * std::numbers::inv_pi_v<float>, 1e-3f);
  }
}

// A room of single-sided walls that face outwards, a lamp in it, and a panel that fills the picture: no camera ray
// meets a back, and all light is that of a room of double-sided walls, to the last bit. A bright sky outside stays
// there.
TEST_F(Sides, ARoomKeepsItsLightWhicheverWayItsWallsFace) {
  const auto room = [](bool double_sided) {
    Scene scene;
    scene.path = "test";
    const std::uint32_t walls = add_material(scene, double_sided, 0.8f), panel = add_material(scene, true, 0.5f);
    const std::uint32_t wall = add_mesh(scene, square(2.0f, 2.0f), walls);
    for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1)})
      for (int quarter = 0; quarter < 4; ++quarter)
        if (axis.x == 1.0 || quarter % 2 == 1)
          add_instance(scene, wall, glm::rotate(glm::dmat4(1.0), quarter * 0.5 * std::numbers::pi, axis));
    add_instance(scene, add_mesh(scene, square(1.0f, -1.0f), panel));
    PunctualLight lamp;
    lamp.position = {0.3, 0.5, 0.2};
    lamp.intensity = glm::vec3(3.0f);
    scene.lights.push_back(lamp);
    scene.environment.radiance = glm::vec3(100.0f);
    return scene;
  };
  for (const IntegratorKind* kind : {&kPath, &kBidirectional}) {
    SCOPED_TRACE(kind->name);
    const Picture solid = render(room(true), settings(gpu::kCullAll, *kind, 6), {0, 0, 0}, {0, -1, 0});
    for (const std::uint32_t cull : {gpu::kCullCamera, gpu::kCullNone}) {
      if (kind == &kBidirectional && cull == gpu::kCullNone) continue; // its kernels take long to compile
      EXPECT_EQ(render(room(false), settings(cull, *kind, 6), {0, 0, 0}, {0, -1, 0}).channels[0].values,
                solid.channels[0].values);
    }
    const Picture open = render(room(false), settings(gpu::kCullAll, *kind, 6), {0, 0, 0}, {0, -1, 0});
    EXPECT_GT(open.channels[0].values[0], 10.0f * solid.channels[0].values[0]) << "the sky should come in";
  }
}

TEST_F(Sides, GenericKernelsGiveTheSameBits) {
  Scene scene = roofed_floor();
  add_sun(scene);
  scene.environment.radiance = glm::vec3(0.5f);
  for (const std::uint32_t cull : {gpu::kCullCamera, gpu::kCullAll, gpu::kCullNone}) {
    RenderPlan asked = settings(cull, kPath, 4);
    const auto expected = render(scene, asked, {0, 1, 4}, kRoof).channels[0].values;
    asked.specialize = false;
    EXPECT_EQ(render(scene, asked, {0, 1, 4}, kRoof).channels[0].values, expected);
  }
}

} // namespace
} // namespace wavepath::test
