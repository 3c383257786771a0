// A scene for tests of shadow techniques: bodies above a floor under one light, and the light that arrives at every
// pixel.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "host/integrators/hybrid/kind.h"
#include "host/integrators/hybrid/shadows/catalogue.h"
#include "host/render/render.h"
#include "host/render/settings/shadow_settings.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "kernels/hybrid/shadows/shadow_types.h"
#include "tests/scene_builder.h"
#include "tests/shared_kernels.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {

// The corners of a rectangle with the given middle, counter-clockwise seen from where cross(u, v) points to.
inline std::vector<glm::vec3> rectangle(glm::vec3 middle, glm::vec3 u, glm::vec3 v) {
  const glm::vec3 a = middle - u - v, b = middle + u - v, c = middle + u + v, d = middle - u + v;
  return {a, b, c, a, c, d};
}

// A closed box, faces outwards.
inline std::vector<glm::vec3> box(glm::vec3 middle, glm::vec3 half) {
  std::vector<glm::vec3> corners;
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {1.0f, -1.0f}) {
      glm::vec3 n(0.0f), u(0.0f), v(0.0f);
      n[axis] = sign * half[axis];
      u[(axis + 1) % 3] = sign * half[(axis + 1) % 3];
      v[(axis + 2) % 3] = half[(axis + 2) % 3];
      for (const glm::vec3& p : rectangle(middle + n, u, v)) corners.push_back(p);
    }
  return corners;
}

