// Looking for an environment map where a pilot saw it: the same picture by every estimator, less noise where most of
// the map is hidden, bits that do not depend on how the work is cut up, and nothing of it where nobody needs it.
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "host/film/film.h"
#include "host/integrators/bidirectional/kind.h"
#include "host/integrators/path/kind.h"
#include "host/integrators/path/path_replay.h"
#include "host/integrators/path/sky_histograms.h"
#include "host/plan/training.h"
#include "host/render/loop/render_loop.h"
#include "kernels/base/learned_sky_types.h"
#include "tests/light_rooms.h"

namespace wavepath::test {
namespace {

// A room that sees part of the sky through its open front, with a low sun in it, a board within and, before half of the
// opening, a pane.
Scene room_with_sky(bool pane) {
  Scene scene;
  scene.path = "room with a sky";
  scene.materials = {plain_material(), plain_material()};
  scene.materials[1].transmission = 1.0f;
  scene.materials[1].roughness = 0.0f;
  std::vector<glm::vec3> walls;
  const auto add = [&](const glm::vec3& corner, const glm::vec3& a, const glm::vec3& b) {
    for (const glm::vec3& p : quad(corner, a, b)) walls.push_back(p);
  };
  add({-2, -1, -2}, {4, 0, 0}, {0, 0, 4});
  add({-2, 1, -2}, {4, 0, 0}, {0, 0, 4});
  add({-2, -1, -2}, {4, 0, 0}, {0, 2, 0});
  for (const float x : {-2.0f, 2.0f}) add({x, -1, -2}, {0, 2, 0}, {0, 0, 4});
  add({-0.6f, -1, -0.8f}, {0.8f, 0, 0.3f}, {0.1f, 0.9f, 0});
  add_instance(scene, add_mesh(scene, walls));
  if (pane) add_instance(scene, add_mesh(scene, quad({-2, -1, 1.9f}, {2, 0, 0}, {0, 2, 0}), 1));
  scene.environment.radiance = glm::vec3(1.0f);
  scene.environment.width = 32;
  scene.environment.height = 15; // so that a row lies across the horizon, which the opening shows
  for (int i = 0; i < 32 * 15; ++i) {
    const int x = i % 32, y = i / 32;
    scene.environment.map.emplace_back(x == 24 && y == 6 ? 60.0f : 0.2f + 0.05f * float((x + 3 * y) % 11));
  }
  return scene;
}

class LearnedSky : public LightRooms {
protected:
  static Subject seen(Scene scene, const RenderPlan& settings) {
    ViewRequest request;
    request.eye = glm::dvec3(0.3, 0.1, 4.5);
    request.look_at = glm::dvec3(0.0, -0.2, 0.0);
    request.yfov = 0.6;
    return {pack(scene, {.direct = settings.direct, .eye = request.eye, .lights = settings.lights}),
            resolve_view(scene, request, settings.width, settings.height)};
  }
};

TEST_F(LearnedSky, EveryEstimatorGivesTheSamePicture) {
  struct Case {
    bool pane;
    std::uint32_t direct, samples;
  };
  std::optional<MeanPicture> open, glazed;
  for (const Case& c : {Case{false, gpu::kDirectMis, 4}, {false, gpu::kDirectNee, 1}, {true, gpu::kDirectMis, 1}}) {
    SCOPED_TRACE(std::to_string(c.pane) + " " + std::to_string(c.direct) + " " + std::to_string(c.samples));
    std::optional<MeanPicture>& reference = c.pane ? glazed : open;
    const RenderPlan power = settings(gpu::kLightsPower, gpu::kDirectMis, 512);
    if (!reference) reference = average(seen(room_with_sky(c.pane), power), power);
    RenderPlan learned = settings(gpu::kLightsAuto, c.direct, 512);
    learned.light_samples = c.samples;
    expect_same(*reference, average(seen(room_with_sky(c.pane), learned), learned));
  }
}

TEST_F(LearnedSky, GuidedPathsKeepThePicture) {
  RenderPlan power = settings(gpu::kLightsPower, gpu::kDirectMis, 64), guided = power;
  guided.lights = gpu::kLightsAuto;
  guided.guide = true;
  expect_same(average(seen(room_with_sky(false), power), power), average(seen(room_with_sky(false), guided), guided));
}

TEST_F(LearnedSky, LessNoiseWhereMostOfTheMapIsHidden) {
  const auto noise = [&](std::uint32_t lights) {
    const RenderPlan asked = settings(lights, gpu::kDirectMis, 32);
    const MeanPicture picture = average(seen(room_with_sky(false), asked), asked);
    return std::accumulate(picture.variance.begin(), picture.variance.end(), 0.0);
  };
  EXPECT_LT(noise(gpu::kLightsAuto), 0.6 * noise(gpu::kLightsPower));
}

// The sums of training are integers; every part, and every render that is resumed, trains the same anew.
TEST_F(LearnedSky, BitsDoNotDependOnHowTheWorkIsCut) {
  const RenderPlan whole = settings(gpu::kLightsAuto, gpu::kDirectMis, 16);
  const Subject room = seen(room_with_sky(true), whole);
  const RenderResult expected = render(room, whole);
  EXPECT_GT(expected.light_training.sky_cells, 20u);
  EXPECT_EQ(expected.light_training.cells, 0u);
  expect_same_film_however_cut(room, whole, *expected.film);
  expect_same_film_resumed(room, whole, *expected.film);
}

// Behind a pane that the camera looks through, no vertex was stored before: training must not read what an earlier
// picture, or nobody, left in its slot.
TEST_F(LearnedSky, PanesBeforeTheFirstVertexTeachNothingOfOtherPictures) {
  Scene scene = room_with_sky(true);
  scene.materials[1].transmission = 0.5f; // the rest is diffuse, and receives light
  const RenderPlan asked = settings(gpu::kLightsAuto, gpu::kDirectMis, 8);
  const Subject room = seen(scene, asked);
  const RenderResult fresh = render(room, asked);
  ASSERT_GT(fresh.light_training.sky_cells, 20u);
  ViewRequest within;
  within.eye = glm::dvec3(0.3, 0.1, 1.5);
  within.look_at = glm::dvec3(0.0, -0.2, -1.0);
  RenderLoop loop(device(), room.packed, resolve_view(scene, within, asked.width, asked.height), asked, *kernels_);
  while (loop.step()) {
  }
  loop.finish();
  loop.restart(room.view, asked);
  while (loop.step()) {
  }
  const RenderResult again = loop.finish();
  EXPECT_EQ(again.light_training.sky_cells, fresh.light_training.sky_cells);
  EXPECT_TRUE(*again.film == *fresh.film);
}

// With many lamps besides, whose fractions lie before those of the sky.
TEST_F(LearnedSky, LampsBesideItKeepTheirBits) {
  const RenderPlan whole = settings(gpu::kLightsAuto, gpu::kDirectMis, 16);
  const Subject rooms = subject(two_rooms(40, true), whole);
  const RenderResult expected = render(rooms, whole);
  EXPECT_GT(expected.light_training.cells, 20u);
  EXPECT_GT(expected.light_training.sky_cells, 20u);
  expect_same_film_however_cut(rooms, whole, *expected.film);
}

// As small pictures beside a render do, and the path of `--pixel`.
TEST_F(LearnedSky, WhatIsRenderedBesideTakesOverItsTraining) {
  RenderPlan asked = settings(gpu::kLightsAuto, gpu::kDirectMis, 4);
  const Subject room = seen(room_with_sky(false), asked);
  SceneOnDevice shared;
  const RenderResult expected = render(room, asked, {}, &shared);
  ASSERT_GT(expected.light_training.paths, 0u);
  ASSERT_TRUE(shared.light_probabilities);
  asked.training.found = shared.light_probabilities;
  const RenderResult trained = render(room, asked, {}, &shared);
  EXPECT_EQ(trained.light_training.paths, 0u);
  EXPECT_TRUE(*trained.film == *expected.film) << "the same shares, hence the same bits";

  RenderPlan one = asked; // the box filter keeps a sample in its pixel
  one.last_sample = 1;
  one.filter = gpu::kFilterBox;
  const Picture picture = render(room, one, {}, &shared).picture;
  PathReplay replay(device(), room.packed, room.view, one, *kernels_);
  for (const glm::uvec2 pixel : {glm::uvec2(11, 9), glm::uvec2(5, 12), glm::uvec2(17, 4)}) {
    const glm::vec3 radiance = replay.trace(pixel, 0).radiance;
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(radiance[c], picture.channels[c].values[pixel.y * one.width + pixel.x]) << pixel.x << "," << pixel.y;
  }
}

// The small pictures of `bias` are rendered by another integrator as well.
TEST_F(LearnedSky, RendersTakeOverThePartOfTrainingThatTheyUse) {
  RenderPlan path = settings(gpu::kLightsAuto, gpu::kDirectMis, 4), both = path;
  both.integrator = &kBidirectional; // knows lights alone
  const Subject rooms = subject(two_rooms(40, true), path);
  const LightProbabilities whole = render(rooms, path).light_training.probabilities;
  ASSERT_TRUE(whole.lights && whole.sky);
  both.training.found = whole;
  const RenderResult trained = render(rooms, both);
  EXPECT_EQ(trained.light_training.paths, 0u);
  both.training.found.sky = nullptr;
  EXPECT_TRUE(*render(rooms, both).film == *trained.film);
  const RenderResult alone = render(rooms, path);
  path.training.found.lights = whole.lights; // no sky: it trains anew
  EXPECT_GT(render(rooms, path).light_training.sky_cells, 20u);
  EXPECT_TRUE(*render(rooms, path).film == *alone.film);
}

TEST_F(LearnedSky, NothingOfItWhereNobodyAsks) {
  Scene constant = room_with_sky(false);
  constant.environment.map.clear();
  constant.environment.width = constant.environment.height = 0;
  const RenderPlan automatic = settings(gpu::kLightsAuto, gpu::kDirectMis, 4);
  EXPECT_EQ(render(seen(constant, automatic), automatic).light_training.paths, 0u);
  const auto is_asked = [&](std::uint32_t lights, std::uint32_t direct, const IntegratorKind& integrator) {
    RenderPlan asked = settings(lights, direct);
    asked.integrator = &integrator;
    const Subject room = seen(room_with_sky(false), asked);
    return (kernel_config(room.packed.features | features_of(asked), room.packed.stack_size, asked).features &
            gpu::kFeatureLearnedSky) != 0;
  };
  EXPECT_TRUE(is_asked(gpu::kLightsAuto, gpu::kDirectMis, kPath));
  EXPECT_TRUE(is_asked(gpu::kLightsLearned, gpu::kDirectNee, kPath));
  EXPECT_FALSE(is_asked(gpu::kLightsPower, gpu::kDirectMis, kPath));
  EXPECT_FALSE(is_asked(gpu::kLightsTree, gpu::kDirectMis, kPath)) << "as windows pick";
  EXPECT_FALSE(is_asked(gpu::kLightsAuto, gpu::kDirectBsdf, kPath));
  EXPECT_FALSE(is_asked(gpu::kLightsAuto, gpu::kDirectMis, kBidirectional));
}

TEST(LightTraining, IsLongerWhereTheRenderIs) {
  RenderPlan settings;
  settings.width = 256, settings.height = 192;
  const double pixels = 256.0 * 192.0;
  const auto samples = [&](std::uint32_t spp) { // of a pixel
    settings.last_sample = spp;
    return static_cast<double>(light_training_paths(settings, DeviceClass::cpu)) / pixels;
  };
  EXPECT_LT(samples(1), 0.25);
  EXPECT_GT(samples(64), 2.0);
  for (std::uint32_t spp = 1; spp < 4096; spp *= 2) {
    EXPECT_GT(samples(2 * spp), samples(spp));
    EXPECT_LT(samples(2 * spp) / (2 * spp), samples(spp) / spp) << "a smaller share of it";
  }
  const double of_8 = samples(8);
  settings.target_error = 0.1;
  EXPECT_LE(samples(65536), samples(16)) << "it may be short";
  settings.target_error = 0.0, settings.time_limit = 1.0;
  EXPECT_LT(samples(65536), of_8) << "as many paths as a CPU has in that time";
  settings.time_limit = 0.0, settings.width = settings.height = 16384;
  EXPECT_LE(samples(65536) * pixels, 0x1p24) << "counts of picks have 32 bits";
  settings.time_limit = 1.0;
  EXPECT_GT(light_training_paths(settings, DeviceClass::gpu), 20 * light_training_paths(settings, DeviceClass::cpu))
      << "a GPU renders more in it";
}

// More samples of each pixel, or a smaller picture.
TEST_F(LearnedSky, PilotsHaveTheLengthThatIsAskedFor) {
  RenderPlan asked = settings(gpu::kLightsAuto, gpu::kDirectMis, 1);
  asked.width = 200, asked.height = 30;
  const Subject room = seen(room_with_sky(false), asked);
  for (const std::uint64_t paths : {700u, 5999u, 6000u, 6001u, 30'000u, 100'000u}) {
    asked.training.paths = paths;
    EXPECT_NEAR(static_cast<double>(render(room, asked).light_training.paths), paths, 0.05 * paths);
  }
  asked.training.paths = 1;
  EXPECT_LE(render(room, asked).light_training.paths, 3u) << "sides have a pixel at least";
  asked.training.paths = 0;
  EXPECT_EQ(render(room, asked).light_training.paths, 10u * 6000u) << "of parts: as many samples as 65,536 paths hold";
}

// Where little was picked, the cells around it count: four times as wide, and sixteen times.
TEST(LearnedSkyCells, AreTrainedByCellsAround) {
  std::vector<std::uint32_t> sums(kSkySumBytes / sizeof(std::uint32_t), 0);
  const auto add = [&](std::uint32_t cell, std::uint32_t wider, std::uint32_t widest, std::uint32_t part,
                       std::uint32_t picks) {
    std::uint32_t* words = &sums[std::size_t{4} * cell * gpu::kSkySumBins];
    words[4 * part] = words[4 * part + 2] = 1000;
    words[4 * gpu::kSkyParts] = picks;
    words[4 * gpu::kSkyParts + 1] = (wider * gpu::kLightCells | widest) + 1;
  };
  add(5, 100, 200, 1, 1);
  add(6, 100, 200, 2, 1 << 24); // trains what lies in cell 100
  add(7, 101, 200, 3, 1);       // only the widest cell is the same
  add(8, 102, 201, 4, 1);
  const TrainedSky trained = train_sky_cells(sums);
  EXPECT_EQ(trained.cells, 4u);
  const auto band = [&](std::uint32_t cell) { // the first one's fraction: parts 0 to 7
    return trained.ends[std::size_t{cell} * gpu::kSkyCellWords] / 0x1p32;
  };
  const auto part = [&](std::uint32_t cell, std::uint32_t p) {
    const std::uint32_t* ends = &trained.ends[std::size_t{cell} * gpu::kSkyCellWords + gpu::kSkySide];
    return band(cell) * (ends[p] - double(ends[p - 1])) / 0x1p32;
  };
  EXPECT_NEAR(part(6, 2), 0.75 + 0.25 / 64, 0.01);
  EXPECT_GT(part(5, 2), 0.3) << "half of what the wider cell saw";
  EXPECT_GT(part(7, 2), 0.2) << "a third of what the widest saw";
  EXPECT_LT(part(8, 2), 1.1 / 64) << "nothing is known around it";
  EXPECT_GT(part(8, 4), 1.0 / 64);
}

TEST(LearnedSkyCells, AreTrainedBySums) {
  std::vector<std::uint32_t> sums(kSkySumBytes / sizeof(std::uint32_t), 0);
  constexpr std::uint32_t kCell = 7, kAround = 9;
  const auto word = [&](std::uint32_t cell, std::uint32_t bin, std::uint32_t i) -> std::uint32_t& {
    return sums[4 * (cell * gpu::kSkySumBins + bin) + i];
  };
  word(kCell, 2, 0) = 400, word(kCell, 2, 2) = 100; // a quarter of it visible: root of 400 * 100
  word(kCell, 5, 0) = 1000;                         // hidden
  word(kCell, 63, 0) = 600, word(kCell, 63, 2) = 600;
  word(kCell, gpu::kSkyParts, 0) = 100000000; // picks: many enough to count alone
  word(kCell, gpu::kSkyParts, 1) = kAround + 1;
  const TrainedSky trained = train_sky_cells(sums);
  EXPECT_EQ(trained.cells, 1u);
  const auto probability = [&](std::uint32_t cell, std::uint32_t part) {
    const std::uint32_t* ends = &trained.ends[std::size_t{cell} * gpu::kSkyCellWords];
    const auto width = [](const std::uint32_t* e, std::uint32_t i) {
      return (e[i] - (i > 0 ? double(e[i - 1]) : 0.0)) / 0x1p32;
    };
    const std::uint32_t band = part / gpu::kSkySide;
    return width(ends, band) * width(ends + gpu::kSkySide * (1 + band), part % gpu::kSkySide);
  };
  EXPECT_NEAR(probability(kCell, 2), 0.75 * 0.25 + 0.25 / 64, 1e-4);
  EXPECT_NEAR(probability(kCell, 63), 0.75 * 0.75 + 0.25 / 64, 1e-4);
  EXPECT_NEAR(probability(kCell, 5), 0.25 / 64, 1e-4) << "never none";
  for (std::uint32_t part = 0; part < gpu::kSkyParts; ++part) EXPECT_NEAR(probability(0, part), 1.0 / 64, 1e-8) << part;
}

} // namespace
} // namespace wavepath::test
