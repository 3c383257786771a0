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

} // namespace
} // namespace wavepath::test
