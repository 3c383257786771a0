// --terminator smooth: a coarse sphere with smooth normals is lit as a sphere, whoever looks and however it is placed;
// meshes without such normals, and renders without the setting, stay as they are.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/film/film.h"
#include "host/integrators/hybrid/kind.h"
#include "host/integrators/path/kind.h"
#include "host/integrators/whitted/kind.h"
#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/scene_builder.h"
#include "tests/shared_kernels.h"
#include "tests/statistics.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

constexpr std::uint32_t kSide = 48; // of the picture, which shows the square around the sphere

// Of the unit sphere, as exporters make them: rings and segments around +Y, with the sphere's own normals.
void add_sphere(Scene& scene, std::uint32_t rings, std::uint32_t segments) {
  const auto corner = [&](std::uint32_t ring, std::uint32_t segment) {
    const float theta = std::numbers::pi_v<float> * static_cast<float>(ring) / static_cast<float>(rings);
    const float phi = 2.0f * std::numbers::pi_v<float> * static_cast<float>(segment) / static_cast<float>(segments);
    return glm::vec3(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
  };
  std::vector<glm::vec3> corners;
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < segments; ++j) {
      const glm::vec3 a = corner(i, j), b = corner(i + 1, j), c = corner(i + 1, j + 1), d = corner(i, j + 1);
      if (i + 1 < rings) corners.insert(corners.end(), {a, b, c});
      if (i > 0) corners.insert(corners.end(), {a, c, d});
    }
  const std::uint32_t mesh = add_mesh(scene, corners);
  scene.meshes[mesh].normals = corners;
  scene.meshes[mesh].primitives[0].has_normals = true;
}

// Under a sun from +X of pi lux, seen along -Z: white is 1 where it faces the sun.
Scene lit_sphere() {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  scene.materials[0].base_color = glm::vec4(1.0f);
  add_sphere(scene, 8, 14);
  add_instance(scene, 0, glm::rotate(glm::dmat4(1.0), 0.3, glm::dvec3(1, 1, 1))); // facets across the terminator
  PunctualLight sun;
  sun.kind = LightKind::directional;
  sun.direction = {-1, 0, 0};
  sun.intensity = glm::vec3(std::numbers::pi_v<float>);
  scene.lights.push_back(sun);
  Camera camera;
  camera.orthographic = true;
  camera.world_from_camera = glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0, 5));
  scene.cameras.push_back(camera);
  return scene;
}

class Terminator : public VulkanTest {
protected:
  RenderResult render(Scene scene, std::uint32_t terminator, const IntegratorKind* integrator = &kPath,
                      std::uint32_t direct = gpu::kDirectMis, std::uint32_t seed = 0) {
    RenderPlan settings;
    settings.direct = direct;
    settings.seed = seed;
    settings.width = settings.height = kSide;
    settings.last_sample = 16;
    settings.max_depth = 1;
    settings.integrator = integrator;
    settings.terminator = terminator;
    const View view = resolve_view(scene, {}, kSide, kSide);
    const PackedScene packed = pack(scene, {.direct = direct});
    return wavepath::render(device(), packed, view, settings, RenderHooks{}, shared_kernels(device()));
  }

  // Mean squared error against the smooth sphere, where the sun grazes and the eye does not.
  static double error(const RenderResult& result) {
    double squares = 0.0;
    std::size_t count = 0;
    for (std::uint32_t y = 0; y < kSide; ++y)
      for (std::uint32_t x = 0; x < kSide; ++x) {
        const double u = 2.0 * (x + 0.5) / kSide - 1.0, v = 2.0 * (y + 0.5) / kSide - 1.0;
        if (u * u + v * v > 0.8 * 0.8 || std::abs(u) > 0.35) continue;
        squares += std::pow(result.picture.channels[0].values[y * kSide + x] - std::max(u, 0.0), 2);
        ++count;
      }
    return squares / static_cast<double>(count);
  }
};

TEST_F(Terminator, ACoarseSphereIsLitAsASphere) {
  for (const IntegratorKind* integrator : {&kPath, &kHybrid, &kWhitted}) {
    const double facets = error(render(lit_sphere(), gpu::kTerminatorFacets, integrator)),
                 smooth = error(render(lit_sphere(), gpu::kTerminatorSmooth, integrator));
    EXPECT_LT(smooth, 0.02 * facets) << integrator->name;
  }
}

// Shown twice, so that the mesh is an object of its own; turned, mirrored and grown.
TEST_F(Terminator, HoldsForInstances) {
  Scene scene = lit_sphere();
  const glm::dmat4 mirrored = glm::scale(glm::dmat4(1.0), glm::dvec3(2, -2, 2));
  scene.instances[0].world_from_object = glm::rotate(mirrored, 0.3, glm::dvec3(1, 1, 1));
  add_instance(scene, 0, glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0, -50)));
  scene.cameras[0].xmag = scene.cameras[0].ymag = 2.0;
  EXPECT_LT(error(render(scene, gpu::kTerminatorSmooth)), 0.05 * error(render(scene, gpu::kTerminatorFacets)));
}

TEST_F(Terminator, LeavesFlatMeshesAlone) {
  Scene flat = lit_sphere();
  flat.meshes[0].normals.clear();
  flat.meshes[0].primitives[0].has_normals = false;
  EXPECT_TRUE(*render(flat, gpu::kTerminatorFacets).film == *render(flat, gpu::kTerminatorSmooth).film);
}

// Rays towards a near lamp and rays that find it by chance leave from the same point, so that both ways to find its
// light tell the same, and so does their combination.
TEST_F(Terminator, AllWaysToFindLightAgree) {
  Scene scene = lit_sphere();
  scene.lights.clear();
  scene.materials.push_back(plain_material());
  scene.materials[1].emission = glm::vec3(4.0f);
  const glm::vec3 a{1.2f, -1, -1}, b{1.2f, -1, 1}, c{1.2f, 1, 1}, d{1.2f, 1, -1};
  add_instance(scene, add_mesh(scene, {a, b, c, a, c, d}, 1));
  Mean means[3];
  const std::uint32_t ways[] = {gpu::kDirectMis, gpu::kDirectNee, gpu::kDirectBsdf};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::uint32_t seed = 0; seed < 12; ++seed) {
      const RenderResult result = render(scene, gpu::kTerminatorSmooth, &kPath, ways[i], seed);
      const std::vector<float>& values = result.picture.channels[0].values;
      means[i].add(std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size()));
    }
  EXPECT_GT(means[0].mean(), 0.05);
  for (std::size_t i = 1; i < 3; ++i) {
    const double noise = std::hypot(means[0].error(), means[i].error());
    EXPECT_NEAR(means[i].mean(), means[0].mean(), 4.5 * noise) << ways[i];
    EXPECT_LT(noise, 0.02 * means[0].mean());
  }
}

} // namespace
} // namespace wavepath::test
