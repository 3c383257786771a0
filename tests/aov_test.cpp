// What channels tell of the surface that a pixel shows, by every integrator.
#include "tests/shadow_scene.h"

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/render/settings/integrator_kind.h"

namespace wavepath::test {
namespace {

constexpr std::uint32_t kWidth = 32, kHeight = 24;

// Seen from above: a floor, and on either side of its middle a square of another material; both squares are one mesh.
Scene squares() {
  Scene scene;
  scene.path = "test";
  for (const auto& [roughness, metallic] : {std::pair{1.0f, 0.0f}, {0.25f, 1.0f}, {0.5f, 0.0f}}) {
    Material material = plain_material();
    material.roughness = roughness;
    material.metallic = metallic;
    scene.materials.push_back(material);
  }
  scene.lights.push_back(lamp({0.0, 2.0, 0.0}));
  add_instance(scene, add_mesh(scene, rectangle({0, 0, 0}, {0, 0, 2}, {2, 0, 0})));
  std::vector<glm::vec3> two = rectangle({-0.5f, 0.5f, 0}, {0, 0, 0.25f}, {0.25f, 0, 0});
  const std::uint32_t mesh = add_mesh(scene, two, 1);
  add_instance(scene, mesh);
  add_instance(scene, mesh, glm::translate(glm::dmat4(1.0), {1.0, 0.0, 0.0}));
  add_instance(scene, add_mesh(scene, rectangle({0, 0.5f, 0.6f}, {0, 0, 0.1f}, {0.5f, 0, 0}), 2));
  scene.cameras.push_back(camera_above({0, 0, 0}, 0.9));
  return scene;
}

class AovTest : public ShadowTest {
protected:
  Picture picture(const Scene& scene, const IntegratorKind* integrator, std::uint32_t samples) {
    RenderPlan settings;
    settings.integrator = integrator;
    settings.width = kWidth, settings.height = kHeight;
    settings.last_sample = samples;
    settings.max_depth = 1;
    settings.aovs = {"roughness", "metallic", "ids", "position"};
    return render(scene, settings).picture;
  }
};

TEST_F(AovTest, TellWhichSurfaceIsSeen) {
  const Scene scene = squares();
  for (const IntegratorKind* integrator : integrators()) {
    SCOPED_TRACE(integrator->name);
    const Picture seen = picture(scene, integrator, 1);
    const auto &x = channel(seen, "P.X"), &y = channel(seen, "P.Y"), &z = channel(seen, "P.Z");
    const auto &roughness = channel(seen, "roughness"), &metallic = channel(seen, "metallic");
    const auto &material = channel(seen, "id.material"), &instance = channel(seen, "id.instance");
    const auto& triangle = channel(seen, "id.triangle");
    std::size_t counts[3] = {};
    for (std::size_t i = 0; i < x.size(); ++i) {
      const std::size_t expected = y[i] < 0.25f ? 0 : z[i] < 0.4f ? 1 : 2;
      ++counts[expected];
      ASSERT_EQ(material[i], static_cast<float>(expected)) << i;
      ASSERT_NEAR(roughness[i], scene.materials[expected].roughness, 1e-6f);
      ASSERT_EQ(metallic[i], scene.materials[expected].metallic);
      const float place[] = {0.0f, x[i] < 0.0f ? 1.0f : 2.0f, 0.0f}; // 0: whatever is placed once
      ASSERT_EQ(instance[i], place[expected]);
      const float first = expected == 2 ? 2.0f : 0.0f; // of the two, among what is placed once or in the mesh
      ASSERT_TRUE(triangle[i] == first || triangle[i] == first + 1.0f) << triangle[i];
    }
    for (const std::size_t count : counts) EXPECT_GT(count, 10u);
  }
}

// Numbers have no mean: a pixel at an edge keeps one of them. What is nothing has none.
TEST_F(AovTest, KeepIdsWhole) {
  Scene scene = squares();
  scene.instances.erase(scene.instances.begin());
  for (const IntegratorKind* integrator : integrators()) {
    if (!integrator->finds_light) continue;
    SCOPED_TRACE(integrator->name);
    const Picture seen = picture(scene, integrator, 16);
    std::size_t nothing = 0, mixed = 0;
    for (std::size_t i = 0; i < seen.channels[0].values.size(); ++i) {
      const float id = channel(seen, "id.material")[i], metallic = channel(seen, "metallic")[i];
      ASSERT_TRUE(id == -1.0f || id == 0.0f || id == 1.0f) << id; // materials that nothing has are not counted
      nothing += id < 0.0f;
      mixed += metallic > 0.0f && metallic < 1.0f;
    }
    EXPECT_GT(nothing, 100u);
    EXPECT_EQ(mixed, 0u); // squares do not touch, and what misses them counts for nothing
  }
}

// Seen from above: a gilded mirror beside a red floor that a pane covers. On the left, high above the camera, a blue
// ceiling: a mirror there shows it, and the pane a little of it.
Scene mirror_and_pane() {
  Scene scene;
  scene.path = "test";
  const auto add = [&](const glm::vec3& color, const std::vector<glm::vec3>& corners) -> Material& {
    Material material = plain_material();
    material.base_color = glm::vec4(color, 1.0f);
    scene.materials.push_back(material);
    add_instance(scene, add_mesh(scene, corners, static_cast<std::uint32_t>(scene.materials.size() - 1)));
    return scene.materials.back();
  };
  Material& mirror = add({0.9f, 0.5f, 0.3f}, rectangle({0, 0, -1}, {0, 0, 1}, {2, 0, 0}));
  mirror.metallic = 1.0f, mirror.roughness = 0.0f;
  add({0.8f, 0.1f, 0.2f}, rectangle({0, 0, 1}, {0, 0, 1}, {2, 0, 0}));
  Material& pane = add({1, 1, 1}, rectangle({0, 0.2f, 1}, {0, 0, 1}, {2, 0, 0}));
  pane.transmission = 1.0f, pane.roughness = 0.0f, pane.specular = 1.0f;
  add({0.2f, 0.4f, 0.8f}, rectangle({-1, 5, 0}, {0, 0, 2}, {1, 0, 0}));
  scene.lights.push_back(lamp({0.0, 2.0, 0.0}));
  scene.cameras.push_back(camera_above({0, 0, 0}, 0.9));
  return scene;
}

// A surface is that which a mirror or a pane shows, with their tint. Depth, position and light stay.
TEST_F(AovTest, FollowMirrorsAndGlassWhereAsked) {
  RenderPlan settings;
  settings.integrator = find_integrator("path");
  settings.width = kWidth, settings.height = kHeight;
  settings.last_sample = 256;
  settings.filter = gpu::kFilterBox;
  settings.max_depth = 4;
  settings.aovs = {"albedo", "normal", "depth", "position"};
  const Scene scene = mirror_and_pane();
  const Picture plain = render(scene, settings).picture;
  settings.aov_through = true;
  const Picture through = render(scene, settings).picture;
  settings.specialize = false;
  const Picture generic = render(scene, settings).picture;
  for (const char* same : {"R", "G", "B", "Z", "P.X", "P.Y", "P.Z"}) {
    EXPECT_EQ(channel(plain, same), channel(through, same)) << same;
    EXPECT_EQ(channel(generic, same), channel(through, same)) << same;
  }
  for (const char* near : {"albedo.R", "albedo.G", "albedo.B", "N.X", "N.Y", "N.Z"})
    for (std::size_t i = 0; i < kWidth * kHeight; ++i)
      ASSERT_NEAR(channel(generic, near)[i], channel(through, near)[i], 1e-5) << near; // means are rounded

  const glm::vec3 tint(0.9f, 0.5f, 0.3f), red(0.8f, 0.1f, 0.2f), blue(0.2f, 0.4f, 0.8f);
  const float reflected = 2.0f * 0.04f / 1.04f; // by both faces of a pane
  const auto at = [&](const Picture& picture, std::uint32_t x, std::uint32_t y, const char* r, const char* g,
                      const char* b) {
    const std::size_t i = std::size_t{y} * kWidth + x;
    return glm::vec3(channel(picture, r)[i], channel(picture, g)[i], channel(picture, b)[i]);
  };
  const auto albedo = [&](const Picture& p, std::uint32_t x, std::uint32_t y) {
    return at(p, x, y, "albedo.R", "albedo.G", "albedo.B");
  };
  const auto normal = [&](const Picture& p, std::uint32_t x, std::uint32_t y) {
    return at(p, x, y, "N.X", "N.Y", "N.Z");
  };
  const std::uint32_t left = 8, right = 24, mirror = 6, pane = 18;
  const auto expect_near = [](const glm::vec3& found, const glm::vec3& expected, float tolerance, const char* what) {
    EXPECT_LT(glm::length(found - expected), tolerance) << what << " " << found.x << " " << found.y << " " << found.z;
  };
  expect_near(albedo(plain, left, mirror), tint, 1e-4f, "mirror");
  expect_near(albedo(through, left, mirror), tint * blue, 1e-4f, "mirror that shows the ceiling");
  expect_near(normal(through, left, mirror), {0, -1, 0}, 1e-4f, "the ceiling's normal");
  expect_near(albedo(through, right, mirror), tint, 1e-4f, "mirror that shows nothing");
  expect_near(normal(through, right, mirror), {0, 1, 0}, 1e-4f, "the mirror's own normal");
  expect_near(albedo(plain, left, pane), glm::vec3(1.0f), 1e-4f, "pane");
  expect_near(albedo(through, left, pane), glm::mix(red, blue, reflected), 0.05f, "floor, and the ceiling in the pane");
  expect_near(albedo(through, right, pane), glm::mix(red, glm::vec3(1.0f), reflected), 0.05f, "floor behind the pane");
}

} // namespace
} // namespace wavepath::test
