// Whole renders through volumes of voxels, beside closed forms and quadrature.
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/integrators/bidirectional/kind.h"
#include "host/integrators/path/kind.h"
#include "host/render/render.h"
#include "host/scene/blackbody.h"
#include "host/scene/pack/light_groups.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/scene_builder.h"
#include "tests/shared_kernels.h"
#include "tests/voxel_builder.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

constexpr double kPi = std::numbers::pi;

class VolumeRender : public VulkanTest {
protected:
  RenderPlan plan(std::uint32_t spp, std::uint32_t depth) {
    RenderPlan asked;
    asked.width = asked.height = 16;
    asked.last_sample = spp;
    asked.max_depth = depth;
    asked.integrator = &kPath;
    asked.filter = gpu::kFilterBox;
    return asked;
  }
  // Mean over the picture.
  glm::dvec3 mean(Scene scene, const View& view, const RenderPlan& asked) {
    const PackedScene packed = pack(scene, {.eye = view.position});
    const RenderResult result = render(device(), packed, view, asked, RenderHooks{}, shared_kernels(device()));
    EXPECT_EQ(result.nonfinite.samples(), 0u);
    glm::dvec3 sum(0.0);
    for (int c = 0; c < 3; ++c)
      for (const float v : result.picture.channels[static_cast<std::size_t>(c)].values) sum[c] += v;
    return sum / static_cast<double>(asked.width * asked.height);
  }
};

// Parallel rays towards `target`.
View orthographic(glm::dvec3 target, glm::dvec3 towards, double half, double distance) {
  View view;
  view.orthographic = true;
  view.forward = glm::normalize(towards);
  view.position = target - distance * view.forward;
  const glm::dvec3 aside = std::abs(view.forward.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
  view.right = half * glm::normalize(glm::cross(view.forward, aside));
  view.up = glm::cross(view.right, view.forward);
  return view;
}

// A scene without surfaces but one far away behind the camera, which no test sees.
Scene scene_of(const Volume& volume, glm::vec3 sky) {
  Scene scene = triangle_scene();
  for (glm::vec3& p : scene.meshes[0].positions) p = 1e-3f * p + glm::vec3(0.0f, 0.0f, 500.0f);
  scene.volume = volume;
  scene.environment.radiance = sky;
  return scene;
}

// A lump with holes: no cell is homogeneous, and some are empty.
double lump(const glm::dvec3& p) {
  const double r = glm::length(p);
  return r < 1.0 ? (1.0 - r) * (1.2 + std::sin(9.0 * p.x) * std::cos(7.0 * p.y + p.z)) * 4.0 : 0.0;
}

TEST_F(VolumeRender, WhiteCloudsInAWhiteFurnaceReturnAllLight) {
  for (const float g : {0.0f, 0.8f, -0.5f}) {
    Volume cloud = sampled_volume({-1, -1, -1}, {1, 1, 1}, 40, lump);
    cloud.scattering = glm::vec3(6.0f, 3.0f, 1.0f);
    cloud.anisotropy = g;
    const glm::dvec3 seen =
        mean(scene_of(cloud, glm::vec3(1.0f)), orthographic({0, 0, 0}, {0.3, -0.5, 0.8}, 0.6, 5.0), plan(256, 2000));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], 1.0, 0.01) << "g " << g;
  }
}

// The integral of the interpolated density along a ray, by Simpson's rule between the planes of voxels.
double optical_depth(const Volume& volume, const glm::dvec3& from, const glm::dvec3& to) {
  constexpr int kSteps = 40000;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) sum += density_at(volume, glm::mix(from, to, (i + 0.5) / kSteps));
  return sum * glm::distance(from, to) / kSteps;
}

