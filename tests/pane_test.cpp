// Thin smooth panes: shadow rays pass them by their exact transmittance, paths that go straight through are weighed
// against those, and a pane costs both a bounce.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/integrators/bidirectional/kind.h"
#include "host/integrators/hybrid/kind.h"
#include "host/integrators/path/kind.h"
#include "host/integrators/whitted/kind.h"
#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/features.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/scene_builder.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

constexpr double kTilt = 0.4;

std::vector<glm::vec3> square(float half, float y = 0.0f) {
  const glm::vec3 a{-half, y, -half}, b{half, y, -half}, c{half, y, half}, d{-half, y, half};
  return {a, c, b, a, d, c};
}

Material glass(glm::vec3 tint = glm::vec3(1.0f)) {
  Material pane = plain_material();
  pane.base_color = glm::vec4(tint, 1.0f);
  pane.specular = 1.0f;
  pane.roughness = 0.0f;
  pane.transmission = 1.0f;
  return pane;
}

// Unpolarized reflectance of an interface to ior 1.5 (Fresnel).
double reflectance(double cosine) {
  const double n = 1.5, t = std::sqrt(1.0 - (1.0 - cosine * cosine) / (n * n));
  const double s = (cosine - n * t) / (cosine + n * t), p = (t - n * cosine) / (t + n * cosine);
  return 0.5 * (s * s + p * p);
}

// Of a tilted pane of white glass, met from straight below.
const double kPassed = 1.0 - reflectance(std::cos(kTilt));

void add_pane(Scene& scene, const Material& material, float half = 3.0f) {
  scene.materials.push_back(material);
  const double height = 2.5 + 0.5 * static_cast<double>(scene.instances.size());
  const glm::dmat4 turn =
      glm::rotate(glm::translate(glm::dmat4(1.0), glm::dvec3(0, height, 0)), kTilt, glm::dvec3(1, 0, 1));
  add_instance(scene, add_mesh(scene, square(half), static_cast<std::uint32_t>(scene.materials.size() - 1)), turn);
}

void add_sun(Scene& scene) { // of pi lux: a white floor under it has radiance 1
  PunctualLight sun;
  sun.kind = LightKind::directional;
  sun.direction = {0, -1, 0};
  sun.intensity = glm::vec3(3.14159265f);
  scene.lights = {sun};
}

// A white floor below tilted panes, the camera between them.
Scene floor_under(const std::vector<Material>& panes) {
  Scene scene;
  scene.path = "test";
  scene.materials = {plain_material()};
  scene.materials[0].base_color = glm::vec4(1.0f);
  add_instance(scene, add_mesh(scene, square(1.0f)));
  for (const Material& pane : panes) add_pane(scene, pane);
  return scene;
}

Scene sunny_floor(const std::vector<Material>& panes) {
  Scene scene = floor_under(panes);
  add_sun(scene);
  return scene;
}

// Shining squares above the panes: one, or so many that they are chosen by a light tree.
void add_lamps(Scene& scene, int count) {
  Material shining = plain_material();
  shining.emission = glm::vec3(4.0f, 3.0f, 2.0f);
  shining.base_color = glm::vec4(glm::vec3(0.0f), 1.0f);
  scene.materials.push_back(shining);
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 place(1.1 * (i % 3) - 0.9, 6.0 + 0.3 * i, 1.1 * (i / 3) - 0.7);
    add_instance(scene, add_mesh(scene, square(0.5f), static_cast<std::uint32_t>(scene.materials.size() - 1)),
                 glm::translate(glm::dmat4(1.0), place));
  }
}

// A sky of two colours with a bright spot above.
void add_sky(Scene& scene) {
  Environment& sky = scene.environment;
  sky.radiance = glm::vec3(1.0f);
  sky.width = 32, sky.height = 16;
  sky.map.assign(32 * 16, glm::vec3(0.2f, 0.3f, 0.5f));
  for (std::size_t x = 4; x < 9; ++x)
    for (std::size_t y = 2; y < 5; ++y) sky.map[y * 32 + x] = glm::vec3(20.0f);
}

class PaneTest : public VulkanTest {
protected:
  // Compiles each of them once, and waits for what is being compiled before the driver's own statics go.
  static inline std::unique_ptr<KernelCompiler> kernels_;
  static void TearDownTestSuite() { kernels_.reset(); }

