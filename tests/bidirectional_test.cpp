// Bidirectional path tracing: every technique alone and every set of them finds the light that path tracing finds, and
// also what that cannot find; nothing depends on how the work is cut up.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/film/error.h"
#include "host/film/film.h"
#include "host/integrators/bidirectional/kind.h"
#include "host/integrators/bidirectional/photon_map.h"
#include "host/integrators/path/kind.h"
#include "host/render/device/kernel_compiler.h"
#include "host/render/device/workspace.h"
#include "host/render/render.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/pack.h"
#include "host/scene/view.h"
#include "tests/scene_builder.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

constexpr std::uint32_t kHit = gpu::kTechniqueHit, kLight = gpu::kTechniqueLight, kConnect = gpu::kTechniqueConnect,
                        kSplat = gpu::kTechniqueSplat, kMerge = gpu::kTechniqueMerge;
const std::string kScenes = std::string(WAVEPATH_SOURCE_DIR) + "/scenes/";

std::vector<glm::vec3> quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) { return {a, b, c, a, c, d}; }

// A camera at `eye` that looks at the origin, +Y up.
Camera camera_at(const glm::dvec3& eye, bool orthographic = false) {
  Camera camera;
  const glm::dvec3 back = glm::normalize(eye), right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back));
  camera.world_from_camera =
      glm::dmat4(glm::dvec4(right, 0), glm::dvec4(glm::cross(back, right), 0), glm::dvec4(back, 0), glm::dvec4(eye, 1));
  camera.orthographic = orthographic;
  camera.xmag = 1.2, camera.ymag = 0.8;
  return camera;
}

// A floor, a wall and a glossy metal plate that leans between them; without lights.
Scene corner(bool orthographic = false) {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  Material gloss = plain_material();
  gloss.metallic = 1.0f, gloss.roughness = 0.5f;
  gloss.base_color = {0.9f, 0.7f, 0.4f, 1.0f};
  scene.materials.push_back(gloss);
  add_instance(scene, add_mesh(scene, quad({-2, -0.5f, 2}, {2, -0.5f, 2}, {2, -0.5f, -1}, {-2, -0.5f, -1})));
  add_instance(scene, add_mesh(scene, quad({-2, -0.5f, -1}, {2, -0.5f, -1}, {2, 2, -1}, {-2, 2, -1})));
  add_instance(
      scene,
      add_mesh(scene, quad({-0.6f, -0.5f, 0.2f}, {0.4f, -0.5f, 0.4f}, {0.4f, 0.3f, -0.2f}, {-0.6f, 0.3f, -0.4f}), 1));
  scene.cameras.push_back(camera_at({0.4, 0.8, 3.5}, orthographic));
  return scene;
}

void add_lamp(Scene& scene, LightKind kind) {
  PunctualLight light;
  light.kind = kind;
  light.intensity = kind == LightKind::directional ? glm::vec3(2.0f, 1.5f, 1.0f) : glm::vec3(4.0f, 3.0f, 2.0f);
  light.position = {0.8, 1.5, 1.0};
  light.direction = glm::normalize(glm::dvec3(-0.4, -1.0, -0.5));
  light.outer_cone = 0.9;
  scene.lights.push_back(light);
}

void add_shining_quad(Scene& scene, float size = 1.0f) {
  Material shining = plain_material();
  shining.emission = {6.0f, 5.0f, 4.0f};
  scene.materials.push_back(shining);
  add_instance(scene, add_mesh(scene,
                               quad({-0.4f * size, 1.4f, 0.2f}, {0.3f * size, 1.4f, 0.2f},
                                    {0.3f * size, 1.6f, 0.8f * size}, {-0.4f * size, 1.6f, 0.8f * size}),
                               static_cast<std::uint32_t>(scene.materials.size() - 1)));
}

