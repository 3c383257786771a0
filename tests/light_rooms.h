// Two rooms with lamps, a sun and a sky, and what tests of choosing lights measure of their pictures.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/film/film.h"
#include "host/integrators/path/kind.h"
#include "host/render/loop/render_state.h"
#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/mean_picture.h"
#include "tests/scene_builder.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {

inline std::vector<glm::vec3> quad(const glm::vec3& corner, const glm::vec3& a, const glm::vec3& b) {
  return {corner, corner + a, corner + a + b, corner, corner + a + b, corner + b};
}

// Two rooms side by side with a wall between them, open in front. Lamps of one mesh, placed and scaled at random, some
// mirrored, hang in both; points and spots, a sun and a sky that shines in through the open side.
inline Scene two_rooms(int lamps, bool distant_lights) {
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

// Renders them, and compares pictures by the spread of several seeds.
class LightRooms : public VulkanTest {
protected:
  static void TearDownTestSuite() { kernels_.reset(); }
  static inline std::unique_ptr<KernelCompiler> kernels_; // of all tests: compiles each of them once

  static RenderPlan settings(std::uint32_t lights, std::uint32_t direct, std::uint32_t spp = 64) {
    RenderPlan settings;
    settings.width = 24, settings.height = 16;
    settings.last_sample = spp;
    settings.max_depth = 3;
    settings.integrator = &kPath;
    settings.lights = lights;
    settings.direct = direct;
    return settings;
  }
  static Subject subject(Scene scene, const RenderPlan& settings) {
    ViewRequest request;
    request.eye = glm::dvec3(-1.8, 0.1, 5.0);
    request.look_at = glm::dvec3(-1.2, 0.0, 0.0);
    return {pack(scene, {.direct = settings.direct, .eye = request.eye, .lights = settings.lights}),
            resolve_view(scene, request, settings.width, settings.height)};
  }
  RenderResult render(const Subject& subject, const RenderPlan& settings, const RenderHooks& hooks = {},
                      SceneOnDevice* shared = nullptr) {
    if (!kernels_) kernels_ = std::make_unique<KernelCompiler>(device());
    return wavepath::render(device(), subject.packed, subject.view, settings, hooks, *kernels_, shared);
  }
  MeanPicture average(const Subject& subject, const RenderPlan& settings) {
    return mean_picture(settings, [&](const RenderPlan& seeded) { return render(subject, seeded); });
  }
  static void expect_same(const MeanPicture& a, const MeanPicture& b) { expect_same_mean(a, b, 0.5, 0.01); }
  // Whatever the waves are long, with generic kernels, and in two parts.
  void expect_same_film_however_cut(const Subject& subject, const RenderPlan& whole, const Film& expected) {
    RenderPlan cut = whole, generic = whole, first = whole, second = whole;
    cut.wave_slots = 777;
    EXPECT_TRUE(*render(subject, cut).film == expected) << "short waves";
    generic.specialize = false;
    EXPECT_TRUE(*render(subject, generic).film == expected) << "generic kernels";
    first.last_sample = second.first_sample = whole.last_sample / 2;
    first.sample_total = second.sample_total = whole.last_sample;
    Film joined = *render(subject, first).film;
    join(joined, *render(subject, second).film);
    EXPECT_TRUE(joined == expected) << "two parts";
  }
  // Interrupted after half of its samples and resumed.
  void expect_same_film_resumed(const Subject& subject, const RenderPlan& whole, const Film& expected) {
    std::optional<RenderState> state;
    RenderHooks hooks;
    hooks.progress = [&](const Progress& now) { return now.spp_done < whole.last_sample / 2; };
    hooks.save = [&](const RenderState& saved) { state = saved; };
    hooks.save_interval = 1e9; // at the end alone
    ASSERT_EQ(render(subject, whole, hooks).stop, StopReason::interrupted);
    RenderHooks again;
    again.resume = &state.value();
    EXPECT_TRUE(*render(subject, whole, again).film == expected) << "resumed";
  }
};

} // namespace wavepath::test
