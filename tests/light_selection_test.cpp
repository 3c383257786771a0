// Choosing among many lights: power, tree and trained probabilities give the same picture by every estimator of direct
// light, bits do not depend on how the work is cut up, and scenes with few lights pay nothing.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/film/film.h"
#include "host/integrators/bidirectional/kind.h"
#include "host/integrators/hybrid/kind.h"
#include "host/integrators/path/kind.h"
#include "host/integrators/path/light_histograms.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/lights.h"
#include "host/scene/pack/pack.h"
#include "kernels/base/light_tree_types.h"
#include "tests/coverage.h"
#include "tests/light_rooms.h"

namespace wavepath::test {
namespace {

const std::string kCornell = std::string(WAVEPATH_SOURCE_DIR) + "/scenes/cornell_box.gltf";

class LightSelection : public LightRooms {};

TEST_F(LightSelection, AllGiveTheSamePicture) {
  for (const bool distant : {false, true}) {
    const RenderPlan power = settings(gpu::kLightsPower, gpu::kDirectMis, 128);
    const MeanPicture reference = average(subject(two_rooms(40, distant), power), power);
    for (const std::uint32_t direct : {gpu::kDirectMis, gpu::kDirectNee})
      for (const std::uint32_t lights : {gpu::kLightsTree, gpu::kLightsLearned}) {
        SCOPED_TRACE(std::to_string(direct) + " " + std::to_string(lights) + " " + std::to_string(distant));
        const RenderPlan other = settings(lights, direct, 128);
        const Subject rooms = subject(two_rooms(40, distant), other);
        ASSERT_TRUE(rooms.packed.features & gpu::kFeatureLightTree);
        expect_same(reference, average(rooms, other));
      }
  }
}

TEST_F(LightSelection, HybridPicksByTheTree) {
  RenderPlan power = settings(gpu::kLightsPower, gpu::kDirectMis, 64),
             tree = settings(gpu::kLightsAuto, gpu::kDirectMis, 64);
  power.integrator = tree.integrator = &kHybrid;
  power.max_depth = tree.max_depth = 1;
  expect_same(average(subject(two_rooms(40, true), power), power), average(subject(two_rooms(40, true), tree), tree));
}

TEST_F(LightSelection, BidirectionalPicksByThem) {
  RenderPlan power = settings(gpu::kLightsPower, gpu::kDirectMis, 64);
  const MeanPicture reference = average(subject(two_rooms(40, true), power), power);
  for (const std::uint32_t lights : {gpu::kLightsTree, gpu::kLightsAuto}) {
    SCOPED_TRACE(lights);
    RenderPlan asked = settings(lights, gpu::kDirectMis, 32);
    asked.integrator = &kBidirectional;
    expect_same(reference, average(subject(two_rooms(40, true), asked), asked));
  }
}

// A leaf is lit from behind.
TEST_F(LightSelection, DiffuseTransmissionIsLitFromBothSides) {
  Scene rooms = two_rooms(40, false);
  rooms.materials[0].diffuse_transmission = 0.5f;
  for (const IntegratorKind* integrator : {&kPath, &kBidirectional}) {
    SCOPED_TRACE(integrator->name);
    RenderPlan power = settings(gpu::kLightsPower, gpu::kDirectMis, 256);
    power.integrator = integrator;
    RenderPlan tree = power;
    tree.lights = gpu::kLightsTree;
    expect_same(average(subject(rooms, power), power), average(subject(rooms, tree), tree));
  }
}

TEST_F(LightSelection, LessNoiseThanByPower) {
  const auto noise = [&](const IntegratorKind& integrator, std::uint32_t lights) {
    RenderPlan asked = settings(lights, gpu::kDirectMis);
    asked.integrator = &integrator;
    double sum = 0.0;
    for (const double v : average(subject(two_rooms(200, true), asked), asked).variance) sum += v;
    return sum;
  };
  const double by_power = noise(kPath, gpu::kLightsPower), by_tree = noise(kPath, gpu::kLightsTree),
               by_training = noise(kPath, gpu::kLightsAuto);
  EXPECT_LT(by_tree, 0.7 * by_power);
  EXPECT_LT(by_training, 0.8 * by_tree);
  // Light paths, which begin by power, find the lamps as well; the tree alone gains nothing here.
  EXPECT_LT(noise(kBidirectional, gpu::kLightsAuto), 0.8 * noise(kBidirectional, gpu::kLightsPower));
}

// As in error_test.cpp, by fewer seeds, of which each trains light selection and sky by itself. The camera
// looks at the floor from below all lamps, whose edges would be most of the error.
TEST_F(LightSelection, TheIntervalHoldsTheTrueError) {
  constexpr std::uint32_t kRuns = 16, kReference = 32;
  RenderPlan coarse = settings(gpu::kLightsLearned, gpu::kDirectMis, 16);
  coarse.width = coarse.height = 32;
  coarse.filter = gpu::kFilterBox;
  const ViewRequest below{.eye = glm::dvec3(-1.0, -0.7, 0.5), .look_at = glm::dvec3(-1.0, -1.0, 0.4), .yfov = 1.2};
  Scene scene = two_rooms(40, true);
  const Subject rooms{pack(scene, {.eye = below.eye, .lights = coarse.lights}),
                      resolve_view(scene, below, coarse.width, coarse.height)};
  RenderPlan fine = coarse;
  fine.last_sample *= kReference, fine.seed = 1000000;
  const Coverage found = measure_coverage(render(rooms, fine).picture, kRuns, [&](std::uint32_t seed) {
    coarse.seed = seed;
    RenderResult result = render(rooms, coarse);
    EXPECT_GT(result.light_training.cells, 20u);
    EXPECT_GT(result.light_training.sky_cells, 20u);
    return result;
  });
  EXPECT_GE(found.covered, 13u);
  EXPECT_NEAR(found.ratio.mean(), 1.0, 0.05) << "its own noise is " << found.ratio.error();
}

// The sums of training are integers; every part, and every render that is resumed, trains the same anew.
TEST_F(LightSelection, BitsDoNotDependOnHowTheWorkIsCut) {
  const RenderPlan whole = settings(gpu::kLightsAuto, gpu::kDirectMis, 16);
  const Subject rooms = subject(two_rooms(40, true), whole);
  const RenderResult expected = render(rooms, whole);
  EXPECT_GT(expected.light_training.cells, 20u);
  expect_same_film_however_cut(rooms, whole, *expected.film);
  expect_same_film_resumed(rooms, whole, *expected.film);
}

// As small pictures beside a render do.
TEST_F(LightSelection, PicturesBesideARenderTakeOverItsTraining) {
  for (const IntegratorKind* integrator : {&kPath, &kBidirectional}) {
    SCOPED_TRACE(integrator->name);
    RenderPlan asked = settings(gpu::kLightsAuto, gpu::kDirectMis, 4);
    asked.integrator = integrator;
    const Subject rooms = subject(two_rooms(40, true), asked);
    SceneOnDevice shared;
    const RenderResult expected = render(rooms, asked, {}, &shared);
    ASSERT_GT(expected.light_training.paths, 0u);
    ASSERT_TRUE(shared.light_probabilities);
    asked.training.found = shared.light_probabilities;
    const RenderResult trained = render(rooms, asked, {}, &shared);
    EXPECT_EQ(trained.light_training.paths, 0u);
    EXPECT_TRUE(*trained.film == *expected.film) << "the same shares, hence the same bits";
  }
}

TEST_F(LightSelection, FewLightsNeedNoTree) {
  const RenderPlan automatic = settings(gpu::kLightsAuto, gpu::kDirectMis, 8);
  RenderPlan power = automatic;
  power.lights = gpu::kLightsPower;
  Scene scene = load_gltf(kCornell, {});
  const PackedScene packed = pack(scene);
  EXPECT_TRUE(packed.light_tree.empty());
  EXPECT_FALSE(packed.features & gpu::kFeatureLightTree);
  const auto entry = std::find_if(packed.left_out.begin(), packed.left_out.end(),
                                  [](const LeftOut& e) { return e.feature == gpu::kFeatureLightTree; });
  ASSERT_NE(entry, packed.left_out.end());
  const Subject cornell{packed, resolve_view(scene, {}, automatic.width, automatic.height)};
  const RenderResult result = render(cornell, automatic);
  EXPECT_EQ(result.light_training.cells, 0u);
  EXPECT_TRUE(*result.film == *render(cornell, power).film);
  RenderPlan generic = automatic;
  generic.specialize = false;
  EXPECT_TRUE(*render(cornell, generic).film == *result.film);
}

// Many lights in few places, such as one lamp of many triangles, are as well picked by power.
TEST_F(LightSelection, LightsInFewLocationsNeedNoTree) {
  Scene scene = two_rooms(0, false);
  scene.lights.clear();
  const std::uint32_t lamp = add_mesh(scene, quad({-0.5f, 0, -0.5f}, {1, 0, 0}, {0, 0, 1}), 1);
  for (int i = 0; i < 50; ++i)
    add_instance(scene, lamp,
                 glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(1.0 + 0.004 * i, 0.5, 0)), glm::dvec3(0.003)));
  const PackedScene one_location = pack(scene);
  EXPECT_EQ(one_location.local_light_count, 100u);
  EXPECT_LT(one_location.light_locations, 3.0);
  EXPECT_TRUE(one_location.light_tree.empty());
  // The same lamps apart, over a table that stands on a large floor: close by the floor's measure, not by the table's.
  scene.instances.resize(scene.instances.size() - 50);
  for (int i = 0; i < 50; ++i)
    add_instance(scene, lamp,
                 glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(0.2 * (i % 10), 0.5, 0.2 * (i / 10))),
                            glm::dvec3(0.003)));
  const std::uint32_t floor = add_mesh(scene, quad({-6, -0.01f, -6}, {0, 0, 12}, {12, 0, 0}), 0);
  add_instance(scene, floor, glm::dmat4(1.0));
  const PackedScene small_places = pack(scene);
  EXPECT_LT(small_places.light_locations, kManyLocations);
  EXPECT_FALSE(small_places.light_tree.empty());
  Scene rooms = two_rooms(40, false);
  const PackedScene many_locations = pack(rooms);
  EXPECT_GT(many_locations.light_locations, kManyLocations);
  EXPECT_FALSE(many_locations.light_tree.empty());
}