// Two quads whose emission is a picture: dark, with a few bright texels.
void add_pictures(Scene& scene) {
  Material picture = plain_material();
  picture.emission = {8.0f, 8.0f, 6.0f};
  picture.emission_texture.image = static_cast<std::uint32_t>(scene.images.size());
  scene.images.push_back({"picture", 64, 64, {}, {}});
  for (std::uint32_t i = 0; i < 64 * 64; ++i) {
    const std::uint8_t grey = i / 64 / 8 % 3 == 0 && i % 64 / 8 % 4 == 1 ? 255 : 10;
    scene.images.back().bytes.insert(scene.images.back().bytes.end(), {grey, grey, grey, 255});
  }
  scene.materials.push_back(picture);
  for (const float x : {-1.5f, 0.6f}) {
    const std::uint32_t mesh =
        add_mesh(scene, quad({x, 1.2f, 0.2f}, {x + 0.8f, 1.2f, 0.2f}, {x + 0.8f, 1.6f, 0.9f}, {x, 1.6f, 0.9f}),
                 static_cast<std::uint32_t>(scene.materials.size() - 1));
    scene.meshes[mesh].uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    add_instance(scene, mesh);
  }
}

void add_box(Scene& scene, glm::vec3 lo, glm::vec3 hi, std::uint32_t material) {
  std::vector<glm::vec3> all;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      glm::vec3 corners[4];
      for (int i = 0; i < 4; ++i) {
        corners[i][axis] = upper ? hi[axis] : lo[axis];
        corners[i][u] = (i == 1 || i == 2) == upper ? hi[u] : lo[u]; // counter-clockwise from outside
        corners[i][v] = i >= 2 ? hi[v] : lo[v];
      }
      for (const glm::vec3& p : quad(corners[0], corners[1], corners[2], corners[3])) all.push_back(p);
    }
  add_instance(scene, add_mesh(scene, all, material));
}

void add_sky(Scene& scene) {
  Environment& sky = scene.environment;
  sky.radiance = glm::vec3(1.0f);
  sky.width = 16, sky.height = 8;
  for (std::uint32_t i = 0; i < sky.width * sky.height; ++i) {
    const float across = static_cast<float>(i % sky.width) / 16.0f, down = static_cast<float>(i / sky.width) / 8.0f;
    sky.map.emplace_back(1.5f - down, 1.0f, 0.3f + across * across + (down < 0.3f ? 1.0f : 0.0f));
  }
  sky.rotation = 0.7;
}

// Lamps of all kinds above and beside the corner, most of them small quads that shine to one side or to both; two
// hang behind the wall, where no camera path sees them.
void add_many_lights(Scene& scene, bool distant, double lowest = 0.1) {
  Material lamp = plain_material(), flat = plain_material();
  lamp.emission = {9.0f, 7.0f, 5.0f};
  flat.emission = {5.0f, 7.0f, 9.0f};
  flat.double_sided = false;
  const auto first = static_cast<std::uint32_t>(scene.materials.size());
  scene.materials.push_back(lamp), scene.materials.push_back(flat);
  const std::vector<glm::vec3> square = quad({-0.5f, 0, -0.5f}, {0.5f, 0, -0.5f}, {0.5f, 0, 0.5f}, {-0.5f, 0, 0.5f});
  const std::array meshes = {add_mesh(scene, square, first), add_mesh(scene, square, first + 1)};
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 24; ++i) {
    glm::dvec3 place(-1.8 + 3.6 * unit(random), lowest + (1.7 - lowest) * unit(random), -0.7 + 2.2 * unit(random));
    if (i < 2) place.z = -1.5;
    const double size = 0.1 + 0.25 * unit(random) * unit(random);
    const glm::dmat4 turn =
        glm::rotate(glm::translate(glm::dmat4(1.0), place), 3.0 * unit(random), glm::dvec3(1, 2, 3));
    add_instance(scene, meshes[i % 2 == 0 ? 0 : 1], glm::scale(turn, glm::dvec3(size)));
  }
  for (int i = 0; i < 6; ++i) {
    add_lamp(scene, i % 2 == 0 ? LightKind::point : LightKind::spot);
    scene.lights.back().position.x = -1.5 + 0.6 * i;
    scene.lights.back().intensity *= 0.1f;
  }
  if (!distant) return;
  add_lamp(scene, LightKind::directional);
  scene.lights.back().intensity *= 0.2f;
  add_sky(scene);
  scene.environment.radiance = glm::vec3(0.2f);
}

struct Subject {
  PackedScene packed;
  View view;

  Subject(Scene scene, const RenderSettings& settings)
      : packed(pack(scene, {.direct = settings.direct, .lights = settings.lights})),
        view(resolve_view(scene, {}, settings.width, settings.height)) {}
};

// Mean luminance of the picture and of six parts of it, over independent renders, and the variance of that mean.
constexpr std::size_t kParts = 7;
struct Average {
  std::array<double, kParts> mean{}, variance{};
};

