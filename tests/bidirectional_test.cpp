// Bidirectional path tracing: every technique alone and every set of them finds the light that path tracing finds, and
// also what that cannot find; nothing depends on how the work is cut up.
#include <numbers>

#include "host/film/error.h"
#include "host/render/workspace/workspace.h"
#include "host/scene/gltf/gltf.h"
#include "tests/bidirectional_scene.h"

namespace wavepath::test {
namespace {

const std::string kScenes = std::string(WAVEPATH_SOURCE_DIR) + "/scenes/";

TEST_F(BidirectionalTest, FindsTheLightOfTheCornellBoxInEveryWay) {
  expect_path_light(
      load_gltf(kScenes + "cornell_box.gltf", {}), 4,
      {gpu::kTechniquesAll, kHit | kLight, kHit | kSplat, kHit | kConnect | kLight, kHit | kConnect | kSplat});
}

constexpr std::uint32_t kAllButMerge = gpu::kTechniquesAll & ~kMerge;

// Where all surfaces are rough, each technique but connecting two vertices finds all light by itself.
TEST_F(BidirectionalTest, EverySetFindsTheLightOfAQuad) {
  Scene scene = corner();
  add_shining_quad(scene, 2.5f);
  expect_path_light(scene, 3, sets_of(kAllButMerge, kLight | kSplat));
  expect_path_light(scene, 3, {kHit, kHit | kConnect}, 128);
}

// Nothing meets a lamp by chance, and weights know it.
TEST_F(BidirectionalTest, EverySetFindsTheLightOfAllLightsAtOnce) {
  Scene scene = corner();
  add_sky(scene);
  add_shining_quad(scene);
  add_lamp(scene, LightKind::point);
  expect_path_light(scene, 3, sets_of(kAllButMerge, kLight | kSplat));
}

// By connections alone, all light is found that was scattered twice or more, and what the camera sees of lights.
TEST_F(BidirectionalTest, ConnectionsAloneFindIndirectLight) {
  Scene scene = corner();
  add_shining_quad(scene, 2.5f);
  const RenderPlan asked = settings(128, 3, kConnect);
  const Subject subject(scene, asked);
  Average expected = average(subject, path_settings(512, 3));
  const Average once = average(subject, path_settings(512, 1)), seen = average(subject, path_settings(512, 0));
  for (std::size_t i = 0; i < kParts; ++i) {
    expected.mean[i] += seen.mean[i] - once.mean[i];
    expected.variance[i] += seen.variance[i] + once.variance[i];
  }
  expect_same_mean(average(subject, asked), expected, 0.1);
}

TEST_F(BidirectionalTest, FindsTheLightOfLamps) {
  for (const LightKind kind : {LightKind::point, LightKind::spot, LightKind::directional}) {
    SCOPED_TRACE(static_cast<int>(kind));
    Scene scene = corner();
    add_lamp(scene, kind);
    expect_path_light(scene, 3, {gpu::kTechniquesAll, kSplat, kLight, kLight | kConnect});
  }
}

TEST_F(BidirectionalTest, FindsTheLightOfASky) {
  Scene scene = corner();
  add_sky(scene);
  expect_path_light(scene, 3, {gpu::kTechniquesAll, kHit | kSplat, kHit | kLight | kConnect}, 64);
}

TEST_F(BidirectionalTest, FindsTheLightOfManyLightsAtOnce) {
  Scene scene = corner();
  add_sky(scene);
  add_shining_quad(scene);
  add_lamp(scene, LightKind::spot);
  expect_path_light(scene, 4, {gpu::kTechniquesAll, kHit | kLight | kSplat}, 64);
}

TEST_F(BidirectionalTest, AnOrthographicCameraSeesTheSameLight) {
  Scene scene = corner(true);
  add_shining_quad(scene, 2.5f);
  expect_path_light(scene, 3, {gpu::kTechniquesAll, kHit | kSplat, kHit | kConnect | kLight});
}

// Out of focus, so that every point is seen by way of all of the lens.
TEST_F(BidirectionalTest, ALensSeesTheSameLight) {
  for (const bool orthographic : {false, true}) {
    const std::uint32_t blades = orthographic ? 5 : 0;
    SCOPED_TRACE(testing::Message() << (orthographic ? "orthographic, " : "perspective, ") << blades << " blades");
    Scene scene = corner(orthographic);
    add_shining_quad(scene, 2.5f);
    add_lamp(scene, LightKind::point);
    expect_path_light(
        scene, 3, {gpu::kTechniquesAll, kSplat | kHit, kHit | kConnect | kLight}, 64,
        [&](RenderPlan& asked) { asked.lens.aperture = 0.6, asked.lens.focus = 2.0, asked.lens.blades = blades; });
  }
}

TEST_F(BidirectionalTest, LightFadesWithinItsRange) {
  for (const LightKind kind : {LightKind::point, LightKind::spot}) {
    Scene scene = corner();
    add_lamp(scene, kind);
    scene.lights[0].range = 4.5;
    expect_path_light(scene, 3, {gpu::kTechniquesAll, kSplat, kLight | kConnect});
  }
}

// Single-sided surfaces let rays of the camera pass from behind, or all rays of paths, which light then passes the
// other way.
class BidirectionalSides : public BidirectionalTest, public testing::WithParamInterface<std::uint32_t> {};
INSTANTIATE_TEST_SUITE_P(Cull, BidirectionalSides, testing::Values(gpu::kCullCamera, gpu::kCullAll, gpu::kCullNone));

TEST_P(BidirectionalSides, HideTheSameLightFromBothEnds) {
  Scene scene = corner();
  add_lamp(scene, LightKind::point);
  Material sheet = plain_material();
  sheet.double_sided = false;
  scene.materials.push_back(sheet);
  const auto material = static_cast<std::uint32_t>(scene.materials.size() - 1);
  // One faces the lamp, the other one the floor: the first lets the camera see through from below, the second from
  // above.
  add_instance(scene,
               add_mesh(scene, quad({-1, 0.6f, 1}, {0, 0.6f, 1}, {0, 0.6f, -0.5f}, {-1, 0.6f, -0.5f}), material));
  add_instance(scene, add_mesh(scene, quad({1, 0.1f, 1}, {0, 0.1f, 1}, {0, 0.1f, -0.5f}, {1, 0.1f, -0.5f}), material));
  expect_path_light(scene, 3, {gpu::kTechniquesAll, kSplat, kLight | kConnect}, 64,
                    [](RenderPlan& asked) { asked.cull = GetParam(); });
}

// Unlit surfaces are there for the eye and for mirrors: light passes them, but what a mirror shows them hide.
TEST_F(BidirectionalTest, LightPassesUnlitSurfacesButNotTowardsMirrors) {
  Scene scene = corner();
  scene.materials[1].roughness = 0.0f;
  add_shining_quad(scene, 2.5f);
  Material unlit = plain_material();
  unlit.unlit = true;
  scene.materials.push_back(unlit);
  add_instance(scene, add_mesh(scene, quad({-1, 0.5f, 0.8f}, {0.3f, 0.5f, 0.8f}, {0.3f, 0.5f, 0.0f}, {-1, 0.5f, 0.0f}),
                               static_cast<std::uint32_t>(scene.materials.size() - 1)));
  expect_path_light(scene, 3, {gpu::kTechniquesAll, kHit | kSplat, kHit | kConnect | kLight}, 128);
}

// Clear glass: of the light behind it path tracing finds that of the quad alone.
TEST_F(BidirectionalTest, FindsTheLightBehindGlass) {
  Scene scene = corner();
  add_shining_quad(scene, 2.5f);
  Material glass = plain_material();
  glass.transmission = 1.0f, glass.specular = 1.0f, glass.roughness = 0.0f;
  glass.base_color = glm::vec4(1.0f);
  glass.volume = true;
  glass.attenuation = {0.5f, 0.1f, 1.0f};
  scene.materials.push_back(glass);
  const auto material = static_cast<std::uint32_t>(scene.materials.size() - 1);
  add_box(scene, {-1, 0.5f, -0.5f}, {1, 0.7f, 1}, material);
  expect_path_light(scene, 4, {gpu::kTechniquesAll, kHit | kSplat}, 64);
}

// A sun above a pane over a floor: paths from the camera cannot find it. At normal incidence each face lets 1 - ((n -
// 1) / (n + 1))^2 pass, and in three bounces there is no other way.
TEST_F(BidirectionalTest, SunThroughAPaneHasItsExactValue) {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  Material glass = plain_material();
  glass.transmission = 1.0f, glass.specular = 1.0f, glass.roughness = 0.0f;
  glass.base_color = glm::vec4(1.0f);
  glass.volume = true;
  scene.materials.push_back(glass);
  add_instance(scene, add_mesh(scene, quad({-0.6f, 0, 0.6f}, {0.6f, 0, 0.6f}, {0.6f, 0, -0.6f}, {-0.6f, 0, -0.6f})));
  add_box(scene, {-0.8f, 1.1f, -0.8f}, {0.8f, 1.2f, 0.8f}, 1);
  PunctualLight sun;
  sun.kind = LightKind::directional;
  sun.intensity = glm::vec3(3.0f, 2.0f, 1.0f);
  sun.direction = {0.0, -1.0, 0.0};
  scene.lights.push_back(sun);
  scene.cameras.push_back(camera_at({0.0, 0.8, 0.6}));
  scene.cameras.back().yfov = 0.4;
  const RenderPlan all = settings(64, 3);
  const Subject subject(std::move(scene), all);
  const Average found = average(subject, all);
  const double expected = 2.0 * 0.5 / std::numbers::pi * std::pow(1.0 - 0.2 * 0.2, 2.0); // R, G and B on average
  EXPECT_NEAR(found.mean[0], 3.0 * expected, 4.6 * std::sqrt(found.variance[0]) + 1e-4 * expected);
  EXPECT_LT(std::sqrt(found.variance[0]), 0.01 * expected);
  const RenderResult path = render(subject, path_settings(16, 3));
  for (const float value : path.picture.channels[0].values) EXPECT_EQ(value, 0.0f);
}

TEST_F(BidirectionalTest, EveryFilterGivesTheSameLight) {
  for (const std::uint32_t filter : {gpu::kFilterBox, gpu::kFilterGaussian}) {
    SCOPED_TRACE(filter);
    Scene scene = corner();
    add_lamp(scene, LightKind::point);
    RenderPlan path = path_settings(128, 2), splats = settings(64, 2, kSplat);
    path.filter = splats.filter = filter;
    const Subject subject(std::move(scene), path);
    expect_same_mean(average(subject, splats), average(subject, path));
  }
}

TEST_F(BidirectionalTest, HowTheWorkIsCutUpDoesNotMatter) {
  RenderPlan whole = settings(3, 5);
  whole.aovs = {"albedo", "normal", "depth", "emission"};
  Scene showcase = load_gltf(kScenes + "showcase.glb", {});
  add_sky(showcase);
  const Subject subject(std::move(showcase), whole);
  const RenderResult expected = render(subject, whole);
  ASSERT_FALSE(expected.film->splats.empty());
  expect_same_film_however_cut(subject, whole, *expected.film);
}

// Halves of the samples, joined, are the whole: the light that paths of one bring to pixels of the other included.
TEST_F(BidirectionalTest, FilmsJoinWithoutLoss) {
  RenderPlan whole = settings(6, 3);
  const Subject subject(load_gltf(kScenes + "cornell_box.gltf", {}), whole);
  RenderPlan first = whole, second = whole;
  first.last_sample = second.first_sample = 3;
  first.sample_total = second.sample_total = 6;
  Film film = *render(subject, second).film;
  join(film, *render(subject, first).film);
  EXPECT_TRUE(film == *render(subject, whole).film);
}

// The error is estimated from two replicates, of which each has the light of its own light paths.
TEST_F(BidirectionalTest, TheEstimatedErrorCoversTheTrueOne) {
  Scene scene = corner();
  add_lamp(scene, LightKind::spot);
  const RenderPlan path = path_settings(4096, 3);
  const Subject subject(std::move(scene), path);
  const Picture reference = render(subject, path).picture;
  expect_intervals_cover(subject, reference, settings(32, 3, kSplat));
}

// Nothing of light paths exists where they are not asked for, and what is asked for fits into an eighth of the device's
// memory.
TEST_F(BidirectionalTest, LightVerticesAreCounted) {
  RenderPlan deep = settings(4, 9), shallow = settings(4, 1);
  const std::uint64_t vertices = kBidirectional.bytes_per_slot(0, deep) - kBidirectional.bytes_per_slot(0, shallow);
  EXPECT_EQ(vertices, 8 * sizeof(gpu::LightVertex) + sizeof(float)); // and whether the path merges
  EXPECT_LE(sizeof(gpu::LightVertex), 64u);
  deep.width = 4096, deep.height = 4096;
  const Subject subject(corner(), deep);
  DeviceInfo small = device().info();
  small.memory_bytes = std::uint64_t{64} << 20;
  const std::uint64_t slots = choose_slots(small, subject.packed.features, deep);
  EXPECT_LE(slots * kBidirectional.bytes_per_slot(subject.packed.features, deep), small.memory_bytes / 8);
  EXPECT_TRUE(render(Subject(corner(), shallow), path_settings(1, 1)).film->splats.empty());
}

} // namespace
} // namespace wavepath::test
