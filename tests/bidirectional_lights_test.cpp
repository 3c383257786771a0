// How bidirectional path tracing chooses lights: by the tree and by trained probabilities, every set of techniques
// finds the same.
#include <random>

#include <glm/gtc/matrix_transform.hpp>

#include "host/render/workspace/kernel_compiler.h"
#include "tests/bidirectional_scene.h"

namespace wavepath::test {
namespace {

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

// Next-event estimation goes by a tree, or by trained probabilities, while light paths begin by power.
class BidirectionalLights : public BidirectionalTest, public testing::WithParamInterface<std::uint32_t> {
protected:
  static void use(RenderPlan& asked) { asked.lights = asked.integrator == &kPath ? gpu::kLightsPower : GetParam(); }
  // What path tracing does not find: each set of techniques gives what it gives by power.
  void expect_light_by_power(const Scene& scene, std::uint32_t depth, const std::vector<std::uint32_t>& sets,
                             std::uint32_t spp) {
    for (const std::uint32_t techniques : sets) {
      SCOPED_TRACE(techniques);
      RenderPlan power = settings(spp, depth, techniques), asked = power;
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
  RenderPlan whole = settings(3, 4);
  whole.lights = GetParam();
  Scene scene = corner();
  add_many_lights(scene, true);
  const Subject subject(scene, whole);
  const RenderResult expected = render(subject, whole);
  EXPECT_EQ(expected.light_training.cells > 20, GetParam() == gpu::kLightsLearned);
  expect_same_film_however_cut(subject, whole, *expected.film);
  RenderPlan first = whole, second = whole;
  first.last_sample = second.first_sample = 1;
  first.sample_total = second.sample_total = 3;
  Film film = *render(subject, second).film;
  join(film, *render(subject, first).film);
  EXPECT_TRUE(film == *expected.film) << "joined";
}

// Where nothing asks for the tree, its kernels and the receivers of paths are not there.
TEST_F(BidirectionalTest, TreesAreThereWhereTheyAreNeeded) {
  RenderPlan asked = settings(2, 3);
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

} // namespace
} // namespace wavepath::test
