// Whitted's ray tracer: it agrees with path tracing where both find the same light, its two ways to branch agree, the
// ambient term and the cutoff do what they say, the estimated error is true, and the bits do not depend on how the work
// is cut up. (Scenes with known answers: analytic_test.cpp.)
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host/film/film.h"
#include "host/integrators/path/kind.h"
#include "host/integrators/whitted/kind.h"
#include "host/render/loop/render_state.h"
#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/coverage.h"
#include "tests/mean_picture.h"
#include "tests/scene_builder.h"
#include "tests/shared_kernels.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

const std::string kScenes = std::string(WAVEPATH_SOURCE_DIR) + "/scenes/";

struct Subject {
  PackedScene packed;
  View view;

  Subject(Scene scene, const RenderPlan& settings)
      : packed(pack(scene)), view(resolve_view(scene, {}, settings.width, settings.height)) {}
};

class WhittedTest : public VulkanTest {
protected:
  static RenderPlan settings(const IntegratorKind* integrator, std::uint32_t spp, std::uint32_t depth) {
    RenderPlan settings;
    settings.width = 24, settings.height = 16;
    settings.last_sample = spp;
    settings.max_depth = depth;
    settings.integrator = integrator;
    settings.cutoff = 0.0;
    return settings;
  }
  RenderResult render(const Subject& subject, const RenderPlan& settings, const RenderHooks& hooks = {}) {
    KernelCompiler& kernels = shared_kernels(device());
    return wavepath::render(device(), subject.packed, subject.view, settings, hooks, kernels);
  }
  MeanPicture average(const Subject& subject, const RenderPlan& settings) {
    return mean_picture(settings, [&](const RenderPlan& seeded) { return render(subject, seeded); });
  }
  static void expect_same(const MeanPicture& a, const MeanPicture& b) { expect_same_mean(a, b, 0.25, 0.03); }
};

TEST_F(WhittedTest, DirectLightIsThatOfPathTracing) {
  const RenderPlan whitted = settings(&kWhitted, 32, 1), path = settings(&kPath, 128, 1);
  const Subject subject(load_gltf(kScenes + "cornell_box.gltf", {}), whitted);
  expect_same(average(subject, whitted), average(subject, path));
}

// Where nothing is smooth there are no rays but the camera's: a surface is lit once, however deep the tree may grow.
TEST_F(WhittedTest, RoughSurfacesAreLitOnce) {
  const RenderPlan shallow = settings(&kWhitted, 4, 1), deep = settings(&kWhitted, 4, 8);
  const Subject subject(load_gltf(kScenes + "cornell_box.gltf", {}), shallow);
  EXPECT_TRUE(*render(subject, shallow).film == *render(subject, deep).film);
}

// Mirrors and glass among rough surfaces: of the light that paths find, a tree of rays finds a part, and most of it
// here.
TEST_F(WhittedTest, NeverBrighterThanPathTracing) {
  const RenderPlan whitted = settings(&kWhitted, 64, 8), path = settings(&kPath, 256, 8);
  const Subject subject(load_gltf(kScenes + "showcase.glb", {}), whitted);
  const MeanPicture a = average(subject, whitted), b = average(subject, path);
  double found = 0.0, all = 0.0, noise = 0.0;
  for (std::size_t i = 0; i < a.mean.size(); ++i) {
    found += a.mean[i], all += b.mean[i];
    noise += a.variance[i] + b.variance[i];
  }
  EXPECT_LT(found, all + 3.0 * std::sqrt(noise));
  EXPECT_GT(found, 0.5 * all);
  EXPECT_LT(std::sqrt(noise), 0.03 * all) << "too much noise to tell";
}

// A sky of one colour, which paths find by the BSDF alone, is light like any other.
TEST_F(WhittedTest, ASkyOfOneColourIsALight) {
  const RenderPlan whitted = settings(&kWhitted, 64, 1), path = settings(&kPath, 64, 1);
  Scene scene = load_gltf(kScenes + "showcase.glb", {});
  for (Material& material : scene.materials) {
    material.roughness = 1.0f;
    material.emission = glm::vec3(0.0f);
    material.transmission = material.metallic = 0.0f;
  }
  scene.environment.radiance = {0.5f, 1.0f, 2.0f};
  const Subject subject(std::move(scene), whitted);
  ASSERT_TRUE(subject.packed.lights.empty());
  expect_same(average(subject, whitted), average(subject, path));
}