TEST_F(LightSelection, TrainsProbabilitiesBySums) {
  const RenderPlan learned = settings(gpu::kLightsLearned, gpu::kDirectMis);
  const PackedScene packed = subject(two_rooms(40, true), learned).packed;
  std::vector<std::uint32_t> sums(kLightSumBytes / sizeof(std::uint32_t), 0);
  constexpr std::uint32_t kCell = 7, kAround = 9;
  const auto word = [&](std::uint32_t cell, std::uint32_t cluster, std::uint32_t i) -> std::uint32_t& {
    return sums[4 * (cell * gpu::kLightClusters + cluster) + i];
  };
  word(kCell, 2, 0) = 400, word(kCell, 2, 2) = 100; // half of them visible: root of 400 * 100
  word(kCell, 5, 0) = 1000;                         // hidden
  word(kCell, 6, 1) = 1, word(kCell, 6, 3) = 1;     // beyond 32 bits
  word(kCell, gpu::kTreeCluster, 0) = 1000000;      // picks: many enough to count alone
  word(kCell, gpu::kTreeCluster, 1) = kAround + 1;
  const TrainedLights trained = train_light_cells(packed, sums);
  const std::vector<std::uint32_t> before = prior_light_cells(packed);
  EXPECT_EQ(trained.cells, 1u);
  const auto probability = [](const std::vector<std::uint32_t>& ends, std::uint32_t cell, std::uint32_t cluster) {
    const std::size_t i = cell * gpu::kLightClusters + cluster;
    return (ends[i] - (cluster > 0 ? double(ends[i - 1]) : 0.0)) / 0x1p32;
  };
  EXPECT_NEAR(probability(trained.ends, kCell, 6) / probability(trained.ends, kCell, 2), 0x1p32 / 200.0,
              0.01 * 0x1p32 / 200.0);
  EXPECT_EQ(probability(trained.ends, kCell, 5), 0.0);
  EXPECT_NEAR(probability(trained.ends, kCell, 6), 0.9, 0.001);
  EXPECT_NEAR(probability(trained.ends, kCell, gpu::kTreeCluster), 0.1 * probability(before, 0, gpu::kTreeCluster),
              0.001);
  EXPECT_GT(probability(trained.ends, kCell, gpu::kEnvironmentCluster), 0.0);
  for (std::uint32_t cluster = 0; cluster < gpu::kLightClusters; ++cluster)
    EXPECT_NEAR(probability(trained.ends, 0, cluster), probability(before, 0, cluster), 1e-8) << cluster; // not trained
}

} // namespace
} // namespace wavepath::test
