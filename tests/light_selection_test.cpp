// Choosing among many lights: power, tree and learned shares give the same picture by every estimator of direct light,
// bits do not depend on how the work is cut up, and scenes with few lights pay nothing.
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/film/film.h"
#include "host/integrators/bidirectional/kind.h"
#include "host/integrators/hybrid/kind.h"
#include "host/integrators/path/kind.h"
#include "host/integrators/path/light_rows.h"
#include "host/render/device/kernel_compiler.h"
#include "host/render/loop/render_state.h"
#include "host/render/render.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/lights.h"
#include "host/scene/pack/pack.h"
#include "host/scene/view.h"
#include "kernels/light_tree_types.h"
#include "tests/scene_builder.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

const std::string kCornell = std::string(WAVEPATH_SOURCE_DIR) + "/scenes/cornell_box.gltf";

std::vector<glm::vec3> quad(const glm::vec3& corner, const glm::vec3& a, const glm::vec3& b) {
  return {corner, corner + a, corner + a + b, corner, corner + a + b, corner + b};
}

// Two rooms side by side with a wall between them, open in front. Lamps of one mesh, placed and scaled at random, some
// mirrored, hang in both; points and spots, a sun and a sky that shines in through the open side.
Scene two_rooms(int lamps, bool distant_lights) {
  Scene scene;
  scene.path = "two rooms";
  scene.materials = {plain_material(), plain_material(), plain_material()};
  scene.materials[1].emission = glm::vec3(8.0f, 6.0f, 4.0f);
  scene.materials[1].double_sided = false;
  scene.materials[2].transmission = 0.5f;
  std::vector<glm::vec3> walls;
  const auto add = [&](const glm::vec3& corner, const glm::vec3& a, const glm::vec3& b) {
    for (const glm::vec3& p : quad(corner, a, b)) walls.push_back(p);
  };
  add({-4, -1, -2}, {8, 0, 0}, {0, 0, 4});
  add({-4, 1, -2}, {8, 0, 0}, {0, 0, 4});
  add({-4, -1, -2}, {8, 0, 0}, {0, 2, 0});
  for (const float x : {-4.0f, 0.0f, 4.0f}) add({x, -1, -2}, {0, 2, 0}, {0, 0, 4});
  add_instance(scene, add_mesh(scene, walls));
  add_instance(scene, add_mesh(scene, quad({-2.5f, -0.9f, -1.0f}, {1, 0, 0}, {0, 0.8f, 0.3f}), 2));
  const std::uint32_t lamp = add_mesh(scene, quad({-0.5f, 0, -0.5f}, {1, 0, 0}, {0, 0, 1}), 1); // faces down
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < lamps; ++i) {
    const glm::dvec3 place(-3.8 + 7.6 * unit(random), -0.6 + 1.5 * unit(random), -1.8 + 3.5 * unit(random));
    const double size = 0.02 + 0.1 * unit(random) * unit(random);
    const glm::dmat4 turn =
        glm::rotate(glm::translate(glm::dmat4(1.0), place), 3.0 * unit(random), glm::dvec3(1, 2, 3));
    add_instance(scene, lamp, glm::scale(turn, glm::dvec3(i % 3 == 0 ? -size : size, size, 2.0 * size)));
  }
  for (int i = 0; i < 6; ++i) {
    PunctualLight light;
    light.kind = i % 2 == 0 ? LightKind::point : LightKind::spot;
    light.intensity = glm::vec3(0.05f);
    light.position = {-3.5 + 1.4 * i, 0.8, -0.5};
    light.direction = {0.3, -0.9, 0.3};
    light.direction = glm::normalize(light.direction);
    scene.lights.push_back(light);
  }
  if (!distant_lights) return scene;
  PunctualLight sun;
  sun.kind = LightKind::directional;
  sun.intensity = glm::vec3(0.3f);
  sun.direction = glm::normalize(glm::vec3(0.2f, -0.5f, -1.0f));
  scene.lights.push_back(sun);
  scene.environment.radiance = glm::vec3(0.2f);
  scene.environment.width = 8;
  scene.environment.height = 4;
  for (int i = 0; i < 32; ++i) scene.environment.map.emplace_back(i % 5 == 0 ? 2.0f : 0.1f);
  return scene;
}