// 232 emissive triangles, of which a surface picks 16, and a lamp without an extent, to which it always sends a ray.
TEST_F(WhittedTest, OfManyLightsSomeAreSampled) {
  const RenderPlan whitted = settings(&kWhitted, 16, 1), path = settings(&kPath, 256, 1);
  Scene scene = load_gltf(kScenes + "showcase.glb", {});
  for (Material& material : scene.materials) { // what Whitted's tracer and one bounce both find
    material.roughness = 1.0f;
    material.transmission = material.metallic = 0.0f;
  }
  scene.lights.push_back(
      {.kind = LightKind::point, .intensity = glm::vec3(3.0f), .position = glm::dvec3(0.5, 2.0, 2.0)});
  const Subject subject(std::move(scene), whitted);
  ASSERT_GT(subject.packed.lights.size(), 100u);
  expect_same(average(subject, whitted), average(subject, path));
  const RayCounts rays = render(subject, whitted).rays;
  EXPECT_LE(rays.shadow, 17u * (rays.camera + rays.bounce));
  EXPECT_GT(rays.shadow, rays.camera);
}

// Spheres of glass inside a furnace: whatever they reflect and refract, light of radiance 1 arrives.
TEST_F(WhittedTest, TreeAndChoiceKeepAllLightOfAFurnace) {
  Scene scene = load_gltf(kScenes + "furnace_glass.gltf", {});
  scene.environment.radiance = glm::vec3(1.0f);
  RenderPlan tree = settings(&kWhitted, 16, 12);
  const Subject subject(std::move(scene), tree);
  RenderPlan choice = tree;
  choice.branching = kBranchingChoice;
  choice.last_sample = 64;
  const MeanPicture all = average(subject, tree), one = average(subject, choice);
  double mean_all = 0.0, mean_one = 0.0, noise = 0.0;
  for (std::size_t i = 0; i < all.mean.size(); ++i) {
    EXPECT_LE(all.mean[i], 1.0 + 1e-4 + 6.0 * std::sqrt(all.variance[i])); // rough ones are lit by chance
    mean_all += all.mean[i] / static_cast<double>(all.mean.size());
    mean_one += one.mean[i] / static_cast<double>(all.mean.size());
    noise += one.variance[i] + all.variance[i];
  }
  noise = std::sqrt(noise) / static_cast<double>(all.mean.size());
  EXPECT_GT(mean_all, 0.995) << "what more than 12 bounces would bring";
  EXPECT_NEAR(mean_one, mean_all, 4.0 * noise + 1e-4);
  EXPECT_LT(noise, 0.003);
  EXPECT_GT(render(subject, tree).rays.bounce, render(subject, choice).rays.bounce / 4)
      << "a sample of the tree has more rays";
}

TEST_F(WhittedTest, TheCutoffOnlyLosesLightAndRays) {
  RenderPlan all = settings(&kWhitted, 1, 6), cut = all;
  cut.cutoff = 0.1;
  const Subject subject(load_gltf(kScenes + "showcase.glb", {}), all);
  const RenderResult whole = render(subject, all), less = render(subject, cut);
  EXPECT_LT(less.rays.total(), whole.rays.total());
  double lost = 0.0;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < whole.picture.channels[c].values.size(); ++i) {
      const float a = less.picture.channels[c].values[i], b = whole.picture.channels[c].values[i];
      EXPECT_LE(a, b * 1.00001f + 1e-6f);
      lost += b - a;
    }
  EXPECT_GT(lost, 0.0);
}

