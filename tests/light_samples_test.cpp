// Several light samples where a path first scatters, and several directions towards the sky: the same picture however
// many, less noise under a map, bits that do not depend on how the work is cut up, and one sample where auto expects no
// gain.
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "host/film/film.h"
#include "host/integrators/bidirectional/kind.h"
#include "host/integrators/path/kind.h"
#include "host/integrators/path/path_replay.h"
#include "host/plan/sky_samples.h"
#include "host/render/settings/direct_sampling.h"
#include "tests/light_rooms.h"

namespace wavepath::test {
namespace {

class LightSamples : public LightRooms {
protected:
  static RenderPlan asked(std::uint32_t light_samples, std::uint32_t direct = gpu::kDirectMis, std::uint32_t spp = 64) {
    RenderPlan result = settings(gpu::kLightsPower, direct, spp); // without the pilot that a map has otherwise
    result.light_samples = light_samples;
    return result;
  }
};

std::uint32_t lights_in(const RenderPlan& settings, gpu::Feature scene) {
  return direct_sampling(settings, scene).lights;
}
std::uint32_t sky_samples_in(const RenderPlan& settings, gpu::Feature scene) {
  return direct_sampling(settings, scene).sky;
}

// The rooms' open side behind a thin pane, so that rays to the sky pass it and paths bring light through it.
Scene glazed_rooms() {
  Scene scene = two_rooms(4, true);
  Material glass = plain_material();
  glass.base_color = glm::vec4(0.9f, 0.8f, 0.7f, 1.0f);
  glass.specular = 1.0f;
  glass.roughness = 0.0f;
  glass.transmission = 1.0f;
  scene.materials.push_back(glass);
  add_instance(scene, add_mesh(scene, quad({-4, -1, 2.2f}, {8, 0, 0}, {0, 2, 0}),
                               static_cast<std::uint32_t>(scene.materials.size()) - 1));
  return scene;
}

// A grey floor below a map with one bright texel, dark below the horizon.
Scene floor_under_map() {
  Scene scene;
  scene.path = "floor";
  scene.materials = {plain_material()};
  add_instance(scene, add_mesh(scene, quad({-40, -1, -40}, {0, 0, 80}, {80, 0, 0})));
  scene.environment.radiance = glm::vec3(1.0f);
  scene.environment.width = 16;
  scene.environment.height = 8;
  for (int i = 0; i < 128; ++i)
    scene.environment.map.emplace_back(i == 20 ? 40.0f : i < 64 ? 0.2f + 0.1f * float(i % 7) : 0.0f);
  return scene;
}

TEST_F(LightSamples, AnyNumberGivesTheSamePicture) {
  const std::vector<Scene> scenes = {two_rooms(40, true), glazed_rooms(), floor_under_map()};
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const RenderPlan one = asked(1, gpu::kDirectMis, 128);
    const MeanPicture reference = average(subject(scenes[i], one), one);
    for (const auto& [direct, more] : {std::pair{gpu::kDirectMis, 3u}, {gpu::kDirectMis, 8u}, {gpu::kDirectNee, 8u}}) {
      SCOPED_TRACE(std::to_string(i) + " " + std::to_string(direct) + " " + std::to_string(more));
      const RenderPlan other = asked(more, direct);
      expect_same(reference, average(subject(scenes[i], other), other));
    }
  }
}

TEST_F(LightSamples, LessNoiseUnderAMap) {
  const auto noise = [&](std::uint32_t light_samples) {
    const RenderPlan settings = asked(light_samples, gpu::kDirectMis, 16);
    double sum = 0.0;
    for (const double v : average(subject(floor_under_map(), settings), settings).variance) sum += v;
    return sum;
  };
  const double one = noise(1);
  EXPECT_LT(noise(2), 0.7 * one);
  EXPECT_LT(noise(4), 0.45 * one); // 0.25 if nothing but light samples made noise
}

TEST_F(LightSamples, BitsDoNotDependOnHowTheWorkIsCut) {
  for (const std::uint32_t sampler : {gpu::kSamplerSobol, gpu::kSamplerStratified, gpu::kSamplerIndependent}) {
    RenderPlan whole = asked(4, gpu::kDirectMis, 16);
    whole.sampler = sampler;
    const Subject rooms = subject(two_rooms(40, true), whole);
    const RenderResult expected = render(rooms, whole);
    expect_same_film_however_cut(rooms, whole, *expected.film);
  }
}

TEST_F(LightSamples, HalfAsManyAtEachBounce) {
  for (const std::uint32_t bounce : {0u, 1u, 2u, 3u, 40u}) EXPECT_EQ(gpu::light_samples_at(1, bounce), 1u);
  EXPECT_EQ(gpu::light_samples_at(8, 0), 8u);
  EXPECT_EQ(gpu::light_samples_at(8, 1), 4u);
  EXPECT_EQ(gpu::light_samples_at(7, 1), 3u);
  EXPECT_EQ(gpu::light_samples_at(8, 3), 1u);
  EXPECT_EQ(gpu::light_samples_at(8, 32), 1u) << "a shift of 32 would be 8 again";
}

TEST_F(LightSamples, AutoTakesMoreUnderAMapAlone) {
  const RenderPlan automatic = asked(0);
  EXPECT_EQ(lights_in(automatic, gpu::kFeatureEnvironment | gpu::kFeatureEnvironmentMap), kLightSamplesOfMaps);
  EXPECT_EQ(lights_in(automatic, gpu::kFeatureEnvironmentMap | gpu::kLobeSheen), kFewLightSamplesOfMaps);
  EXPECT_EQ(lights_in(automatic, gpu::kFeatureEnvironmentMap | gpu::kFeatureLightTree), kFewLightSamplesOfMaps);
  EXPECT_EQ(lights_in(automatic, gpu::kFeatureEnvironment | gpu::kFeatureTriangleLights), 1u);
  EXPECT_EQ(lights_in(asked(0, gpu::kDirectBsdf), gpu::kFeatureEnvironmentMap), 1u) << "there are none";
  EXPECT_EQ(lights_in(asked(3), 0), 3u);
  RenderPlan other = asked(3);
  other.integrator = &kBidirectional;
  EXPECT_EQ(lights_in(other, gpu::kFeatureEnvironmentMap), 1u);

  const Subject open = subject(floor_under_map(), automatic);
  EXPECT_TRUE(*render(open, automatic).film == *render(open, asked(kLightSamplesOfMaps)).film);
  EXPECT_FALSE(*render(open, automatic).film == *render(open, asked(1)).film);
  Scene lamps = two_rooms(4, false);
  const Subject closed = subject(lamps, automatic);
  EXPECT_TRUE(*render(closed, automatic).film == *render(closed, asked(1)).film);
}

// A floor alone is hit but once, so that each light sample is one shadow ray, but for those below the horizon.
TEST_F(LightSamples, EachIsAShadowRay) {
  const RenderPlan one = asked(1), four = asked(4);
  const Subject open = subject(floor_under_map(), one);
  const double ratio =
      static_cast<double>(render(open, four).rays.shadow) / static_cast<double>(render(open, one).rays.shadow);
  EXPECT_NEAR(ratio, 4.0, 0.1);
}

// Takes the room of its queues, and no more where one sample is taken.
TEST_F(LightSamples, ReservesItsQueues) {
  const gpu::Feature map = gpu::kFeatureEnvironmentMap;
  const std::uint64_t one = kPath.bytes_per_slot(map, asked(1));
  EXPECT_EQ(kPath.bytes_per_slot(map, asked(4)) - one, 3 * sizeof(gpu::ShadowRay));
  EXPECT_EQ(kPath.bytes_per_slot(0, asked(0)), kPath.bytes_per_slot(0, asked(1)));
}

// The density of a direction is that of the scattering alone, however many light samples there are, also behind panes.
TEST_F(LightSamples, ReplayTellsTheSameDensities) {
  const RenderPlan one = asked(1, gpu::kDirectMis, 1), four = asked(4, gpu::kDirectMis, 1);
  const Subject rooms = subject(glazed_rooms(), one);
  render(rooms, one); // begins the kernels
  PathReplay single(device(), rooms.packed, rooms.view, one, *kernels_),
      several(device(), rooms.packed, rooms.view, four, *kernels_);
  std::size_t compared = 0;
  for (std::uint32_t i = 0; i < one.width; ++i) {
    const PathTrace a = single.trace({i, i % one.height}, 0), b = several.trace({i, i % one.height}, 0);
    ASSERT_EQ(a.vertices.size(), b.vertices.size());
    for (std::size_t bounce = 0; bounce < a.vertices.size(); ++bounce) {
      ASSERT_EQ(a.vertices[bounce].pdf.has_value(), b.vertices[bounce].pdf.has_value());
      if (!a.vertices[bounce].pdf) continue;
      EXPECT_FLOAT_EQ(*a.vertices[bounce].pdf, *b.vertices[bounce].pdf) << "pixel " << i << ", bounce " << bounce;
      ++compared;
    }
  }
  EXPECT_GT(compared, 2u * one.width);
}

// A path that is followed by itself has the bits that it has in the picture.
TEST_F(LightSamples, ReplayTellsOfEach) {
  RenderPlan whole = asked(4, gpu::kDirectMis, 1);
  whole.lights = gpu::kLightsAuto;
  std::size_t most = 0;
  for (const Scene& scene : {two_rooms(4, true), floor_under_map()}) {
    const Subject shown = subject(scene, whole);
    const RenderResult rendered = render(shown, whole);
    const Picture& picture = rendered.picture;
    RenderPlan trained = whole;
    trained.training.found = rendered.light_training.probabilities;
    PathReplay replay(device(), shown.packed, shown.view, trained, *kernels_);
    for (std::uint32_t i = 0; i < 12; ++i) {
      const glm::uvec2 pixel(2 * i, i);
      const PathTrace trace = replay.trace(pixel, 0);
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_EQ(picture.channels[c].values[pixel.y * whole.width + pixel.x], trace.radiance[static_cast<int>(c)]);
      most = std::max(most, trace.vertices.front().shadows.size());
      for (std::size_t bounce = 1; bounce < trace.vertices.size(); ++bounce)
        EXPECT_LE(trace.vertices[bounce].shadows.size(), bounce == 1 ? 2u : 1u);
    }
  }
  EXPECT_EQ(most, 4u);
}

// ---- a sky of one colour --------------------------------------------------------------------------------------------

RenderPlan with_sky_samples(RenderPlan settings, std::uint32_t sky_samples, bool trains = true) {
  settings.sky_samples = sky_samples;
  settings.training.one_colour = trains;
  if (trains) settings.lights = gpu::kLightsAuto;
  return settings;
}

// The rooms with their open side towards such a sky; without lamps, nothing else shines.
Scene rooms_under_a_sky(int lamps) {
  Scene scene = two_rooms(lamps, true);
  scene.materials[2].transmission = 0.0f;
  scene.materials[2].specular = 1.0f; // a mirror over its colour, in which a path alone finds the sky
  scene.materials[2].roughness = 0.0f;
  scene.materials[2].ior = 3.0f;
  if (lamps == 0) scene.lights.clear();
  scene.environment = {};
  scene.environment.radiance = glm::vec3(0.8f, 1.0f, 1.2f);
  return scene;
}

TEST_F(LightSamples, AnyNumberOfSkySamplesGivesTheSamePicture) {
  const std::vector<Scene> scenes = {rooms_under_a_sky(4), rooms_under_a_sky(40), rooms_under_a_sky(0)};
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const RenderPlan one = with_sky_samples(asked(1, gpu::kDirectMis, 128), 1, false);
    const MeanPicture reference = average(subject(scenes[i], one), one);
    for (const auto& [more, trains] : {std::pair{2u, false}, {8u, false}, {8u, true}}) {
      SCOPED_TRACE(std::to_string(i) + " " + std::to_string(more) + (trains ? " learned" : ""));
      const RenderPlan other = with_sky_samples(asked(1), more, trains);
      expect_same(reference, average(subject(scenes[i], other), other));
    }
    // The density that a path keeps is divided among several light samples.
    const RenderPlan lit = with_sky_samples(asked(4), 5);
    expect_same(reference, average(subject(scenes[i], lit), lit));
    if (i > 0) continue;
    RenderPlan guided = with_sky_samples(asked(1), 5); // the density of guided directions is weighed as well
    guided.guide = true;
    expect_same(reference, average(subject(scenes[i], guided), guided));
  }
}