struct Subject {
  PackedScene packed;
  View view;
};

class LightSelection : public VulkanTest {
protected:
  static void TearDownTestSuite() { kernels_.reset(); }
  static inline std::unique_ptr<KernelCompiler> kernels_; // of all tests: compiles each of them once

  static RenderSettings settings(std::uint32_t lights, std::uint32_t direct, std::uint32_t spp = 64) {
    RenderSettings settings;
    settings.width = 24, settings.height = 16;
    settings.last_sample = spp;
    settings.max_depth = 3;
    settings.integrator = &kPath;
    settings.lights = lights;
    settings.direct = direct;
    return settings;
  }
  static Subject subject(Scene scene, const RenderSettings& settings) {
    ViewRequest request;
    request.eye = glm::dvec3(-1.8, 0.1, 5.0);
    request.look_at = glm::dvec3(-1.2, 0.0, 0.0);
    return {pack(scene, {.direct = settings.direct, .eye = request.eye, .lights = settings.lights}),
            resolve_view(scene, request, settings.width, settings.height)};
  }
  RenderResult render(const Subject& subject, const RenderSettings& settings, const RenderHooks& hooks = {}) {
    if (!kernels_) kernels_ = std::make_unique<KernelCompiler>(device());
    return wavepath::render(device(), subject.packed, subject.view, settings, hooks, *kernels_);
  }
  struct Average {
    std::vector<double> mean, variance;
  };
  Average average(const Subject& subject, RenderSettings settings) {
    constexpr std::uint32_t kRenders = 8;
    std::vector<double> sum, squares;
    for (settings.seed = 1; settings.seed <= kRenders; ++settings.seed) {
      const Picture picture = render(subject, settings).picture;
      const std::size_t n = picture.channels[0].values.size();
      sum.resize(3 * n), squares.resize(3 * n);
      for (std::size_t i = 0; i < 3 * n; ++i) {
        const double value = picture.channels[i / n].values[i % n];
        sum[i] += value, squares[i] += value * value;
      }
    }
    Average result;
    for (std::size_t i = 0; i < sum.size(); ++i) {
      const double mean = sum[i] / kRenders;
      result.mean.push_back(mean);
      result.variance.push_back(std::max(0.0, squares[i] / kRenders - mean * mean) / (kRenders - 1));
    }
    return result;
  }
  // By the sum of z^2 over all values, and by the mean of the picture.
  static void expect_same_mean(const Average& a, const Average& b) {
    double squares = 0.0, judged = 0.0, difference = 0.0, noise = 0.0, total = 0.0;
    for (std::size_t i = 0; i < a.mean.size(); ++i) {
      const double d = a.mean[i] - b.mean[i], variance = a.variance[i] + b.variance[i];
      difference += d, noise += variance, total += a.mean[i];
      if (variance < 1e-12 * (1.0 + a.mean[i] * a.mean[i])) continue;
      squares += std::min(d * d / variance, 25.0);
      ++judged;
    }
    ASSERT_GT(judged, static_cast<double>(a.mean.size()) / 2.0);
    EXPECT_LT(squares / judged, 1.5);
    EXPECT_LT(std::abs(difference), 4.0 * std::sqrt(noise));
    EXPECT_LT(std::sqrt(noise), 0.01 * total) << "too much noise to tell";
  }
};

TEST_F(LightSelection, AllGiveTheSamePicture) {
  for (const bool distant : {false, true}) {
    const RenderSettings power = settings(gpu::kLightsPower, gpu::kDirectMis, 128);
    const Average reference = average(subject(two_rooms(40, distant), power), power);
    for (const std::uint32_t direct : {gpu::kDirectMis, gpu::kDirectNee})
      for (const std::uint32_t lights : {gpu::kLightsTree, gpu::kLightsLearned}) {
        SCOPED_TRACE(std::to_string(direct) + " " + std::to_string(lights) + " " + std::to_string(distant));
        const RenderSettings other = settings(lights, direct, 128);
        const Subject rooms = subject(two_rooms(40, distant), other);
        ASSERT_TRUE(rooms.packed.features & gpu::kFeatureLightTree);
        expect_same_mean(reference, average(rooms, other));
      }
  }
}