TEST_F(VolumeRender, AbsorbsAsQuadratureSays) {
  Volume smoke = sampled_volume({-1, -1, -1}, {1, 1, 1}, 40, lump);
  smoke.scattering = glm::vec3(0.0f);
  smoke.absorption = glm::vec3(0.5f, 1.5f, 4.0f);
  smoke.world_from_grid = glm::rotate(glm::translate(glm::dmat4(1.0), {100.0, -3.0, 0.25}), 0.7, {0.6, 0.8, 0.0});
  for (const double x : {0.0, 0.31, -0.77}) {
    const glm::dvec3 target = glm::dvec3(100.0 + x, -3.0 + 0.4 * x, 0.25),
                     towards = glm::normalize(glm::dvec3(0.2, 0.1, 1));
    const glm::dvec3 seen =
        mean(scene_of(smoke, glm::vec3(1.0f)), orthographic(target, towards, 1e-7, 5.0), plan(4096, 8));
    const double depth = optical_depth(smoke, target - 5.0 * towards, target + 5.0 * towards);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(seen[c], std::exp(-depth * smoke.absorption[c]), 0.002) << "x " << x << ", channel " << c;
  }
}

// Shadow rays: what a floor of Lambert receives from a sun through the lump, and single scattering by quadrature.
TEST_F(VolumeRender, DimsTheSunAsQuadratureSays) {
  Volume smoke = sampled_volume({-1, -1, -1}, {1, 1, 1}, 40, lump);
  smoke.scattering = glm::vec3(0.0f);
  smoke.absorption = glm::vec3(0.3f, 1.0f, 2.5f);
  Scene scene = triangle_scene();
  scene.meshes[0].positions = {{-9, -2, -9}, {-9, -2, 27}, {27, -2, -9}};
  scene.materials[0].base_color = glm::vec4(1.0f);
  scene.volume = smoke;
  const glm::dvec3 to_sun = glm::normalize(glm::dvec3(0.3, 1.0, -0.2));
  scene.lights.push_back(
      {.name = "sun", .kind = LightKind::directional, .intensity = glm::vec3(2.0f), .direction = -to_sun});
  for (const double x : {0.0, 0.4}) {
    const glm::dvec3 place(x - 0.6, -2.0, 0.3);
    const View view = orthographic(place, {0.0, -1.0, 1e-3}, 1e-6, 0.5);
    const glm::dvec3 seen = mean(scene, view, plan(4096, 1));
    const double depth = optical_depth(smoke, place, place + 5.0 * to_sun);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(seen[c] * kPi, 2.0 * to_sun.y * std::exp(-depth * smoke.absorption[c]), 0.004)
          << x << ", channel " << c;
  }
}

// One scattering of the sun's light, by quadrature along the ray of the camera.
TEST_F(VolumeRender, ScattersOnceAsQuadratureSays) {
  Volume mist = sampled_volume({-1, -1, -1}, {1, 1, 1}, 24, lump);
  mist.scattering = glm::vec3(0.3f, 0.6f, 0.9f);
  mist.absorption = glm::vec3(0.5f, 0.2f, 0.0f);
  const glm::dvec3 to_sun = glm::normalize(glm::dvec3(0.4, 0.9, 0.5)), towards(0.0, 0.0, 1.0);
  for (const float g : {0.0f, 0.6f}) {
    mist.anisotropy = g;
    Scene scene = scene_of(mist, glm::vec3(0.0f));
    scene.lights.push_back(
        {.name = "sun", .kind = LightKind::directional, .intensity = glm::vec3(3.0f), .direction = -to_sun});
    const glm::dvec3 target(0.21, -0.13, 0.0);
    const glm::dvec3 seen = mean(scene, orthographic(target, towards, 1e-7, 5.0), plan(8192, 1));
    glm::dvec3 expected(0.0);
    constexpr int kSteps = 600;
    const double cosine = glm::dot(to_sun, towards); // the same for the light on its way
    const double phase = (1.0 - g * g) / (4.0 * kPi * std::pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
    double before = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const double step = 3.0 / kSteps;
      const glm::dvec3 at = target + (-1.5 + (i + 0.5) * step) * towards;
      const double density = density_at(mist, at);
      before += 0.5 * density * step;
      double above = 0.0;
      constexpr int kAbove = 300;
      for (int k = 0; k < kAbove; ++k)
        above += density_at(mist, at + (k + 0.5) * (3.0 / kAbove) * to_sun) * 3.0 / kAbove;
      for (int c = 0; c < 3; ++c) {
        const double extinction = mist.scattering[c] + mist.absorption[c];
        expected[c] += std::exp(-extinction * (before + above)) * mist.scattering[c] * density * step * phase * 3.0;
      }
      before += 0.5 * density * step;
    }
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c] / expected[c], 1.0, 0.01) << "g " << g << ", channel " << c;
  }
}