TEST_F(LightSamples, SkySamplesMeanLessNoiseInARoom) {
  const auto noise = [&](std::uint32_t sky_samples, bool trains) {
    const RenderPlan settings = with_sky_samples(asked(1, gpu::kDirectMis, 16), sky_samples, trains);
    double sum = 0.0;
    for (const double v : average(subject(rooms_under_a_sky(0), settings), settings).variance) sum += v;
    return sum;
  };
  const double several = noise(4, false);
  EXPECT_LT(several, 0.6 * noise(1, false));
  EXPECT_LT(noise(8, true), 0.8 * several) << "with as many rays, since later vertices send fewer";
}

// Without training directions are those of paths, and nothing is trained for one that paths find anyway.
TEST_F(LightSamples, TheSkyIsLearnedWhereLightsAre) {
  const Subject rooms = subject(rooms_under_a_sky(0), with_sky_samples(asked(1), 4));
  const auto rendered = [&](std::uint32_t sky_samples, bool trains, std::uint32_t lights) {
    RenderPlan settings = with_sky_samples(asked(1, gpu::kDirectMis, 4), sky_samples, trains);
    settings.lights = lights;
    return render(rooms, settings);
  };
  const RenderResult unlearned = rendered(4, false, gpu::kLightsAuto), learned = rendered(4, true, gpu::kLightsAuto);
  EXPECT_GT(learned.light_training.sky_cells, 0u);
  EXPECT_EQ(unlearned.light_training.paths, 0u);
  EXPECT_FALSE(*learned.film == *unlearned.film);
  EXPECT_TRUE(*rendered(4, true, gpu::kLightsPower).film == *unlearned.film);
  EXPECT_EQ(rendered(1, true, gpu::kLightsAuto).light_training.paths, 0u);
  RenderPlan brief = with_sky_samples(asked(1, gpu::kDirectMis, 4), 4);
  brief.training.paths = 1000;
  EXPECT_GT(render(rooms, brief).light_training.sky_cells, 0u) << "renders of any length train";
}