TEST_F(LightSelection, HybridPicksByTheTree) {
  RenderSettings power = settings(gpu::kLightsPower, gpu::kDirectMis, 64),
                 tree = settings(gpu::kLightsAuto, gpu::kDirectMis, 64);
  power.integrator = tree.integrator = &kHybrid;
  power.max_depth = tree.max_depth = 1;
  expect_same_mean(average(subject(two_rooms(40, true), power), power),
                   average(subject(two_rooms(40, true), tree), tree));
}

TEST_F(LightSelection, BidirectionalPicksByThem) {
  RenderSettings power = settings(gpu::kLightsPower, gpu::kDirectMis, 64);
  const Average reference = average(subject(two_rooms(40, true), power), power);
  for (const std::uint32_t lights : {gpu::kLightsTree, gpu::kLightsAuto}) {
    SCOPED_TRACE(lights);
    RenderSettings asked = settings(lights, gpu::kDirectMis, 32);
    asked.integrator = &kBidirectional;
    expect_same_mean(reference, average(subject(two_rooms(40, true), asked), asked));
  }
}

// A leaf is lit from behind.
TEST_F(LightSelection, DiffuseTransmissionIsLitFromBothSides) {
  Scene rooms = two_rooms(40, false);
  rooms.materials[0].diffuse_transmission = 0.5f;
  for (const IntegratorKind* integrator : {&kPath, &kBidirectional}) {
    SCOPED_TRACE(integrator->name);
    RenderSettings power = settings(gpu::kLightsPower, gpu::kDirectMis, 256);
    power.integrator = integrator;
    RenderSettings tree = power;
    tree.lights = gpu::kLightsTree;
    expect_same_mean(average(subject(rooms, power), power), average(subject(rooms, tree), tree));
  }
}

TEST_F(LightSelection, LessNoiseThanByPower) {
  const auto noise = [&](const IntegratorKind& integrator, std::uint32_t lights) {
    RenderSettings asked = settings(lights, gpu::kDirectMis);
    asked.integrator = &integrator;
    double sum = 0.0;
    for (const double v : average(subject(two_rooms(200, true), asked), asked).variance) sum += v;
    return sum;
  };
  const double by_power = noise(kPath, gpu::kLightsPower), by_tree = noise(kPath, gpu::kLightsTree),
               by_lesson = noise(kPath, gpu::kLightsAuto);
  EXPECT_LT(by_tree, 0.7 * by_power);
  EXPECT_LT(by_lesson, 0.8 * by_tree);
  // Light paths, which begin by power, find the lamps as well; the tree alone gains nothing here.
  EXPECT_LT(noise(kBidirectional, gpu::kLightsAuto), 0.8 * noise(kBidirectional, gpu::kLightsPower));
}

// The pilot's sums are integers: neither waves nor the generic kernels change a bit.
TEST_F(LightSelection, BitsDoNotDependOnHowTheWorkIsCut) {
  const RenderSettings whole = settings(gpu::kLightsAuto, gpu::kDirectMis, 16);
  const Subject rooms = subject(two_rooms(40, true), whole);
  const RenderResult expected = render(rooms, whole);
  EXPECT_GT(expected.light_pilot.rows, 20u);
  RenderSettings cut = whole;
  cut.wave_slots = 777;
  EXPECT_TRUE(*render(rooms, cut).film == *expected.film);
  RenderSettings generic = whole;
  generic.specialize = false;
  EXPECT_TRUE(*render(rooms, generic).film == *expected.film);
}

// Every part, and every render that is resumed, learns the same anew.
TEST_F(LightSelection, PartsJoinToTheWhole) {
  const RenderSettings whole = settings(gpu::kLightsAuto, gpu::kDirectMis, 16);
  const Subject rooms = subject(two_rooms(40, true), whole);
  const RenderResult expected = render(rooms, whole);
  RenderSettings first = whole, second = whole;
  first.last_sample = second.first_sample = 8;
  Film joined = *render(rooms, first).film;
  join(joined, *render(rooms, second).film);
  EXPECT_TRUE(joined == *expected.film);

  std::optional<RenderState> state;
  RenderHooks hooks;
  hooks.progress = [](const Progress& now) { return now.spp_done < 8; };
  hooks.save = [&](const RenderState& saved) { state = saved; };
  hooks.save_interval = 1e9; // at the end alone
  ASSERT_EQ(render(rooms, whole, hooks).stop, StopReason::interrupted);
  RenderHooks again;
  again.resume = &state.value();
  EXPECT_TRUE(*render(rooms, whole, again).film == *expected.film);
}

