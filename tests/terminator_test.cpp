// --terminator smooth: a coarse sphere with smooth normals is lit as a sphere, whoever looks and however it is placed;
// meshes without such normals, and renders without the setting, stay as they are.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/integrators/hybrid/kind.h"
#include "host/integrators/path/kind.h"
#include "host/integrators/whitted/kind.h"
#include "host/render/device/kernel_compiler.h"
#include "host/render/render.h"
#include "host/scene/pack/pack.h"
#include "host/scene/view.h"
#include "tests/scene_builder.h"
#include "tests/shared_kernels.h"
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
  add_sphere(scene, 8, 16);
  add_instance(scene, 0);
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
  RenderResult render(Scene scene, std::uint32_t terminator, const IntegratorKind* integrator = &kPath) {
    RenderSettings settings;
    settings.width = settings.height = kSide;
    settings.last_sample = 16;
    settings.max_depth = 1;
    settings.integrator = integrator;
    settings.terminator = terminator;
    const View view = resolve_view(scene, {}, kSide, kSide);
    const PackedScene packed = pack(scene);
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
    std::printf("%s: %g %g\n", std::string(integrator->name).c_str(), facets, smooth);
    EXPECT_LT(smooth, 0.1 * facets) << integrator->name;
  }
}

} // namespace
} // namespace wavepath::test