// A closed ball of 16 x 12 facets, faces outwards; its corners lie on the sphere.
inline std::vector<glm::vec3> ball(glm::vec3 middle, float radius) {
  constexpr int kAround = 16, kDown = 12;
  const auto at = [&](int i, int j) {
    if (j == 0 || j == kDown) return middle + glm::vec3(0, j == 0 ? radius : -radius, 0);
    const float across = 6.2831853f * static_cast<float>(i % kAround) / kAround,
                down = 3.1415927f * static_cast<float>(j) / kDown;
    return middle +
           radius * glm::vec3(std::sin(down) * std::cos(across), std::cos(down), std::sin(down) * std::sin(across));
  };
  std::vector<glm::vec3> corners;
  for (int j = 0; j < kDown; ++j)
    for (int i = 0; i < kAround; ++i) {
      if (j > 0) corners.insert(corners.end(), {at(i, j), at(i + 1, j), at(i, j + 1)});
      if (j + 1 < kDown) corners.insert(corners.end(), {at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return corners;
}

// Every value of the setting is the name of one technique, in the order of the registry, or of what is built in.
template <class Kind>
void expect_names_of_own(const Registry<Kind>& registry) {
  const std::vector<std::string_view> names = choices_of(setting_named(registry.setting));
  ASSERT_EQ(names.size(), registry.rows.size() + (registry.built_in.empty() ? 0 : 1));
  RenderPlan settings;
  for (std::uint32_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(std::ranges::count(names, names[i]), 1) << names[i];
    settings.*registry.value = i;
    EXPECT_EQ(registry.name(settings), names[i]);
    const Kind* row = registry.find(settings);
    EXPECT_EQ(row == nullptr, names[i] == registry.built_in) << names[i];
    if (row) {
      EXPECT_FALSE(row->summary.empty()) << names[i];
    }
  }
}

inline std::uint32_t index_of(std::span<const std::string_view> names, std::string_view name) {
  return static_cast<std::uint32_t>(std::ranges::find(names, name) - names.begin());
}

// The picture's settings: one frame of direct light, so that techniques see the same points as rays do.
inline RenderPlan shadow_settings(std::string_view technique, std::uint32_t map_size = 512) {
  RenderPlan settings;
  settings.integrator = &kHybrid;
  settings.width = 96, settings.height = 72;
  settings.last_sample = 1;
  settings.max_depth = 1;
  settings.direct = gpu::kDirectNee;
  settings.shadows = index_of(kShadowTechniques.names(), technique);
  settings.shadow_size = map_size;
  return settings;
}

inline PunctualLight sun(glm::dvec3 direction = {0.4, -1.0, 0.25}) {
  PunctualLight light;
  light.kind = LightKind::directional;
  light.intensity = glm::vec3(3.0f);
  light.direction = glm::normalize(direction);
  return light;
}
inline PunctualLight spot(glm::dvec3 position = {-1.2, 3.0, -0.8}, glm::dvec3 target = {0.0, 0.0, 0.0}) {
  PunctualLight light;
  light.kind = LightKind::spot;
  light.intensity = glm::vec3(30.0f);
  light.position = position;
  light.direction = glm::normalize(target - position);
  light.inner_cone = 0.4, light.outer_cone = 0.7;
  return light;
}
inline PunctualLight lamp(glm::dvec3 position = {-1.2, 2.0, -0.8}) {
  PunctualLight light;
  light.intensity = glm::vec3(20.0f);
  light.position = position;
  return light;
}

// A floor, two boxes (one of them floats), a camera that looks down on them.
inline Scene bodies() {
  Scene scene;
  scene.path = "test";
  Material material = plain_material();
  material.double_sided = false;
  scene.materials.push_back(material);
  add_instance(scene, add_mesh(scene, rectangle({0, 0, 0}, {0, 0, 3}, {3, 0, 0})));
  add_instance(scene, add_mesh(scene, box({-0.3f, 0.5f, 0.1f}, {0.3f, 0.5f, 0.3f})));
  add_instance(scene, add_mesh(scene, box({0.7f, 0.9f, -0.3f}, {0.35f, 0.05f, 0.35f})));
  Camera camera;
  const glm::dvec3 eye(0.5, 3.2, 3.4), forward = glm::normalize(glm::dvec3(0.1, 0.1, 0.0) - eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0))), up = glm::cross(right, forward);
  camera.world_from_camera = {glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(-forward, 0), glm::dvec4(eye, 1)};
  scene.cameras.push_back(camera);
  return scene;
}

inline Scene lit_by(const PunctualLight& light) {
  Scene scene = bodies();
  scene.lights.push_back(light);
  return scene;
}

// Under a lamp of these triangles.
inline Scene lit_by_lamp(const std::vector<glm::vec3>& corners) {
  Scene scene = bodies();
  Material emitter = plain_material();
  emitter.base_color = {0, 0, 0, 1};
  emitter.emission = glm::vec3(30.0f);
  emitter.double_sided = false;
  scene.materials.push_back(emitter);
  add_instance(scene, add_mesh(scene, corners, 1));
  return scene;
}
// Under a square lamp that faces down.
inline Scene lit_by_square(float half = 0.25f, float height = 2.5f) {
  return lit_by_lamp(rectangle({0.0f, height, 0.0f}, {half, 0, 0}, {0, 0, half}));
}

// A camera above the floor's point `at` that looks straight down, `half` metres of floor to either side.
inline Camera camera_above(glm::dvec3 at, double half) {
  Camera camera;
  camera.orthographic = true;
  camera.xmag = camera.ymag = half;
  camera.world_from_camera = {{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, glm::dvec4(at + glm::dvec3(0, 3, 0), 1)};
  return camera;
}

inline const std::vector<float>& channel(const Picture& picture, std::string_view name) {
  const auto found =
      std::ranges::find_if(picture.channels, [&](const Channel& channel) { return channel.name == name; });
  EXPECT_NE(found, picture.channels.end()) << name;
  return found->values;
}

// Renders with kernels that tests share.
class ShadowTest : public VulkanTest {
protected:
  RenderResult render(Scene scene, const RenderPlan& settings) {
    const View view = resolve_view(scene, {}, settings.width, settings.height);
    const PackedScene packed = pack(scene, {.direct = direct_of(settings)});
    return wavepath::render(device(), packed, view, settings, RenderHooks{}, shared_kernels(device()));
  }
  // Green of every pixel.
  std::vector<float> light(const Scene& scene, const RenderPlan& settings) {
    return render(scene, settings).picture.channels[1].values;
  }
};

// Fraction of the pixels that are lit in one picture and dark in the other: falsely lit, falsely dark.
struct FalseFractions {
  double lit = 0.0, dark = 0.0;
  double total() const { return lit + dark; }
};
inline FalseFractions false_fractions(const std::vector<float>& truth, const std::vector<float>& picture) {
  FalseFractions fractions;
  const double one = 1.0 / static_cast<double>(truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (truth[i] == 0.0f && picture[i] > 0.0f) fractions.lit += one;
    if (truth[i] > 0.0f && picture[i] == 0.0f) fractions.dark += one;
  }
  return fractions;
}

} // namespace wavepath::test