// Layers of the same density across: a slab so wide that its ends do not count. `thickness`: with the ramps of the
// first and the last voxel, which are as deep as half of one.
Volume slab_volume(double thickness, double half_width) {
  return sampled_volume({-half_width, -0.5 * thickness, -half_width}, {half_width, 0.5 * thickness, half_width}, 32,
                        [](const glm::dvec3&) { return 1.0; });
}

// Chandrasekhar's H function for isotropic scattering, by iteration (Radiative Transfer, 1950, chapter V).
double chandrasekhar_h(double mu, double albedo) {
  constexpr std::size_t kNodes = 400;
  std::vector<double> h(kNodes, 1.0);
  const auto value = [&](double m) {
    double integral = 0.0;
    for (std::size_t i = 0; i < kNodes; ++i) {
      const double x = (static_cast<double>(i) + 0.5) / kNodes;
      integral += x * h[i] / (m + x) / kNodes;
    }
    return 1.0 / (std::sqrt(1.0 - albedo) + 0.5 * albedo * integral);
  };
  for (int round = 0; round < 200; ++round) {
    std::vector<double> next(kNodes);
    for (std::size_t i = 0; i < kNodes; ++i) next[i] = value((static_cast<double>(i) + 0.5) / kNodes);
    h = next;
  }
  return value(mu);
}

// A deep slab under a white sky reflects 1 - H(mu) sqrt(1 - albedo) towards mu. Three albedos at once: every channel
// must be right though one alone draws the distances.
TEST_F(VolumeRender, DeepSlabsReflectAsChandrasekharSays) {
  const glm::dvec3 albedo(0.5, 0.9, 0.98);
  Volume slab = slab_volume(60.0, 400.0);
  slab.scattering = glm::vec3(albedo);
  slab.absorption = glm::vec3(1.0 - albedo);
  for (const double mu : {1.0, 0.4}) {
    const glm::dvec3 down(std::sqrt(1.0 - mu * mu), -mu, 0.0);
    const glm::dvec3 seen =
        mean(scene_of(slab, glm::vec3(1.0f)), orthographic({0, 30, 0}, down, 0.5, 100.0), plan(256, 2000));
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(seen[c], 1.0 - chandrasekhar_h(mu, albedo[c]) * std::sqrt(1.0 - albedo[c]), 0.008)
          << "mu " << mu << ", albedo " << albedo[c];
  }
}

// A slab of one temperature that only absorbs shows (1 - exp(-depth)) B.
TEST_F(VolumeRender, FireShinesAsAbsorptionSays) {
  Volume fire = slab_volume(2.0, 4.0);
  VolumeGrids grids = *fire.grids;
  grids.temperature = sampled_grid({-6, -3, -6}, {6, 3, 6}, 10, [](const glm::dvec3&) { return 3.0; });
  fire.grids = std::make_shared<const VolumeGrids>(std::move(grids));
  fire.scattering = glm::vec3(0.0f);
  fire.absorption = glm::vec3(0.2f, 1.0f, 3.0f);
  fire.emission = 2.0f;
  fire.temperature_scale = 2000.0f;
  fire.temperature_offset = 0.5f;
  ASSERT_TRUE(fire.shines());
  const glm::vec4 color = blackbody_table(5000.0f, 6000.0f, 2)[0];
  const glm::dvec3 towards = glm::normalize(glm::dvec3(0.1, -1.0, 0.2));
  const glm::dvec3 seen =
      mean(scene_of(fire, glm::vec3(0.0f)), orthographic({0, 0, 0}, towards, 0.1, 8.0), plan(2048, 4));
  const double depth = optical_depth(fire, -8.0 * towards, 8.0 * towards);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(seen[c] / (2.0 * color[c] * (1.0 - std::exp(-depth * fire.absorption[c]))), 1.0, 0.01) << c;
}