std::array<double, kParts> parts_of(const Picture& picture) {
  std::array<double, kParts> parts{};
  for (std::uint32_t i = 0; i < picture.width * picture.height; ++i) {
    const std::uint32_t x = i % picture.width * 3 / picture.width, y = i / picture.width * 2 / picture.height;
    const double value =
        (picture.channels[0].values[i] + picture.channels[1].values[i] + picture.channels[2].values[i]) /
        (picture.width * picture.height);
    parts[0] += value;
    parts[1 + 3 * y + x] += 6.0 * value;
  }
  return parts;
}

// A floor under a slab of clear glass, seen in a mirror; without lights.
Scene floor_in_mirror() {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  Material silver = plain_material();
  silver.metallic = 1.0f, silver.roughness = 0.0f;
  silver.base_color = {0.9f, 0.9f, 0.8f, 1.0f};
  scene.materials.push_back(silver);
  Material glass = plain_material();
  glass.transmission = 1.0f, glass.specular = 1.0f, glass.roughness = 0.0f;
  glass.base_color = glm::vec4(1.0f);
  glass.volume = true;
  glass.attenuation = {0.5f, 0.1f, 1.0f};
  scene.materials.push_back(glass);
  add_instance(scene, add_mesh(scene, quad({-2, -0.5f, 2}, {2, -0.5f, 2}, {2, -0.5f, -1}, {-2, -0.5f, -1})));
  add_instance(scene, add_mesh(scene, quad({-2, -0.5f, -1}, {2, -0.5f, -1}, {2, 2, -1}, {-2, 2, -1}), 1));
  add_box(scene, {-1.9f, 0.5f, -0.9f}, {1.9f, 0.7f, 1.9f}, 2);
  scene.cameras.push_back(camera_at({0.2, 0.25, 1.2}));
  scene.cameras.back().yfov = 0.2;
  return scene;
}

double relative_rms(const Picture& picture, const Picture& reference) {
  const std::size_t n = picture.channels[0].values.size();
  double sum = 0.0;
  for (std::size_t k = 0; k < 3 * n; ++k) {
    const double r = reference.channels[k / n].values[k % n], d = picture.channels[k / n].values[k % n] - r;
    sum += d * d / (r * r + 0.01);
  }
  return std::sqrt(sum / (3.0 * static_cast<double>(n)));
}

class BidirectionalTest : public VulkanTest {
protected:
  // Compiles each of them once, and waits for what is being compiled before the driver's own statics go.
  static inline std::unique_ptr<KernelCompiler> kernels_;
  static void TearDownTestSuite() { kernels_.reset(); }