  RenderPlan settings(std::uint32_t spp, std::uint32_t depth, const IntegratorKind& integrator = kPath) {
    RenderPlan asked;
    asked.width = 8, asked.height = 8;
    asked.last_sample = spp;
    asked.max_depth = depth;
    asked.integrator = &integrator;
    asked.filter = gpu::kFilterBox;
    return asked;
  }
  Picture render(Scene scene, const RenderPlan& asked, bvh::Quality quality = bvh::Quality::fast,
                 bool upwards = false) {
    if (!kernels_) kernels_ = std::make_unique<KernelCompiler>(device());
    ViewRequest request;
    request.eye = glm::dvec3(0, 1, 0.001);
    request.look_at = upwards ? glm::dvec3(0, 2, 0) : glm::dvec3(0, 0, 0);
    request.yfov = upwards ? 0.05 : 0.7;
    const View view = resolve_view(scene, request, asked.width, asked.height);
    const PackedScene packed =
        pack(scene, {.direct = asked.direct, .quality = quality, .eye = view.position, .lights = asked.lights});
    return wavepath::render(device(), packed, view, asked, RenderHooks{}, *kernels_).picture;
  }
  void expect_even(const Picture& picture, const glm::dvec3& value, double tolerance) {
    for (int c = 0; c < 3; ++c)
      for (const float v : picture.channels[static_cast<std::size_t>(c)].values) ASSERT_NEAR(v, value[c], tolerance);
  }

  // Means of pictures by several estimators agree within 4.5 standard errors, which are below 3 %.
  void expect_agreement(const Scene& scene, std::uint32_t depth,
                        const std::vector<std::function<void(RenderPlan&)>>& variants, bool upwards = false) {
    constexpr int kRenders = 8;
    double first_mean = 0.0, first_variance = 0.0;
    for (std::size_t v = 0; v < variants.size(); ++v) {
      double sum = 0.0, squares = 0.0;
      for (int i = 0; i < kRenders; ++i) {
        RenderPlan asked = settings(256, depth);
        variants[v](asked);
        asked.seed = static_cast<std::uint32_t>(100 * v) + static_cast<std::uint32_t>(i);
        double mean = 0.0;
        const Picture picture = render(scene, asked, bvh::Quality::fast, upwards);
        for (std::size_t c = 0; c < 3; ++c)
          for (const float value : picture.channels[c].values) mean += value / 192.0;
        sum += mean / kRenders, squares += mean * mean / kRenders;
      }
      const double variance = std::max(squares - sum * sum, 0.0) / (kRenders - 1);
      ASSERT_GT(sum, 0.0);
      EXPECT_LT(std::sqrt(variance), 0.03 * sum) << "variant " << v;
      if (v == 0)
        first_mean = sum, first_variance = variance;
      else
        EXPECT_NEAR(sum, first_mean, 4.5 * std::sqrt(variance + first_variance)) << "variant " << v;
    }
  }
};

const auto kMis = [](RenderPlan&) {};
const auto kNee = [](RenderPlan& s) { s.direct = gpu::kDirectNee; };
const auto kBsdf = [](RenderPlan& s) { s.direct = gpu::kDirectBsdf; };
const auto kBothEnds = [](RenderPlan& s) { s.integrator = &kBidirectional; };
const auto kByTree = [](RenderPlan& s) { s.lights = gpu::kLightsTree; };
const auto kLearned = [](RenderPlan& s) { s.lights = gpu::kLightsLearned; };
const auto kGuided = [](RenderPlan& s) { s.guide = true; };

TEST_F(PaneTest, ASunShinesThroughByFresnelAndTint) {
  const glm::vec3 red(0.9f, 0.4f, 0.0f), blue(0.3f, 0.5f, 0.8f);
  for (const IntegratorKind* kind : {&kPath, &kWhitted}) {
    expect_even(render(sunny_floor({glass()}), settings(2, 2, *kind)), glm::dvec3(kPassed), 2e-6);
    expect_even(render(sunny_floor({glass(red)}), settings(2, 2, *kind)), kPassed * glm::dvec3(red), 2e-6);
    expect_even(render(sunny_floor({glass(red), glass(blue), glass()}), settings(2, 4, *kind)),
                std::pow(kPassed, 3.0) * glm::dvec3(red) * glm::dvec3(blue), 3e-6);
  }
  Material partial = glass(blue);
  partial.transmission = 0.75f, partial.metallic = 0.2f;
  expect_even(render(sunny_floor({partial}), settings(2, 2)), 0.6 * kPassed * glm::dvec3(blue), 2e-6);
}