TEST_F(LightSamples, BitsWithSkySamplesDoNotDependOnHowTheWorkIsCut) {
  const RenderPlan whole = with_sky_samples(asked(1, gpu::kDirectMis, 16), 4);
  const Subject rooms = subject(rooms_under_a_sky(4), whole);
  const RenderResult expected = render(rooms, whole);
  expect_same_film_however_cut(rooms, whole, *expected.film);
}

// A path that is followed by itself has the bits that it has in the picture, and shows its shadow rays to the sky.
TEST_F(LightSamples, ReplayTellsOfSkySamples) {
  const RenderPlan whole = with_sky_samples(asked(1, gpu::kDirectMis, 1), 4);
  std::size_t most = 0;
  for (const int lamps : {0, 4}) {
    const Subject shown = subject(rooms_under_a_sky(lamps), whole);
    const RenderResult rendered = render(shown, whole);
    const Picture& picture = rendered.picture;
    RenderPlan trained = whole;
    trained.training.found = rendered.light_training.probabilities;
    PathReplay replay(device(), shown.packed, shown.view, trained, *kernels_);
    for (std::uint32_t i = 0; i < 12; ++i) {
      const glm::uvec2 pixel(2 * i, i);
      const PathTrace trace = replay.trace(pixel, 0);
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_EQ(picture.channels[c].values[pixel.y * whole.width + pixel.x], trace.radiance[static_cast<int>(c)]);
      most = std::max(most, trace.vertices.front().shadows.size());
    }
  }
  EXPECT_EQ(most, 4u) << "three to the sky, one to a lamp";
}