  static RenderSettings settings(std::uint32_t spp, std::uint32_t depth,
                                 std::uint32_t techniques = gpu::kTechniquesAll) {
    RenderSettings settings;
    settings.width = 18, settings.height = 12;
    settings.last_sample = spp;
    settings.max_depth = depth;
    settings.integrator = &kBidirectional;
    settings.techniques = techniques;
    return settings;
  }
  static RenderSettings path_settings(std::uint32_t spp, std::uint32_t depth) {
    RenderSettings plain = settings(spp, depth);
    plain.integrator = &kPath;
    return plain;
  }
  RenderResult render(const Subject& subject, const RenderSettings& settings) {
    if (!kernels_) kernels_ = std::make_unique<KernelCompiler>(device());
    RenderResult result = wavepath::render(device(), subject.packed, subject.view, settings, RenderHooks{}, *kernels_);
    EXPECT_EQ(result.nonfinite.samples(), 0u);
    return result;
  }
  // Whatever the waves are long, and with generic kernels.
  void expect_same_film_however_cut(const Subject& subject, const RenderSettings& whole, const Film& expected) {
    for (const std::uint32_t slots : {64u, 700u}) {
      RenderSettings cut = whole;
      cut.wave_slots = slots;
      EXPECT_TRUE(*render(subject, cut).film == expected) << slots << " slots";
    }
    RenderSettings generic = whole;
    generic.specialize = false;
    EXPECT_TRUE(*render(subject, generic).film == expected) << "generic kernels";
  }
  Average average(const Subject& subject, RenderSettings settings) {
    constexpr std::uint32_t kRenders = 8;
    Average result;
    for (settings.seed = 1; settings.seed <= kRenders; ++settings.seed) {
      const auto parts = parts_of(render(subject, settings).picture);
      for (std::size_t i = 0; i < kParts; ++i)
        result.mean[i] += parts[i] / kRenders, result.variance[i] += parts[i] * parts[i] / kRenders;
    }
    for (std::size_t i = 0; i < kParts; ++i)
      result.variance[i] = std::max(result.variance[i] - result.mean[i] * result.mean[i], 0.0) / (kRenders - 1);
    return result;
  }
  // By t-tests of 14 degrees of freedom at most, which chance alone fails once in 3,000.
  static void expect_same_mean(const Average& a, const Average& b, double noise = 0.05) {
    for (std::size_t i = 0; i < kParts; ++i) {
      const double error = std::sqrt(a.variance[i] + b.variance[i]);
      EXPECT_NEAR(a.mean[i], b.mean[i], 4.6 * error + 1e-5 * b.mean[i]) << "part " << i << ", error " << error;
      EXPECT_LT(error, noise * b.mean[i]) << "part " << i << ": too much noise to tell";
    }
  }
  // Each set of techniques gives what path tracing gives. `adjust`: other settings, of both.
  void expect_path_light(const Scene& scene, std::uint32_t depth, const std::vector<std::uint32_t>& sets,
                         std::uint32_t spp = 32, const std::function<void(RenderSettings&)>& adjust = {}) {
    RenderSettings path = path_settings(4 * spp, depth);
    if (adjust) adjust(path);
    const Average expected = average(Subject(scene, path), path);
    for (const std::uint32_t techniques : sets) {
      SCOPED_TRACE(techniques);
      RenderSettings asked = settings(spp, depth, techniques);
      if (adjust) adjust(asked);
      expect_same_mean(average(Subject(scene, asked), asked), expected);
    }
  }
};

TEST_F(BidirectionalTest, FindsTheLightOfTheCornellBoxInEveryWay) {
  expect_path_light(
      load_gltf(kScenes + "cornell_box.gltf", {}), 4,
      {gpu::kTechniquesAll, kHit | kLight, kHit | kSplat, kHit | kConnect | kLight, kHit | kConnect | kSplat});
}