// Both integrators find the same light of a lamp and of a sky over a floor under the lump, behind glass too.
TEST_F(VolumeRender, IntegratorsAgree) {
  Volume cloud = sampled_volume({-1, -1, -1}, {1, 1, 1}, 24, lump);
  cloud.scattering = glm::vec3(2.0f, 1.0f, 0.5f);
  cloud.absorption = glm::vec3(0.1f, 0.3f, 0.0f);
  cloud.anisotropy = 0.5f;
  Scene scene = triangle_scene();
  scene.materials[0].base_color = glm::vec4(0.8f, 0.8f, 0.8f, 1.0f);
  scene.meshes[0].positions = {{-9, -1, -9}, {-9, -1, 27}, {27, -1, -9}};
  Material lamp = plain_material();
  lamp.emission = glm::vec3(20.0f);
  scene.materials.push_back(lamp);
  add_instance(scene, add_mesh(scene, {{-0.3f, 1.4f, -0.3f}, {0.5f, 1.4f, -0.3f}, {-0.3f, 1.4f, 0.5f}}, 1));
  Material mirror = plain_material();
  mirror.metallic = 1.0f;
  mirror.roughness = 0.0f;
  mirror.base_color = glm::vec4(1.0f);
  scene.materials.push_back(mirror);
  add_instance(scene, add_mesh(scene, {{-2, -1, 1.5f}, {2, -1, 1.5f}, {0, 2, 1.5f}}, 2));
  scene.volume = cloud;
  scene.environment.radiance = glm::vec3(0.2f);
  View view = orthographic({0.0, -0.4, 0.0}, {0.3, -0.4, 1.0}, 1.4, 6.0);
  RenderPlan asked = plan(1024, 6);
  const glm::dvec3 by_path = mean(scene, view, asked);
  asked.integrator = &kBidirectional;
  const glm::dvec3 by_both = mean(scene, view, asked);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(by_both[c] / by_path[c], 1.0, 0.01) << by_path[c] << ", channel " << c;
  asked.techniques = gpu::kTechniqueConnect | gpu::kTechniqueSplat | gpu::kTechniqueHit;
  const glm::dvec3 without_light_samples = mean(scene, view, asked);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(without_light_samples[c] / by_path[c], 1.0, 0.02) << "channel " << c;
}

// The six faces of a box, outwards.
std::vector<glm::vec3> box_mesh(float half) {
  std::vector<glm::vec3> mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-half, half}) {
      const auto corner = [&](float u, float v) {
        glm::vec3 p;
        p[axis] = side, p[(axis + 1) % 3] = u, p[(axis + 2) % 3] = v;
        return p;
      };
      const glm::vec3 a = corner(-half, -half), b = corner(half, -half), c = corner(half, half),
                      d = corner(-half, half);
      if (side > 0.0f)
        mesh.insert(mesh.end(), {a, b, c, a, c, d});
      else
        mesh.insert(mesh.end(), {a, c, b, a, d, c});
    }
  return mesh;
}

Material clear_body() {
  Material body = plain_material();
  body.base_color = glm::vec4(1.0f);
  body.specular = 1.0f, body.roughness = 0.0f, body.transmission = 1.0f, body.ior = 1.0f;
  body.volume = true;
  body.double_sided = false;
  return body;
}