// Kernels that support any number take one as those do that know nothing of it.
TEST_F(LightSamples, KernelsForAnyNumberOfSkySamplesTakeOne) {
  const RenderPlan plain = with_sky_samples(asked(1, gpu::kDirectMis, 16), 1);
  RenderPlan trying = plain;
  trying.kernels.shared_sky = true;
  const Subject rooms = subject(rooms_under_a_sky(0), plain);
  EXPECT_TRUE(*render(rooms, plain).film == *render(rooms, trying).film);
}

TEST_F(LightSamples, SkySamplesAreForASkyOfOneColour) {
  const RenderPlan four = with_sky_samples(asked(1), 4);
  EXPECT_EQ(sky_samples_in(four, gpu::kFeatureEnvironment), 4u);
  EXPECT_EQ(sky_samples_in(four, 0), 1u) << "there is none";
  EXPECT_EQ(sky_samples_in(four, gpu::kFeatureEnvironment | gpu::kFeatureEnvironmentMap), 1u);
  EXPECT_EQ(sky_samples_in(four, gpu::kFeatureEnvironment | gpu::kFeaturePanes), 1u);
  EXPECT_EQ(sky_samples_in(with_sky_samples(asked(1, gpu::kDirectNee), 4), gpu::kFeatureEnvironment), 1u);
  EXPECT_EQ(sky_samples_in(with_sky_samples(asked(1), 0), gpu::kFeatureEnvironment), 1u) << "auto, before it is chosen";
  EXPECT_EQ(learned_sky_samples(four, gpu::kFeatureEnvironment), 7u);
  EXPECT_EQ(learned_sky_samples(asked(4), gpu::kFeatureEnvironment), 5u) << "the light samples have the other queues";
}