// What none but its own technique can find: the others are left out one by one.
TEST_F(BidirectionalTest, FindsTheLightOfAQuad) {
  Scene scene = corner();
  add_shining_quad(scene, 2.5f);
  expect_path_light(scene, 3, {kHit}, 128);
  expect_path_light(scene, 3, {gpu::kTechniquesAll, kHit | kLight | kSplat, kHit | kConnect | kSplat});
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

// Next-event estimation goes by a tree, or by what a pilot has learned, while light paths begin by power.
class BidirectionalLights : public BidirectionalTest, public testing::WithParamInterface<std::uint32_t> {
protected:
  static void use(RenderSettings& asked) { asked.lights = asked.integrator == &kPath ? gpu::kLightsPower : GetParam(); }
  // What path tracing does not find: each set of techniques gives what it gives by power.
  void expect_light_by_power(const Scene& scene, std::uint32_t depth, const std::vector<std::uint32_t>& sets,
                             std::uint32_t spp) {
    for (const std::uint32_t techniques : sets) {
      SCOPED_TRACE(techniques);
      RenderSettings power = settings(spp, depth, techniques), asked = power;
      power.lights = gpu::kLightsPower, asked.lights = GetParam();
      expect_same_mean(average(Subject(scene, asked), asked), average(Subject(scene, power), power));
    }
  }
};
INSTANTIATE_TEST_SUITE_P(Lights, BidirectionalLights, testing::Values(gpu::kLightsTree, gpu::kLightsLearned));

TEST_P(BidirectionalLights, FindTheSameLight) {
  Scene scene = corner();
  add_many_lights(scene, true);
  add_pictures(scene);
  std::vector<std::uint32_t> sets = {gpu::kTechniquesAll, kHit | kLight, kLight | kConnect | kSplat};
  if (GetParam() == gpu::kLightsTree) // whose renders have no pilot
    for (const std::uint32_t more : {kLight | kSplat, kHit | kLight | kConnect, kHit | kConnect | kSplat})
      sets.push_back(more);
  expect_path_light(scene, 3, sets, 64, use);
}

// Smooth glass and mirrors pass on what was chosen at the vertex before them, or nothing.
TEST_P(BidirectionalLights, FindTheSameLightThroughGlass) {
  Scene scene = corner();
  scene.materials[1].roughness = 0.0f;
  Material glass = plain_material();
  glass.transmission = 1.0f, glass.specular = 1.0f, glass.roughness = 0.0f;
  glass.base_color = glm::vec4(1.0f);
  glass.volume = true;
  scene.materials.push_back(glass);
  add_box(scene, {-1.5f, 0.5f, -0.8f}, {0.5f, 0.7f, 1.2f}, 2);
  add_many_lights(scene, false, 0.9);
  expect_light_by_power(scene, 4, {gpu::kTechniquesAll, kLight | kConnect | kSplat}, 128);
}

TEST_P(BidirectionalLights, HowTheWorkIsCutUpDoesNotMatter) {
  RenderSettings whole = settings(3, 4);
  whole.lights = GetParam();
  Scene scene = corner();
  add_many_lights(scene, true);
  const Subject subject(scene, whole);
  const RenderResult expected = render(subject, whole);
  EXPECT_EQ(expected.light_pilot.rows > 20, GetParam() == gpu::kLightsLearned);
  expect_same_film_however_cut(subject, whole, *expected.film);
  RenderSettings first = whole, second = whole;
  first.last_sample = second.first_sample = 1;
  first.sample_total = second.sample_total = 3;
  Film film = *render(subject, second).film;
  join(film, *render(subject, first).film);
  EXPECT_TRUE(film == *expected.film) << "joined";
}

// Where nothing asks for the tree, its kernels and the receivers of paths are not there.
TEST_F(BidirectionalTest, TreesAreThereWhereTheyAreNeeded) {
  RenderSettings asked = settings(2, 3);
  const auto walks = [&] {
    const bool has_tree = kernel_config(gpu::kFeatureLightTree, 32, asked).features & gpu::kFeatureLightTree;
    const std::uint64_t receivers =
        kBidirectional.bytes_per_slot(gpu::kFeatureLightTree, asked) - kBidirectional.bytes_per_slot(0, asked);
    EXPECT_EQ(receivers, has_tree ? 16u : 0u);
    return has_tree;
  };
  for (const std::uint32_t lights : {gpu::kLightsAuto, gpu::kLightsTree, gpu::kLightsLearned}) {
    asked.lights = lights;
    asked.techniques = kLight | kSplat;
    EXPECT_TRUE(walks());
    asked.techniques = kHit | kConnect | kSplat;
    EXPECT_FALSE(walks());
  }
  asked = settings(2, 3);
  asked.lights = gpu::kLightsPower;
  EXPECT_FALSE(walks());
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
    expect_path_light(scene, 3, {gpu::kTechniquesAll, kSplat | kHit, kHit | kConnect | kLight}, 64,
                      [&](RenderSettings& asked) { asked.aperture = 0.6, asked.focus = 2.0, asked.blades = blades; });
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
                    [](RenderSettings& asked) { asked.cull = GetParam(); });
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
  const RenderSettings all = settings(64, 3);
  const Subject subject(std::move(scene), all);
  const Average found = average(subject, all);
  const double expected = 2.0 * 0.5 / std::numbers::pi * std::pow(1.0 - 0.2 * 0.2, 2.0); // R, G and B on average
  EXPECT_NEAR(found.mean[0], 3.0 * expected, 4.6 * std::sqrt(found.variance[0]) + 1e-4 * expected);
  EXPECT_LT(std::sqrt(found.variance[0]), 0.01 * expected);
  const RenderResult path = render(subject, path_settings(16, 3));
  for (const float value : path.picture.channels[0].values) EXPECT_EQ(value, 0.0f);
}

// Light that goes through glass to a floor that is seen in a mirror, and by way of the mirror to the floor again: two
// techniques find it, and both together as much.
TEST_F(BidirectionalTest, MergingFindsWhatAMirrorShows) {
  Scene scene = floor_in_mirror();
  add_shining_quad(scene, 2.5f);
  expect_path_light(scene, 6, {gpu::kTechniquesAll, kHit | kMerge, kHit | kLight | kMerge}, 256);
}

TEST_F(BidirectionalTest, MergingFindsTheSkyThatAMirrorShows) {
  Scene scene = floor_in_mirror();
  add_sky(scene);
  expect_path_light(scene, 4, {gpu::kTechniquesAll, kHit | kMerge}, 256);
}

