// Photons of bidirectional path tracing: what is seen in mirrors and through glass is found, and nothing depends on how
// the work is cut up.
#include <cstdint>
#include <vector>

#include "host/film/error.h"
#include "host/integrators/bidirectional/photon_map.h"
#include "tests/bidirectional_scene.h"

namespace wavepath::test {
namespace {

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

// Light that goes through glass to a floor that is seen in a mirror, and by way of the mirror to the floor again. Two
// techniques find all of it, each by itself as well, and the others nothing, so that they must not change the weights.
TEST_F(BidirectionalTest, EverySetFindsWhatAMirrorShows) {
  Scene scene = floor_in_mirror();
  add_shining_quad(scene, 2.2f); // all of it above the glass, as the floor sees it
  expect_path_light(scene, 6, sets_of(kHit | kLight | kConnect | kSplat, kHit), 64);
  std::vector<std::uint32_t> merging; // not all: a map of photons takes a tenth of a second
  for (const std::uint32_t others : {0u, kLight, kConnect, kSplat, kLight | kConnect | kSplat})
    merging.insert(merging.end(), {kMerge | others, kMerge | kHit | others});
  expect_path_light(scene, 6, merging, 64);
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
  const RenderPlan all = settings(8, 4), rest = settings(8, 4, gpu::kTechniquesAll & ~kMerge);
  const Subject subject(std::move(scene), all);
  const double found = parts_of(render(subject, all).picture)[0], others = parts_of(render(subject, rest).picture)[0];
  EXPECT_GT(found, 0.0);
  EXPECT_LT(others, 1e-3 * found);
}

TEST_F(BidirectionalTest, HowMergingIsCutUpDoesNotMatter) {
  const RenderPlan whole = settings(5, 5);
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
  RenderPlan whole = settings(0, 4);
  const Subject subject(std::move(scene), whole);
  const std::uint32_t block = plan_photons(std::uint64_t{whole.width} * whole.height).block;
  whole.first_sample = block - 3, whole.last_sample = whole.sample_total = block + 5;
  for (const std::uint32_t middle : {block - 1, block, block + 2}) {
    RenderPlan first = whole, second = whole;
    first.last_sample = second.first_sample = middle;
    Film film = *render(subject, second).film;
    join(film, *render(subject, first).film);
    EXPECT_TRUE(film == *render(subject, whole).film) << middle;
  }
}

// Where no surface is smooth, or no path is long enough, there are no photons.
TEST_F(BidirectionalTest, PhotonsAreThereWhereTheyAreNeeded) {
  const auto has_photons = [&](Scene scene, const RenderPlan& settings) {
    const Subject subject(std::move(scene), settings);
    RenderPlan without = settings;
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

// Photons are shared by the pixels, but not by the replicates.
TEST_F(BidirectionalTest, TheEstimatedErrorCoversThatOfMerging) {
  Scene scene = floor_in_mirror();
  add_lamp(scene, LightKind::point);
  RenderPlan fine = settings(8192, 4, kMerge);
  fine.seed = 99;
  const Subject subject(std::move(scene), fine);
  const Picture reference = render(subject, fine).picture;
  expect_intervals_cover(subject, reference, settings(32, 4, kMerge));
}

} // namespace
} // namespace wavepath::test