// A clear body of ior 1 is a hole in the smoke, for rays that pass it.
TEST_F(VolumeRender, BodiesDisplaceTheVolume) {
  Volume smoke = sampled_volume({-1, -1, -1}, {1, 1, 1}, 32, [](const glm::dvec3&) { return 1.0; });
  smoke.scattering = glm::vec3(0.0f), smoke.absorption = glm::vec3(0.3f, 0.8f, 2.0f);
  Scene scene = scene_of(smoke, glm::vec3(1.0f));
  scene.materials.push_back(clear_body());
  add_instance(scene, add_mesh(scene, box_mesh(0.6f), 1));
  const glm::dvec3 towards(0.0, 0.0, 1.0), target(0.1, 0.05, 0.0);
  const View view = orthographic(target, towards, 1e-6, 3.0);
  const double depth = optical_depth(smoke, target - 3.0 * towards, target + 3.0 * towards) -
                       optical_depth(smoke, target - 0.6 * towards, target + 0.6 * towards);
  for (const IntegratorKind* integrator : {&kPath, &kBidirectional}) {
    RenderPlan asked = plan(4096, 8);
    asked.integrator = integrator;
    const glm::dvec3 seen = mean(scene, view, asked);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(seen[c], std::exp(-depth * smoke.absorption[c]), 0.003) << integrator->name << ", channel " << c;
  }
}

// Within a body there is no smoke between a floor and a lamp: neither for light samples and connections, nor by chance.
TEST_F(VolumeRender, BodiesKeepTheVolumeFromTheirLights) {
  Scene clear = triangle_scene();
  clear.materials[0].base_color = glm::vec4(0.8f, 0.8f, 0.8f, 1.0f);
  clear.meshes[0].positions = {{-0.9f, -0.5f, -0.9f}, {-0.9f, -0.5f, 0.9f}, {0.9f, -0.5f, -0.9f}};
  Material lamp = plain_material();
  lamp.emission = glm::vec3(20.0f);
  clear.materials.push_back(lamp);
  add_instance(clear, add_mesh(clear, {{-0.3f, 0.6f, -0.3f}, {0.3f, 0.6f, -0.3f}, {-0.3f, 0.6f, 0.3f}}, 1));
  clear.materials.push_back(clear_body());
  add_instance(clear, add_mesh(clear, box_mesh(1.5f), 2));
  Scene smoky = clear;
  smoky.volume = sampled_volume({-4, -4, -4}, {4, 4, 4}, 16, [](const glm::dvec3&) { return 1.0; });
  smoky.volume->scattering = glm::vec3(0.0f), smoky.volume->absorption = glm::vec3(2.0f);
  const View view = orthographic({-0.3, -0.5, -0.3}, {0.1, -1.0, 0.2}, 0.4, 0.8); // from within
  for (const IntegratorKind* integrator : {&kPath, &kBidirectional}) {
    RenderPlan asked = plan(1024, 3);
    asked.integrator = integrator;
    const glm::dvec3 with = mean(smoky, view, asked), without = mean(clear, view, asked);
    EXPECT_GT(without.y, 0.05);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(with[c] / without[c], 1.0, 0.01) << integrator->name << ", channel " << c;
  }
}