// Of a lamp without extent nothing else finds it.
TEST_F(BidirectionalTest, OnlyMergingFindsALampThatAMirrorShows) {
  Scene scene = floor_in_mirror();
  add_lamp(scene, LightKind::point);
  const RenderSettings all = settings(8, 4), rest = settings(8, 4, gpu::kTechniquesAll & ~kMerge);
  const Subject subject(std::move(scene), all);
  const double found = parts_of(render(subject, all).picture)[0], others = parts_of(render(subject, rest).picture)[0];
  EXPECT_GT(found, 0.0);
  EXPECT_LT(others, 1e-3 * found);
}

TEST_F(BidirectionalTest, EveryFilterGivesTheSameLight) {
  for (const std::uint32_t filter : {gpu::kFilterBox, gpu::kFilterGaussian}) {
    SCOPED_TRACE(filter);
    Scene scene = corner();
    add_lamp(scene, LightKind::point);
    RenderSettings path = path_settings(128, 2), splats = settings(64, 2, kSplat);
    path.filter = splats.filter = filter;
    const Subject subject(std::move(scene), path);
    expect_same_mean(average(subject, splats), average(subject, path));
  }
}

TEST_F(BidirectionalTest, HowTheWorkIsCutUpDoesNotMatter) {
  RenderSettings whole = settings(3, 5);
  whole.aovs = {"albedo", "normal", "depth", "emission"};
  Scene showcase = load_gltf(kScenes + "showcase.glb", {});
  add_sky(showcase);
  const Subject subject(std::move(showcase), whole);
  const RenderResult expected = render(subject, whole);
  ASSERT_FALSE(expected.film->splats.empty());
  expect_same_film_however_cut(subject, whole, *expected.film);
}

TEST_F(BidirectionalTest, HowMergingIsCutUpDoesNotMatter) {
  const RenderSettings whole = settings(5, 5);
  Scene scene = floor_in_mirror();
  add_lamp(scene, LightKind::spot);
  add_shining_quad(scene);
  const Subject subject(std::move(scene), whole);
  const RenderResult expected = render(subject, whole);
  ASSERT_TRUE(expected.merging);
  expect_same_film_however_cut(subject, whole, *expected.film);
}

// Ranges of samples that begin and end within a block have its map and its radius.
TEST_F(BidirectionalTest, FilmsThatMergeJoinWithoutLoss) {
  Scene scene = floor_in_mirror();
  add_lamp(scene, LightKind::point);
  RenderSettings whole = settings(0, 4);
  const Subject subject(std::move(scene), whole);
  const std::uint32_t block = plan_photons(std::uint64_t{whole.width} * whole.height).block;
  whole.first_sample = block - 3, whole.last_sample = whole.sample_total = block + 5;
  for (const std::uint32_t middle : {block - 1, block, block + 2}) {
    RenderSettings first = whole, second = whole;
    first.last_sample = second.first_sample = middle;
    Film film = *render(subject, second).film;
    join(film, *render(subject, first).film);
    EXPECT_TRUE(film == *render(subject, whole).film) << middle;
  }
}

// Where no surface is smooth, or no path is long enough, there are no photons.
TEST_F(BidirectionalTest, PhotonsAreThereWhereTheyAreNeeded) {
  const auto has_photons = [&](Scene scene, const RenderSettings& settings) {
    const Subject subject(std::move(scene), settings);
    RenderSettings without = settings;
    without.techniques &= ~kMerge;
    const RenderResult result = render(subject, settings);
    const bool dispatched =
        std::ranges::any_of(result.stages, [](const StageTime& stage) { return stage.name.starts_with("photon"); });
    EXPECT_EQ(result.merging.has_value(), dispatched);
    EXPECT_EQ(result.memory.paths > render(subject, without).memory.paths, dispatched);
    return dispatched;
  };
  Scene dull = corner(), smooth = floor_in_mirror();
  add_lamp(dull, LightKind::point);
  EXPECT_FALSE(has_photons(std::move(dull), settings(2, 4)));
  EXPECT_FALSE(has_photons(smooth, settings(2, 4))) << "no light";
  add_lamp(smooth, LightKind::point);
  EXPECT_TRUE(has_photons(smooth, settings(2, 4)));
  EXPECT_FALSE(has_photons(smooth, settings(2, 2))) << "no path is long enough";
  EXPECT_FALSE(has_photons(smooth, settings(2, 4, kHit | kLight)));
  EXPECT_LE(sizeof(gpu::Photon), 64u);
  EXPECT_LE(plan_photons(1u << 26).bytes(), 64u << 20);
}