TEST_F(LightSelection, FewLightsNeedNoTree) {
  const RenderSettings automatic = settings(gpu::kLightsAuto, gpu::kDirectMis, 8);
  RenderSettings power = automatic;
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
  EXPECT_EQ(result.light_pilot.rows, 0u);
  EXPECT_TRUE(*result.film == *render(cornell, power).film);
  RenderSettings generic = automatic;
  generic.specialize = false;
  EXPECT_TRUE(*render(cornell, generic).film == *result.film);
}

// Many lights in few places, such as one lamp of many triangles, are as well picked by power.
TEST_F(LightSelection, LightsInFewPlacesNeedNoTree) {
  Scene scene = two_rooms(0, false);
  scene.lights.clear();
  const std::uint32_t lamp = add_mesh(scene, quad({-0.5f, 0, -0.5f}, {1, 0, 0}, {0, 0, 1}), 1);
  for (int i = 0; i < 50; ++i)
    add_instance(scene, lamp,
                 glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(1.0 + 0.004 * i, 0.5, 0)), glm::dvec3(0.003)));
  const PackedScene one_place = pack(scene);
  EXPECT_EQ(one_place.local_light_count, 100u);
  EXPECT_LT(one_place.light_places, 3.0);
  EXPECT_TRUE(one_place.light_tree.empty());
  Scene rooms = two_rooms(40, false);
  const PackedScene many_places = pack(rooms);
  EXPECT_GT(many_places.light_places, kManyPlaces);
  EXPECT_FALSE(many_places.light_tree.empty());
}

TEST_F(LightSelection, LearnsSharesFromSums) {
  const RenderSettings learned = settings(gpu::kLightsLearned, gpu::kDirectMis);
  const PackedScene packed = subject(two_rooms(40, true), learned).packed;
  std::vector<std::uint32_t> sums(kLightSumBytes / sizeof(std::uint32_t), 0);
  constexpr std::uint32_t kRow = 7, kAround = 9;
  const auto word = [&](std::uint32_t row, std::uint32_t column, std::uint32_t i) -> std::uint32_t& {
    return sums[4 * (row * gpu::kLightColumns + column) + i];
  };
  word(kRow, 2, 0) = 400, word(kRow, 2, 2) = 100; // half of them visible: root of 400 * 100
  word(kRow, 5, 0) = 1000;                        // hidden
  word(kRow, 6, 1) = 1, word(kRow, 6, 3) = 1;     // beyond 32 bits
  word(kRow, gpu::kTreeColumn, 0) = 1000000;      // picks: many enough to count alone
  word(kRow, gpu::kTreeColumn, 1) = kAround + 1;
  const LightLesson lesson = learn_light_rows(packed, sums);
  const std::vector<std::uint32_t> before = unlearned_light_rows(packed);
  EXPECT_EQ(lesson.rows, 1u);
  const auto share = [](const std::vector<std::uint32_t>& ends, std::uint32_t row, std::uint32_t column) {
    const std::size_t i = row * gpu::kLightColumns + column;
    return (ends[i] - (column > 0 ? double(ends[i - 1]) : 0.0)) / 0x1p32;
  };
  EXPECT_NEAR(share(lesson.ends, kRow, 6) / share(lesson.ends, kRow, 2), 0x1p32 / 200.0, 0.01 * 0x1p32 / 200.0);
  EXPECT_EQ(share(lesson.ends, kRow, 5), 0.0);
  EXPECT_NEAR(share(lesson.ends, kRow, 6), 0.9, 0.001);
  EXPECT_NEAR(share(lesson.ends, kRow, gpu::kTreeColumn), 0.1 * share(before, 0, gpu::kTreeColumn), 0.001);
  EXPECT_GT(share(lesson.ends, kRow, gpu::kEnvironmentColumn), 0.0);
  for (std::uint32_t column = 0; column < gpu::kLightColumns; ++column)
    EXPECT_NEAR(share(lesson.ends, 0, column), share(before, 0, column), 1e-8) << column; // nothing learned
}

} // namespace
} // namespace wavepath::test
