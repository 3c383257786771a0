// Scenes for tests of bidirectional path tracing, and what compares their light with that which path tracing finds.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host/film/film.h"
#include "host/integrators/bidirectional/kind.h"
#include "host/integrators/path/kind.h"
#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/coverage.h"
#include "tests/scene_builder.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {

inline constexpr std::uint32_t kHit = gpu::kTechniqueHit, kLight = gpu::kTechniqueLight,
                               kConnect = gpu::kTechniqueConnect, kSplat = gpu::kTechniqueSplat,
                               kMerge = gpu::kTechniqueMerge;

// All sets of `techniques` that hold at least one of `needed`.
inline std::vector<std::uint32_t> sets_of(std::uint32_t techniques, std::uint32_t needed) {
  std::vector<std::uint32_t> sets;
  for (std::uint32_t set = 1; set <= techniques; ++set)
    if ((set & ~techniques) == 0 && (set & needed) != 0) sets.push_back(set);
  return sets;
}

inline std::vector<glm::vec3> quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) { return {a, b, c, a, c, d}; }

// A camera at `eye` that looks at the origin, +Y up.
inline Camera camera_at(const glm::dvec3& eye, bool orthographic = false) {
  Camera camera;
  const glm::dvec3 back = glm::normalize(eye), right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back));
  camera.world_from_camera =
      glm::dmat4(glm::dvec4(right, 0), glm::dvec4(glm::cross(back, right), 0), glm::dvec4(back, 0), glm::dvec4(eye, 1));
  camera.orthographic = orthographic;
  camera.xmag = 1.2, camera.ymag = 0.8;
  return camera;
}

// A floor, a wall and a glossy metal plate that leans between them; without lights.
inline Scene corner(bool orthographic = false) {
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

inline void add_lamp(Scene& scene, LightKind kind) {
  PunctualLight light;
  light.kind = kind;
  light.intensity = kind == LightKind::directional ? glm::vec3(2.0f, 1.5f, 1.0f) : glm::vec3(4.0f, 3.0f, 2.0f);
  light.position = {0.8, 1.5, 1.0};
  light.direction = glm::normalize(glm::dvec3(-0.4, -1.0, -0.5));
  light.outer_cone = 0.9;
  scene.lights.push_back(light);
}

inline void add_shining_quad(Scene& scene, float size = 1.0f) {
  Material shining = plain_material();
  shining.emission = {6.0f, 5.0f, 4.0f};
  scene.materials.push_back(shining);
  add_instance(scene, add_mesh(scene,
                               quad({-0.4f * size, 1.4f, 0.2f}, {0.3f * size, 1.4f, 0.2f},
                                    {0.3f * size, 1.6f, 0.8f * size}, {-0.4f * size, 1.6f, 0.8f * size}),
                               static_cast<std::uint32_t>(scene.materials.size() - 1)));
}

// Two quads whose emission is a picture: dark, with a few bright texels.
inline void add_pictures(Scene& scene) {
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

inline void add_box(Scene& scene, glm::vec3 lo, glm::vec3 hi, std::uint32_t material) {
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

inline void add_sky(Scene& scene) {
  Environment& sky = scene.environment;
  sky.radiance = glm::vec3(1.0f);
  sky.width = 16, sky.height = 8;
  for (std::uint32_t i = 0; i < sky.width * sky.height; ++i) {
    const float across = static_cast<float>(i % sky.width) / 16.0f, down = static_cast<float>(i / sky.width) / 8.0f;
    sky.map.emplace_back(1.5f - down, 1.0f, 0.3f + across * across + (down < 0.3f ? 1.0f : 0.0f));
  }
  sky.rotation = 0.7;
}

struct Subject {
  PackedScene packed;
  View view;

  Subject(Scene scene, const RenderPlan& settings)
      : packed(pack(scene, {.direct = settings.direct, .lights = settings.lights})),
        view(resolve_view(scene, {}, settings.width, settings.height)) {}
};

// Mean luminance of the picture and of six parts of it, over independent renders, and the variance of that mean.
inline constexpr std::size_t kParts = 7;
struct Average {
  std::array<double, kParts> mean{}, variance{};
};

inline std::array<double, kParts> parts_of(const Picture& picture) {
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

class BidirectionalTest : public VulkanTest {
protected:
  // Compiles each of them once, and waits for what is being compiled before the driver's own statics go.
  static inline std::unique_ptr<KernelCompiler> kernels_;
  static void TearDownTestSuite() { kernels_.reset(); }

  static RenderPlan settings(std::uint32_t spp, std::uint32_t depth, std::uint32_t techniques = gpu::kTechniquesAll) {
    RenderPlan settings;
    settings.width = 18, settings.height = 12;
    settings.last_sample = spp;
    settings.max_depth = depth;
    settings.integrator = &kBidirectional;
    settings.techniques = techniques;
    return settings;
  }
  static RenderPlan path_settings(std::uint32_t spp, std::uint32_t depth) {
    RenderPlan plain = settings(spp, depth);
    plain.integrator = &kPath;
    return plain;
  }
  RenderResult render(const Subject& subject, const RenderPlan& settings) {
    if (!kernels_) kernels_ = std::make_unique<KernelCompiler>(device());
    RenderResult result = wavepath::render(device(), subject.packed, subject.view, settings, RenderHooks{}, *kernels_);
    EXPECT_EQ(result.nonfinite.samples(), 0u);
    return result;
  }
  // Whatever the waves are long, and with generic kernels.
  void expect_same_film_however_cut(const Subject& subject, const RenderPlan& whole, const Film& expected) {
    for (const std::uint32_t slots : {64u, 700u}) {
      RenderPlan cut = whole;
      cut.wave_slots = slots;
      EXPECT_TRUE(*render(subject, cut).film == expected) << slots << " slots";
    }
    RenderPlan generic = whole;
    generic.specialize = false;
    EXPECT_TRUE(*render(subject, generic).film == expected) << "generic kernels";
  }
  Average average(const Subject& subject, RenderPlan settings) {
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
  // The interval of most coarse renders holds their error against the reference.
  void expect_intervals_cover(const Subject& subject, const Picture& reference, RenderPlan coarse) {
    constexpr std::uint32_t kRenders = 16;
    const Coverage found = measure_coverage(reference, kRenders, [&](std::uint32_t seed) {
      coarse.seed = 100 + seed;
      return render(subject, coarse);
    });
    EXPECT_GE(found.covered, 12u) << "of " << kRenders;
  }
  // Each set of techniques gives what path tracing gives. `adjust`: other settings, of both.
  void expect_path_light(const Scene& scene, std::uint32_t depth, const std::vector<std::uint32_t>& sets,
                         std::uint32_t spp = 32, const std::function<void(RenderPlan&)>& adjust = {}) {
    RenderPlan path = path_settings(4 * spp, depth);
    if (adjust) adjust(path);
    const Average expected = average(Subject(scene, path), path);
    for (const std::uint32_t techniques : sets) {
      SCOPED_TRACE(techniques);
      RenderPlan asked = settings(spp, depth, techniques);
      if (adjust) adjust(asked);
      expect_same_mean(average(Subject(scene, asked), asked), expected);
    }
  }
};

} // namespace wavepath::test