// A pane is a bounce, for paths as for shadow rays.
TEST_F(PaneTest, EveryPaneCostsABounce) {
  const std::vector<Material> panes(3, glass());
  for (const std::uint32_t depth : {1u, 2u, 3u}) {
    expect_even(render(sunny_floor(panes), settings(2, depth)), glm::dvec3(0.0), 0.0);
    expect_even(render(sunny_floor(panes), settings(2, depth, kWhitted)), glm::dvec3(0.0), 0.0);
  }
  RenderPlan one_bounce = settings(2, 2, kHybrid); // of what lights bring
  one_bounce.ambient = glm::vec3(0.0f);
  expect_even(render(sunny_floor({glass()}), one_bounce), glm::dvec3(0.0), 0.0);
}

// Rough glass as well: PaneFeature.
TEST_F(PaneTest, ThickGlassStopsShadowRays) {
  Material thick = glass();
  thick.volume = true;
  expect_even(render(sunny_floor({thick}), settings(2, 2)), glm::dvec3(0.0), 0.0);
  Material barely = glass();
  barely.roughness = 0.009f;
  expect_even(render(sunny_floor({barely}), settings(2, 2)), glm::dvec3(kPassed), 2e-6);
}

// Through the holes of a BLEND pane light arrives with a bounce less.
TEST_F(PaneTest, BlendAndTransmissionCombine) {
  Material half = glass(glm::vec3(0.5f));
  half.alpha_mode = AlphaMode::blend;
  half.base_color.a = 0.5f;
  const auto mean = [&](std::uint32_t depth) {
    double sum = 0.0;
    const Picture picture = render(sunny_floor({half}), settings(1024, depth));
    for (const float v : picture.channels[0].values) sum += v / 64.0;
    return sum;
  };
  const double error = 0.5 / std::sqrt(1024.0 * 64.0); // of a random choice
  EXPECT_NEAR(mean(1), 0.5, 4.0 * error);
  EXPECT_NEAR(mean(2), 0.5 + 0.25 * kPassed, 4.0 * error * (1.0 - 0.5 * kPassed));
}

TEST_F(PaneTest, AMaskCutsHolesIntoPanes) {
  Material cut = glass(glm::vec3(0.5f));
  cut.alpha_mode = AlphaMode::mask;
  cut.base_color.a = 0.4f;
  expect_even(render(sunny_floor({cut}), settings(2, 2)), glm::dvec3(1.0), 2e-6);
}

TEST_F(PaneTest, NeitherTreeNorWavesNorGenericKernelsChangeABit) {
  Material blend = plain_material();
  blend.alpha_mode = AlphaMode::blend;
  blend.base_color = glm::vec4(0.0f, 0.0f, 0.0f, 0.3f);
  Scene scene = floor_under({glass(glm::vec3(0.9f, 0.8f, 0.5f)), blend, glass(glm::vec3(0.7f, 0.8f, 0.9f)), blend});
  add_lamps(scene, 12);
  add_sky(scene);
  add_sun(scene);
  for (int i = 0; i < 64; ++i) { // small things among the panes make splits pay
    const glm::dmat4 place =
        glm::translate(glm::dmat4(1.0), glm::dvec3(-2.8 + 0.35 * (i % 16), 2.5 + 0.8 * (i / 16), 2.9));
    add_instance(scene, add_mesh(scene, square(0.02f), 0), place);
  }
  const RenderPlan asked = settings(4, 6);
  const Picture expected = render(scene, asked);
  const auto expect_same = [&](const Picture& other, const std::string& what) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(expected.channels[c].values, other.channels[c].values) << what;
  };
  expect_same(render(scene, asked, bvh::Quality::balanced), "balanced tree");
  expect_same(render(scene, asked, bvh::Quality::best), "best tree");
  RenderPlan other = asked;
  other.wave_slots = 50;
  expect_same(render(scene, other), "small waves");
  other = asked;
  other.specialize = false;
  expect_same(render(scene, other), "generic kernels");
}

TEST_F(PaneTest, EstimatorsAgreeUnderALamp) {
  for (const std::uint32_t depth : {2u, 6u}) {
    Scene scene = floor_under({glass(glm::vec3(0.9f, 0.7f, 0.5f)), glass()});
    if (depth == 2) scene = floor_under({glass()});
    add_lamps(scene, 1);
    expect_agreement(scene, depth, {kMis, kNee, kBsdf, kBothEnds, kGuided});
  }
}