// No light but the ambient one: a Lambert surface shows its base colour times that radiance.
TEST_F(WhittedTest, TheAmbientTermIsAlbedoTimesRadiance) {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  scene.materials.back().base_color = {0.25f, 0.5f, 0.75f, 1.0f};
  scene.materials.back().specular = 0.0f;
  add_instance(scene, add_mesh(scene, {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}));
  Camera camera;
  camera.world_from_camera = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 3, 1}};
  scene.cameras.push_back(camera);
  RenderPlan lit = settings(&kWhitted, 2, 3);
  lit.ambient = glm::vec3(2.0f, 1.0f, 4.0f);
  const Picture picture = render(Subject(scene, lit), lit).picture;
  for (std::size_t i = 0; i < picture.channels[0].values.size(); ++i) {
    ASSERT_NEAR(picture.channels[0].values[i], 0.5f, 1e-6f);
    ASSERT_NEAR(picture.channels[1].values[i], 0.5f, 1e-6f);
    ASSERT_NEAR(picture.channels[2].values[i], 3.0f, 1e-6f);
  }
}

// As in error_test.cpp, by fewer seeds, and where all pixels have the same noise.
TEST_F(WhittedTest, TheIntervalHoldsTheTrueError) {
  constexpr std::uint32_t kRuns = 40, kReference = 32;
  RenderPlan coarse = settings(&kWhitted, 8, 1);
  coarse.width = coarse.height = 32;
  coarse.filter = gpu::kFilterBox;
  const Subject subject(load_gltf(kScenes + "analytic/half_hidden_disc_light.gltf", {}), coarse);
  RenderPlan fine = coarse;
  fine.last_sample *= kReference, fine.seed = 1000000;
  const Coverage found = measure_coverage(render(subject, fine).picture, kRuns, [&](std::uint32_t seed) {
    coarse.seed = seed;
    return render(subject, coarse);
  });
  EXPECT_GE(found.covered, 35u);
  EXPECT_NEAR(found.ratio.mean(), 1.0, 0.05) << "its own noise is " << found.ratio.error();
}

// Trees of rays take several slots of a wave, so that a wave ends within a sample.
TEST_F(WhittedTest, PartsJoinToTheWhole) {
  RenderPlan whole = settings(&kWhitted, 7, 4);
  const Subject subject(load_gltf(kScenes + "showcase.glb", {}), whole);
  RenderPlan first = whole, second = whole;
  first.last_sample = second.first_sample = 3;
  first.sample_total = second.sample_total = 7;
  Film joined = *render(subject, second).film;
  join(joined, *render(subject, first).film);
  EXPECT_TRUE(joined == *render(subject, whole).film);
}

// Stopped within the second pass, at whatever place the waves have come to.
TEST_F(WhittedTest, ResumedRendersGiveTheSameBits) {
  RenderPlan whole = settings(&kWhitted, 6, 4);
  whole.wave_slots = 500;
  const Subject subject(load_gltf(kScenes + "showcase.glb", {}), whole);
  std::optional<RenderState> state;
  RenderHooks interrupt;
  interrupt.progress = [](const Progress& now) { return now.spp_done < 3; };
  interrupt.save = [&](const RenderState& saved) { state = saved; };
  interrupt.save_interval = 1e9; // at the end alone
  EXPECT_EQ(render(subject, whole, interrupt).stop, StopReason::interrupted);
  ASSERT_TRUE(state);
  RenderHooks resume;
  resume.resume = &*state;
  EXPECT_TRUE(*render(subject, whole, resume).film == *render(subject, whole).film);
}

TEST_F(WhittedTest, HowTheWorkIsCutUpDoesNotMatter) {
  RenderPlan whole = settings(&kWhitted, 2, 4);
  whole.aovs = {"albedo", "normal", "depth", "direct", "emission"};
  const Subject subject(load_gltf(kScenes + "showcase.glb", {}), whole);
  const RenderResult expected = render(subject, whole);
  for (const std::uint32_t slots : {64u, 700u}) {
    RenderPlan cut = whole;
    cut.wave_slots = slots;
    EXPECT_TRUE(*render(subject, cut).film == *expected.film) << slots << " slots";
  }
  RenderPlan generic = whole;
  generic.specialize = false;
  EXPECT_TRUE(*render(subject, generic).film == *expected.film) << "generic kernels";
}

} // namespace
} // namespace wavepath::test