TEST_F(BidirectionalTest, TheRadiusShrinksWithTheSamples) {
  const PhotonPlan plan = plan_photons(1u << 20);
  EXPECT_EQ(plan.block, gpu::kReplicates);
  EXPECT_FLOAT_EQ(radius_of_block(1.0f, plan, 0), 1.0f);
  for (const std::uint32_t block : {0u, 1u, 1000u})
    EXPECT_LT(radius_of_block(1.0f, plan, block + 1), radius_of_block(1.0f, plan, block));
  // Photons found grow without bound although the radius goes to nothing.
  const float r = radius_of_block(1.0f, plan, 999999);
  EXPECT_LT(r, 0.2f);
  EXPECT_GT(1e6f * r * r, 1e3f);
  // As far into the render, the radius of a small picture, whose blocks are longer, is the same.
  const PhotonPlan small = plan_photons(1u << 12);
  EXPECT_FLOAT_EQ(radius_of_block(1.0f, small, 0), radius_of_block(1.0f, plan, small.block / gpu::kReplicates - 1));
}

// Halves of the samples, joined, are the whole: the light that paths of one bring to pixels of the other included.
TEST_F(BidirectionalTest, FilmsJoinWithoutLoss) {
  RenderSettings whole = settings(6, 3);
  const Subject subject(load_gltf(kScenes + "cornell_box.gltf", {}), whole);
  RenderSettings first = whole, second = whole;
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
  const RenderSettings path = path_settings(4096, 3);
  const Subject subject(std::move(scene), path);
  const Picture reference = render(subject, path).picture;
  int covered = 0;
  constexpr int kRenders = 16;
  for (int i = 0; i < kRenders; ++i) {
    RenderSettings splats = settings(32, 3, kSplat);
    splats.seed = static_cast<std::uint32_t>(100 + i);
    const RenderResult result = render(subject, splats);
    const double error = relative_rms(result.picture, reference);
    covered += result.error.ci95[0] <= error && error <= result.error.ci95[1];
  }
  EXPECT_GE(covered, 12) << "of " << kRenders;
}

// Photons are shared by the pixels, but not by the replicates.
TEST_F(BidirectionalTest, TheEstimatedErrorCoversThatOfMerging) {
  Scene scene = floor_in_mirror();
  add_lamp(scene, LightKind::point);
  RenderSettings fine = settings(8192, 4, kMerge);
  fine.seed = 99;
  const Subject subject(std::move(scene), fine);
  const Picture reference = render(subject, fine).picture;
  int covered = 0;
  constexpr int kRenders = 16;
  for (int i = 0; i < kRenders; ++i) {
    RenderSettings coarse = settings(32, 4, kMerge);
    coarse.seed = static_cast<std::uint32_t>(200 + i);
    const RenderResult result = render(subject, coarse);
    const double error = relative_rms(result.picture, reference);
    covered += result.error.ci95[0] <= error && error <= result.error.ci95[1];
  }
  EXPECT_GE(covered, 12) << "of " << kRenders;
}

// Nothing of light paths exists where they are not asked for, and what is asked for fits into an eighth of the device's
// memory.
TEST_F(BidirectionalTest, LightVerticesAreCounted) {
  RenderSettings deep = settings(4, 9), shallow = settings(4, 1);
  const std::uint64_t vertices = kBidirectional.bytes_per_slot(0, deep) - kBidirectional.bytes_per_slot(0, shallow);
  EXPECT_EQ(vertices, 8 * sizeof(gpu::LightVertex) + sizeof(float)); // and whether the path merges
  EXPECT_LE(sizeof(gpu::LightVertex), 64u);
  deep.width = 4096, deep.height = 4096;
  const Subject subject(corner(), deep);
  DeviceInfo small = device().info();
  small.memory_bytes = std::uint64_t{64} << 20;
  const std::uint64_t slots = choose_slots(small, subject.packed, deep);
  EXPECT_LE(slots * kBidirectional.bytes_per_slot(subject.packed.features, deep), small.memory_bytes / 8);
  EXPECT_TRUE(render(Subject(corner(), shallow), path_settings(1, 1)).film->splats.empty());
}

} // namespace
} // namespace wavepath::test
