// Bidirectional path tracing counts the bodies on the way of every technique: those that hold the eye or a lamp, those
// that overlap, and those that only a part of a lamp is in.
#include "tests/bidirectional_scene.h"

namespace wavepath::test {
namespace {

constexpr std::uint32_t kAllButMerge = gpu::kTechniquesAll & ~kMerge;

// Its walls neither reflect nor bend light, so that path tracing finds all of it.
Material water(glm::vec3 attenuation) {
  Material m = plain_material();
  m.base_color = glm::vec4(1.0f), m.specular = 1.0f;
  m.roughness = 0.0f, m.transmission = 1.0f;
  m.volume = true, m.ior = 1.0f;
  m.attenuation = attenuation;
  return m;
}

void flood(Scene& scene, glm::vec3 lo, glm::vec3 hi, glm::vec3 attenuation = {0.3f, 0.1f, 0.6f}) {
  scene.materials.push_back(water(attenuation));
  add_box(scene, lo, hi, static_cast<std::uint32_t>(scene.materials.size() - 1));
}

TEST_F(BidirectionalTest, CameraAndLampMayBeInABody) {
  Scene scene = corner();
  add_lamp(scene, LightKind::point);
  flood(scene, {-6, -6, -6}, {6, 6, 6});
  expect_path_light(scene, 3, {kAllButMerge, kSplat, kLight, kLight | kConnect});
}

TEST_F(BidirectionalTest, ALensMayBeInABody) {
  Scene scene = corner();
  add_lamp(scene, LightKind::point);
  flood(scene, {-6, -6, -6}, {6, 6, 6});
  expect_path_light(scene, 2, {kSplat, kAllButMerge}, 32,
                    [](RenderPlan& s) { s.lens.aperture = 0.2, s.lens.focus = 3.0; });
}

TEST_F(BidirectionalTest, LightFromOutsideBeginsOutside) {
  Scene sunny = corner();
  add_lamp(sunny, LightKind::directional);
  flood(sunny, {-6, -6, -6}, {6, 6, 6}, {0.1f, 0.05f, 0.2f});
  expect_path_light(sunny, 4, {kAllButMerge, kSplat}, 64);
}

// The quad is tilted, and the water's surface cuts it.
TEST_F(BidirectionalTest, AShiningQuadMayBeHalfInABody) {
  Scene scene = corner();
  add_shining_quad(scene, 2.5f);
  flood(scene, {-6, -6, -6}, {6, 1.5f, 6}, {0.6f, 0.3f, 1.2f});
  expect_path_light(scene, 4, {kAllButMerge, kHit | kSplat, kHit | kConnect | kSplat}, 64);
}

// A bubble around the lamp, and one that overlaps with the water's surface; in the list of bodies they go before it.
TEST_F(BidirectionalTest, LampsMayBeInBodiesWithinBodies) {
  Scene scene = corner();
  add_lamp(scene, LightKind::point);
  flood(scene, {-6, -6, -6}, {6, 6, 6});
  flood(scene, {0.4f, 1.2f, 0.5f}, {1.3f, 2.0f, 1.6f}, {2.0f, 1.0f, 0.0f});
  flood(scene, {-3.0f, 1.0f, 5.0f}, {3.0f, 2.0f, 7.0f}, {1.0f, 1.0f, 1.0f});
  scene.cameras.back().yfov = 0.5; // past the bubble: splats do not pass its walls
  ASSERT_TRUE(pack(scene).features & gpu::kLobeNested);
  expect_path_light(scene, 4, {kAllButMerge, kSplat}, 256);
}

// Rough glass on the way, whose ior is that against the water around it, whichever end meets it.
TEST_F(BidirectionalTest, BodiesWithinBodiesBendLightLess) {
  Scene scene = corner();
  add_shining_quad(scene, 2.5f);
  flood(scene, {-6, -6, -6}, {6, 6, 6}, {0.2f, 0.1f, 0.3f});
  scene.materials.back().ior = 1.33f;
  Material glass = water({0.0f, 0.5f, 0.5f});
  glass.ior = 1.5f, glass.roughness = 0.4f;
  scene.materials.push_back(glass);
  add_box(scene, {-0.2f, -0.3f, 0.5f}, {0.6f, 0.4f, 1.0f}, static_cast<std::uint32_t>(scene.materials.size() - 1));
  expect_path_light(scene, 4, {kAllButMerge, kHit | kSplat, kHit | kConnect | kSplat}, 32);
}

// Photons that begin in a body, and camera paths that gather them there.
TEST_F(BidirectionalTest, MergingCountsBodies) {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  Material silver = plain_material();
  silver.metallic = 1.0f, silver.roughness = 0.0f;
  scene.materials.push_back(silver);
  add_instance(scene, add_mesh(scene, quad({-2, -0.5f, 2}, {2, -0.5f, 2}, {2, -0.5f, -1}, {-2, -0.5f, -1})));
  add_instance(scene, add_mesh(scene, quad({-2, -0.5f, -1}, {2, -0.5f, -1}, {2, 2, -1}, {-2, 2, -1}), 1));
  add_shining_quad(scene, 2.2f);
  scene.cameras.push_back(camera_at({0.2, 0.25, 1.2}));
  scene.cameras.back().yfov = 0.2;
  flood(scene, {-6, -6, -6}, {6, 6, 6}, {0.2f, 0.1f, 0.4f});
  expect_path_light(scene, 4, {gpu::kTechniquesAll, kHit | kMerge | kLight}, 32);
}

} // namespace
} // namespace wavepath::test
