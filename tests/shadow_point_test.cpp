// Views around point lights: a cube's faces are what spots see; paraboloids are exact where they are traced, and bend
// the edges of large triangles where they are rasterized.
#include "tests/shadow_scene.h"

#include <gtest/gtest.h>

#include "host/base/error.h"

namespace wavepath::test {
namespace {

// A lamp in the middle of a shell of boxes, seen from above: it has something to shine on in all directions.
Scene around_a_lamp(std::uint32_t cells) {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  // A floor and a board, as grids of so many cells along a side.
  const auto add_grid = [&](glm::vec3 middle, glm::vec3 u, glm::vec3 v) {
    std::vector<glm::vec3> corners;
    const float step = 1.0f / static_cast<float>(cells);
    for (std::uint32_t i = 0; i < cells * cells; ++i) {
      const float x = (2.0f * static_cast<float>(i % cells) + 1.0f) * step - 1.0f,
                  y = (2.0f * static_cast<float>(i / cells) + 1.0f) * step - 1.0f;
      for (const glm::vec3& p : rectangle(middle + x * u + y * v, step * u, step * v)) corners.push_back(p);
    }
    add_instance(scene, add_mesh(scene, corners));
  };
  add_grid({0, 0, 0}, {0, 0, 4}, {4, 0, 0});
  add_grid({0.5f, 0.7f, 0.1f}, {0, 0, 1.2f}, {0.4f, 0, 0});
  add_grid({-1.4f, 1.0f, 0.0f}, {0, 0, 0.8f}, {0, 0.6f, 0}); // upright, partly above the lamp
  scene.cameras = bodies().cameras;
  scene.lights.push_back(lamp({-0.2, 1.3, 0.2}));
  return scene;
}

class PointShadows : public ShadowTest {
protected:
  std::vector<float> picture(const Scene& scene, std::string_view technique, std::uint32_t size,
                             std::uint32_t source = kShadowSourceRaster) {
    RenderPlan settings = shadow_settings(technique, size);
    settings.shadow_source = source;
    return light(scene, settings);
  }
};

TEST_F(PointShadows, CubesConvergeToTracedShadows) {
  const Scene scene = around_a_lamp(1);
  const std::vector<float> truth = light(scene, shadow_settings("traced"));
  const double coarse = false_fractions(truth, picture(scene, "cube", 64)).total(),
               fine = false_fractions(truth, picture(scene, "cube", 1024)).total();
  EXPECT_LT(fine, 0.2 * coarse);
  EXPECT_LT(fine, 0.006);
}

// A spot that shines as wide as a face of the cube is.
TEST_F(PointShadows, AFaceOfTheCubeIsASpotsMap) {
  Scene with_lamp = bodies(), with_spot = bodies();
  PunctualLight point = lamp({-1.6, 0.7, 0.1}), cone = point;
  cone.kind = LightKind::spot;
  cone.direction = {1, 0, 0};
  cone.inner_cone = 0.7, cone.outer_cone = std::atan(1.0);
  with_lamp.lights.push_back(point);
  with_spot.lights.push_back(cone);
  const std::vector<float> of_cube = picture(with_lamp, "cube", 128), of_spot = picture(with_spot, "map", 128);
  RenderPlan unshadowed = shadow_settings("map", 128);
  unshadowed.shadow_ambient = 1.0;
  const std::vector<float> all = light(with_spot, unshadowed);
  std::size_t reached = 0, dark = 0, unlike = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i] == 0.0f) continue; // the spot does not shine there
    ++reached;
    dark += of_spot[i] == 0.0f;
    unlike += (of_cube[i] > 0.0f) != (of_spot[i] > 0.0f);
  }
  EXPECT_GT(reached, 1000u);
  EXPECT_GT(dark, 100u);
  EXPECT_EQ(unlike, 0u);
}

TEST_F(PointShadows, TracedParaboloidsConvergeToTracedShadows) {
  const Scene scene = around_a_lamp(1);
  const std::vector<float> truth = light(scene, shadow_settings("traced"));
  const double coarse = false_fractions(truth, picture(scene, "paraboloid", 64, kShadowSourceTraced)).total(),
               fine = false_fractions(truth, picture(scene, "paraboloid", 2048, kShadowSourceTraced)).total();
  EXPECT_LT(fine, 0.2 * coarse);
  EXPECT_LT(fine, 0.006);
}

TEST_F(PointShadows, ParaboloidsBendTheEdgesOfLargeTriangles) {
  double last = 1.0;
  for (const std::uint32_t cells : {1u, 4u, 16u, 64u}) {
    const Scene scene = around_a_lamp(cells);
    const std::vector<float> truth = light(scene, shadow_settings("traced"));
    const double errors = false_fractions(truth, picture(scene, "paraboloid", 1024)).total();
    EXPECT_LT(errors, last) << cells;
    EXPECT_TRUE(cells > 1 || errors > 0.05) << errors;
    last = errors;
  }
  EXPECT_LT(last, 0.01);
}

// In perspective, surfaces beside the view's axis have a slope though they face the light.
TEST_F(PointShadows, BiasEndsAcneBesideTheAxis) {
  const Scene scene = lit_by(spot());
  const std::vector<float> truth = light(scene, shadow_settings("traced"));
  for (const std::string_view kind : {"slope", "normal", "plane"}) {
    RenderPlan settings = shadow_settings("map", 1024);
    settings.shadow_bias = index_of(kShadowBiasNames, kind);
    EXPECT_LT(false_fractions(truth, light(scene, settings)).dark, 0.001) << kind;
  }
}

TEST_F(PointShadows, BiasEndsAcne) {
  const Scene scene = around_a_lamp(64);
  const std::vector<float> truth = light(scene, shadow_settings("traced"));
  for (const std::string_view technique : {"cube", "paraboloid"})
    for (const std::string_view kind : {"slope", "normal", "plane"}) { // cones stand for slopes of 1 alone
      SCOPED_TRACE(std::string(technique) + " " + std::string(kind));
      RenderPlan settings = shadow_settings(technique, 256);
      settings.shadow_source = kShadowSourceTraced;
      settings.shadow_bias = index_of(kShadowBiasNames, kind);
      EXPECT_LT(false_fractions(truth, light(scene, settings)).dark, 0.015);
    }
}

TEST_F(PointShadows, AreForPointLights) {
  for (const std::string_view technique : {"cube", "paraboloid"})
    EXPECT_THROW(render(lit_by(sun()), shadow_settings(technique, 64)), Error);
}

} // namespace
} // namespace wavepath::test