TEST_F(PaneTest, EstimatorsAgreeUnderManyLamps) {
  Scene scene = floor_under({glass(glm::vec3(0.9f, 0.7f, 0.5f)), glass()});
  add_lamps(scene, 12);
  expect_agreement(scene, 5, {kMis, kNee, kBsdf, kByTree, kLearned, [](RenderPlan& s) {
                                kNee(s);
                                kByTree(s);
                              }});
}

// A pane that is part diffuse receives light itself; what passes it belongs to the vertex before it all the same.
TEST_F(PaneTest, EstimatorsAgreeBehindMilkyGlass) {
  Material milky = glass(glm::vec3(0.9f));
  milky.transmission = 0.6f;
  Scene scene = floor_under({milky, glass()});
  add_lamps(scene, 12);
  expect_agreement(scene, 5, {kMis, kNee, kBsdf, kByTree, kLearned, kBothEnds});
}

TEST_F(PaneTest, EstimatorsAgreeUnderTheSky) {
  Scene scene = floor_under({glass(glm::vec3(0.9f, 0.7f, 0.5f)), glass()});
  add_sky(scene);
  expect_agreement(scene, 4, {kMis, kNee, kBsdf, kBothEnds});
}

// The camera looks through a pane at a lamp: nothing but that path finds it.
TEST_F(PaneTest, TheEyeSeesALampThroughAPane) {
  Material clear = glass(glm::vec3(0.5f));
  clear.ior = 1.0f; // reflects nothing, so that the picture has no noise
  Scene scene = floor_under({clear, clear});
  add_lamps(scene, 1);
  scene.instances.back().world_from_object = glm::translate(glm::dmat4(1.0), glm::dvec3(0, 6, 0));
  for (const auto& direct : {gpu::kDirectMis, gpu::kDirectNee, gpu::kDirectBsdf}) {
    RenderPlan asked = settings(4, 2);
    asked.direct = direct;
    expect_even(render(scene, asked, bvh::Quality::fast, true), glm::dvec3(1.0, 0.75, 0.5), 1e-5);
  }
}

// In the channel of direct light there is what one bounce finds, whichever way.
TEST_F(PaneTest, LightThroughAPaneIsNotDirect) {
  RenderPlan asked = settings(2, 2);
  asked.aovs = {"direct", "indirect"};
  const Picture picture = render(sunny_floor({glass()}), asked);
  for (const Channel& channel : picture.channels) {
    const bool direct = channel.name.starts_with("direct"), indirect = channel.name.starts_with("indirect");
    if (!direct && !indirect) continue;
    for (const float v : channel.values) ASSERT_NEAR(v, indirect ? kPassed : 0.0, 2e-6) << channel.name;
  }
}

TEST(PaneFeature, IsThereOnlyWhereShadowRaysMeetPanes) {
  const auto has_panes = [](Scene scene, std::uint32_t direct = gpu::kDirectMis) {
    const bool expected = (expected_features(scene, direct) & gpu::kFeaturePanes) != 0;
    const PackedScene packed = pack(scene, {.direct = direct});
    const bool found = (packed.features & gpu::kFeaturePanes) != 0;
    EXPECT_TRUE(expected || !found);
    const bool listed =
        std::ranges::any_of(packed.left_out, [](const LeftOut& e) { return e.feature == gpu::kFeaturePanes; });
    EXPECT_NE(found, listed);
    return found;
  };
  EXPECT_TRUE(has_panes(sunny_floor({glass()})));
  EXPECT_FALSE(has_panes(sunny_floor({})));
  EXPECT_FALSE(has_panes(floor_under({glass()})));
  EXPECT_FALSE(has_panes(sunny_floor({glass()}), gpu::kDirectBsdf));
  Material rough = glass(), thick = glass(), metal = glass(), opaque = glass();
  rough.roughness = 0.011f;
  thick.volume = true;
  metal.metallic = 1.0f;
  opaque.transmission = 0.0f;
  for (const Material& material : {rough, thick, metal, opaque}) EXPECT_FALSE(has_panes(sunny_floor({material})));

  RenderPlan asked;
  asked.integrator = &kPath;
  const auto compiled = [&] {
    return (kernel_config(gpu::kFeaturePanes, 5, asked).features & gpu::kFeaturePanes) != 0;
  };
  EXPECT_TRUE(compiled());
  asked.max_depth = 1; // no bounce is left for a pane
  EXPECT_FALSE(compiled());
  asked.max_depth = 8;
  for (const IntegratorKind* kind : {&kHybrid, &kBidirectional}) {
    asked.integrator = kind;
    EXPECT_FALSE(compiled());
  }
}

} // namespace
} // namespace wavepath::test