TEST_F(LightSamples, TheRoomTakesMoreSkySamplesAndTheOpenOne) {
  const auto choose = [&](const Scene& scene, std::uint32_t spp) {
    RenderPlan settings = with_sky_samples(asked(0, gpu::kDirectMis, spp), 0);
    settings.width = settings.height = 64;
    const Subject shown = subject(scene, settings);
    if (!kernels_) render(shown, settings); // begins the kernels
    SceneOnDevice on_device;
    PilotRunner pilots(device(), shown.packed, shown.view, *kernels_, on_device);
    return choose_sky_samples(pilots, settings);
  };
  Scene open = floor_under_map();
  open.environment = {};
  open.environment.radiance = glm::vec3(1.0f);
  const SkyChoice room = choose(rooms_under_a_sky(0), 4096), floor = choose(open, 4096);
  EXPECT_EQ(room.samples, 7u);
  EXPECT_TRUE(room.trains);
  EXPECT_LT(room.cost, 0.9);
  EXPECT_EQ(floor.samples, 1u);
  EXPECT_FALSE(floor.trains);
  EXPECT_EQ(choose(rooms_under_a_sky(0), 4096).samples, room.samples) << "no clock decides";
  const SkyChoice brief = choose(rooms_under_a_sky(0), 600);
  EXPECT_EQ(brief.samples, 7u) << "64 times the paths of its pilots";
  EXPECT_TRUE(brief.trains);
  EXPECT_EQ(choose(rooms_under_a_sky(0), 560).samples, 0u) << "too short for pilots";
}

} // namespace
} // namespace wavepath::test