// Large and small coefficients, grids and distances; rays along the planes between cells; a camera within.
TEST_F(VolumeRender, HoldsInStiffCases) {
  const glm::dvec3 albedo(0.5, 0.9, 0.98);
  // A voxel is 1.9 m: 190 free paths.
  Volume deep = sampled_volume({-30, -30, -30}, {30, 30, 30}, 32, [](const glm::dvec3&) { return 1.0; });
  deep.scattering = glm::vec3(100.0 * albedo), deep.absorption = glm::vec3(100.0 * (1.0 - albedo));
  const glm::dvec3 reflected =
      mean(scene_of(deep, glm::vec3(1.0f)), orthographic({0, 30, 0}, {0, -1, 0}, 0.5, 100.0), plan(96, 2000));
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(reflected[c], 1.0 - chandrasekhar_h(1.0, albedo[c]) * std::sqrt(1.0 - albedo[c]), 0.012) << c;

  for (const double size : {1e-3, 1e4}) {
    Volume smoke = sampled_volume({-size, -size, -size}, {size, size, size}, 40,
                                  [&](const glm::dvec3& p) { return lump(p / size); });
    smoke.scattering = glm::vec3(0.0f), smoke.absorption = glm::vec3(glm::dvec3(0.5, 1.5, 4.0) / size);
    const glm::dvec3 along(0.0, 0.0, 1.0), target = glm::dvec3(0.1, -0.2, 0.0) * size; // on planes of voxels
    const glm::dvec3 seen =
        mean(scene_of(smoke, glm::vec3(1.0f)), orthographic(target, along, 1e-7 * size, 3.0 * size), plan(4096, 8));
    const double depth = optical_depth(smoke, target - 3.0 * size * along, target + 3.0 * size * along);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(seen[c], std::exp(-depth * smoke.absorption[c]), 0.003) << "size " << size << ", channel " << c;
  }

  Volume nothing = slab_volume(2.0, 2.0); // far below what a float beside 1 shows
  nothing.scattering = nothing.absorption = glm::vec3(1e-30f);
  Volume wall = slab_volume(2.0, 2.0); // nothing passes
  wall.scattering = glm::vec3(0.0f), wall.absorption = glm::vec3(1e30f);
  const View through = orthographic({0, 0, 0}, {0, -1, 0}, 0.5, 9.0);
  EXPECT_EQ(mean(scene_of(nothing, glm::vec3(1.0f)), through, plan(64, 8)), glm::dvec3(1.0));
  EXPECT_EQ(mean(scene_of(wall, glm::vec3(1.0f)), through, plan(64, 8)), glm::dvec3(0.0));

  Volume cloud = sampled_volume({-1, -1, -1}, {1, 1, 1}, 40, lump);
  cloud.scattering = glm::vec3(3.0f);
  const glm::dvec3 inside =
      mean(scene_of(cloud, glm::vec3(1.0f)), orthographic({0, 0, 0}, {0, 0, 1}, 0.3, 0.1), plan(256, 2000));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(inside[c], 1.0, 0.01);
}

// What glows is a light of its own, and groups of lights add up to the picture.
TEST_F(VolumeRender, FireIsALightGroup) {
  Volume fire = slab_volume(2.0, 4.0);
  VolumeGrids grids = *fire.grids;
  grids.temperature = sampled_grid({-6, -3, -6}, {6, 3, 6}, 10, [](const glm::dvec3&) { return 3000.0; });
  fire.grids = std::make_shared<const VolumeGrids>(std::move(grids));
  fire.scattering = fire.absorption = glm::vec3(0.3f);
  fire.emission = 1.0f;
  Scene scene = scene_of(fire, glm::vec3(0.2f));
  RenderPlan asked = plan(64, 4);
  asked.light_groups = {"volume"};
  asked.group_names = find_group_names(scene, asked.light_groups);
  ASSERT_EQ(asked.group_names, (std::vector<std::string>{"volume", "rest"}));
  const View view = orthographic({0, 0, 0}, {0.1, -1.0, 0.2}, 0.1, 8.0);
  const PackedScene packed = pack(scene, {.eye = view.position, .light_groups = asked.light_groups});
  const Picture picture = render(device(), packed, view, asked, RenderHooks{}, shared_kernels(device())).picture;
  const auto channel = [&](const std::string& name) {
    const auto found = std::ranges::find(picture.channels, name, &Channel::name);
    EXPECT_NE(found, picture.channels.end()) << name;
    return found->values[0];
  };
  EXPECT_GT(channel("group.volume.R"), 0.05f);
  EXPECT_GT(channel("group.rest.R"), 0.02f);
  EXPECT_NEAR(channel("group.volume.R") + channel("group.rest.R"), picture.channels[0].values[0], 1e-4);
}

} // namespace
} // namespace wavepath::test
