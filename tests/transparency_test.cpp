// Techniques of transparency: where each is exact, and what each gets wrong.
#include "tests/shadow_scene.h"

#include <numbers>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/base/error.h"
#include "host/integrators/hybrid/transparency/catalogue.h"
#include "host/integrators/path/kind.h"

namespace wavepath::test {
namespace {

constexpr float kBackground = 0.2f;

RenderPlan settings_for(std::string_view technique) {
  RenderPlan settings = shadow_settings("traced", 1024);
  settings.width = 64, settings.height = 48;
  settings.transparency = index_of(kTransparencyTechniques.names(), technique);
  return settings;
}

// Shows its colour whatever the light, so that what is seen is known.
Material plain_colour(float colour, float alpha) {
  Material material = plain_material();
  material.unlit = true;
  material.base_color = {colour, colour, colour, alpha};
  if (alpha < 1.0f) material.alpha_mode = AlphaMode::blend;
  return material;
}

struct Layer {
  float height, colour, alpha;
};

// A floor, and layers above it in the order in which they are listed, seen from above; each a placed instance of one
// mesh.
Scene stack(const std::vector<Layer>& layers) {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_colour(kBackground, 1.0f));
  const std::vector<glm::vec3> quad = rectangle({0, 0, 0}, {0, 0, 2}, {2, 0, 0});
  add_instance(scene, add_mesh(scene, quad));
  for (const Layer& layer : layers) {
    scene.materials.push_back(plain_colour(layer.colour, layer.alpha));
    const std::uint32_t mesh = add_mesh(scene, quad, static_cast<std::uint32_t>(scene.materials.size() - 1));
    add_instance(scene, mesh, glm::translate(glm::dmat4(1.0), {0.0, layer.height, 0.0}));
  }
  scene.cameras.push_back(camera_above({0, 0, 0}, 0.9));
  return scene;
}

float over(const Layer& layer, float behind) { return layer.alpha * layer.colour + (1.0f - layer.alpha) * behind; }

class TransparencyTest : public ShadowTest {
protected:
  void expect_everywhere(const Scene& scene, std::string_view technique, float expected) {
    SCOPED_TRACE(technique);
    for (const float value : light(scene, settings_for(technique))) ASSERT_NEAR(value, expected, 2e-6f);
  }
};

TEST_F(TransparencyTest, OneLayerIsBlendedExactly) {
  const Layer layer{1.0f, 0.9f, 0.3f};
  for (const std::string_view technique : {"sorted", "peel", "weighted"})
    expect_everywhere(stack({layer}), technique, over(layer, kBackground));
}

TEST_F(TransparencyTest, LayersAreBlendedFromBackToFrontHoweverTheyAreListed) {
  const Layer low{0.5f, 0.9f, 0.3f}, high{1.0f, 0.1f, 0.6f};
  const float expected = over(high, over(low, kBackground));
  for (const std::string_view technique : {"sorted", "peel"}) {
    expect_everywhere(stack({low, high}), technique, expected);
    expect_everywhere(stack({high, low}), technique, expected);
  }
}

TEST_F(TransparencyTest, WeightsKnowTransmittanceButNotOrder) {
  const Layer low{0.5f, 0.9f, 0.3f}, high{1.0f, 0.1f, 0.6f};
  const float exact = over(high, over(low, kBackground));
  const std::vector<float> a = light(stack({low, high}), settings_for("weighted")),
                           b = light(stack({high, low}), settings_for("weighted"));
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_NEAR(a[i], b[i], 1e-6f);           // it needs no order
    ASSERT_GT(std::abs(a[i] - exact), 0.03f); // and does not find it
  }
  // Layers of one colour: only the background's fraction counts, which is exact.
  const Layer same_low{0.5f, 0.9f, 0.3f}, same_high{1.0f, 0.9f, 0.6f};
  expect_everywhere(stack({same_low, same_high}), "weighted", over(same_high, over(same_low, kBackground)));
}

TEST_F(TransparencyTest, PeelingReachesAsFarAsItsLayers) {
  const Layer a{0.2f, 0.9f, 0.5f}, b{0.6f, 0.1f, 0.5f}, c{1.0f, 0.6f, 0.5f};
  const Scene scene = stack({b, c, a});
  RenderPlan settings = settings_for("peel");
  const float expected[] = {over(c, kBackground), over(c, over(b, kBackground)), over(c, over(b, over(a, kBackground))),
                            over(c, over(b, over(a, kBackground)))};
  for (std::uint32_t layers = 1; layers <= 4; ++layers) {
    settings.transparency_layers = layers;
    for (const float value : light(scene, settings)) ASSERT_NEAR(value, expected[layers - 1], 2e-6f) << layers;
  }
}

TEST_F(TransparencyTest, OpaqueSurfacesHideLayers) {
  for (const std::string_view technique : {"sorted", "peel", "weighted", "screendoor"})
    expect_everywhere(stack({{-0.5f, 0.9f, 0.5f}}), technique, kBackground);
}

// Two sheets that cross in the middle of the picture: on each side another one is in front.
Scene crossing_sheets() {
  Scene scene = bodies();
  scene.meshes.clear();
  scene.instances.clear();
  scene.materials = {plain_colour(kBackground, 1.0f), plain_colour(0.9f, 0.5f), plain_colour(0.05f, 0.7f)};
  add_instance(scene, add_mesh(scene, rectangle({0, -1, 0}, {0, 0, 6}, {6, 0, 0})));
  add_instance(scene, add_mesh(scene, rectangle({0, 0.5f, 0}, {0, 0, 1}, {1, 0.5f, 0}), 1));
  add_instance(scene, add_mesh(scene, rectangle({0, 0.5f, 0}, {0, 0, 1}, {1, -0.5f, 0}), 2));
  return scene;
}

// Mean of the differences in one half of the picture, in standard deviations of it; pixels of `noisy` are independent.
double deviation(const std::vector<float>& exact, const std::vector<float>& noisy, std::uint32_t width, bool right) {
  double sum = 0.0, squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const double difference = noisy[i] - exact[i];
    if ((i % width >= width / 2) != right || difference == 0.0) continue;
    sum += difference, squares += difference * difference, ++count;
  }
  EXPECT_GT(count, 300.0);
  return std::abs(sum) / std::sqrt(squares);
}

TEST_F(TransparencyTest, PeelingIsTheMeanOfPassingThroughAtRandom) {
  const Scene scene = crossing_sheets();
  RenderPlan traced = settings_for("traced"), peel = settings_for("peel");
  traced.last_sample = peel.last_sample = 24; // the same places in the pixels
  const std::vector<float> truth = light(scene, traced), peeled = light(scene, peel);
  for (const bool right : {false, true}) EXPECT_LT(deviation(peeled, truth, traced.width, right), 4.0);
}

TEST_F(TransparencyTest, NoOrderOfTrianglesIsRightWhereTheyCross) {
  Scene scene = crossing_sheets();
  scene.cameras[0] = camera_above({0, 0, 0}, 0.9);
  const std::vector<float> peeled = light(scene, settings_for("peel")), sorted = light(scene, settings_for("sorted"));
  std::size_t wrong = 0; // half of the place where a triangle's middle is behind the other's
  for (std::size_t i = 0; i < peeled.size(); ++i) wrong += std::abs(sorted[i] - peeled[i]) > 0.1f;
  EXPECT_GT(wrong, peeled.size() / 6);
  EXPECT_LT(wrong, peeled.size() / 2);
}

TEST_F(TransparencyTest, ScreenDoorsLeaveTheirFractionOpen) {
  for (const int open : {0, 16, 40, 63}) {
    const Layer layer{1.0f, 0.9f, static_cast<float>(open) / 64.0f};
    const std::vector<float> picture = light(stack({layer}), settings_for("screendoor"));
    const auto shown = std::ranges::count_if(picture, [](float value) { return std::abs(value - 0.9f) < 1e-6f; });
    const auto floor = std::ranges::count_if(picture, [](float v) { return std::abs(v - kBackground) < 1e-6f; });
    EXPECT_EQ(shown * 64, static_cast<std::ptrdiff_t>(picture.size()) * open);
    EXPECT_EQ(shown + floor, static_cast<std::ptrdiff_t>(picture.size()));
  }
}

TEST_F(TransparencyTest, ScreenDoorsOfOneOpacityHideEachOther) {
  const Layer low{0.5f, 0.9f, 0.5f}, high{1.0f, 0.6f, 0.5f};
  for (const float value : light(stack({low, high}), settings_for("screendoor")))
    ASSERT_TRUE(std::abs(value - 0.6f) < 1e-6f || std::abs(value - kBackground) < 1e-6f) << value;
}

// A sample shows a layer or what is behind it; samples of a layer are a fraction of all that is off by less than one of
// them.
TEST_F(TransparencyTest, StochasticSamplesAreStratified) {
  const Layer layer{1.0f, 1.0f, 0.3f};
  RenderPlan settings = settings_for("stochastic");
  settings.transparency_samples = 8; // of which 2 or 3 are covered
  const float two = over({0, 1.0f, 2.0f / 8}, kBackground), three = over({0, 1.0f, 3.0f / 8}, kBackground);
  double mean = 0.0;
  std::size_t fewer = 0;
  const std::vector<float> picture = light(stack({layer}), settings);
  for (const float value : picture) {
    ASSERT_TRUE(std::abs(value - two) < 2e-6f || std::abs(value - three) < 2e-6f) << value;
    mean += value / static_cast<double>(picture.size());
    fewer += value < 0.5f * (two + three);
  }
  EXPECT_GT(fewer, picture.size() / 2); // 0.3 * 8 = 2.4
  // Covered samples are 2.4 on average, with a deviation of sqrt(0.24) for a pixel.
  const double deviation = (three - two) * std::sqrt(0.24 / static_cast<double>(picture.size()));
  EXPECT_NEAR(mean, over(layer, kBackground), 4.0 * deviation);
}

// Masks of two layers are independent of each other, so that their mean is exact; of one pixel it is noise.
TEST_F(TransparencyTest, StochasticTransparencyConvergesToPeeling) {
  const Layer low{0.5f, 0.9f, 0.3f}, high{1.0f, 0.1f, 0.6f};
  RenderPlan settings = settings_for("stochastic");
  settings.last_sample = 8;
  const std::vector<float> picture = light(stack({low, high}), settings);
  const double exact = over(high, over(low, kBackground)), count = static_cast<double>(picture.size());
  double sum = 0.0, squares = 0.0;
  for (const float value : picture) sum += value - exact, squares += (value - exact) * (value - exact);
  EXPECT_GT(std::sqrt(squares / count), 0.005);
  EXPECT_LT(std::abs(sum) / std::sqrt(squares), 4.0);
}

// By Lambert's law at the layer itself; the floor is black, so that all light is the layer's.
TEST_F(TransparencyTest, LayersAreLit) {
  constexpr double kHeight = 0.5, kIntensity = 20.0, kAlpha = 0.4, kColour = 0.5;
  constexpr glm::dvec3 kLamp(0.3, 1.5, -0.2);
  Scene scene = stack({{static_cast<float>(kHeight), kColour, kAlpha}});
  scene.materials[0].base_color = {0, 0, 0, 1};
  scene.materials[1].unlit = false;
  scene.lights.push_back(lamp(kLamp));
  for (const std::string_view technique : {"sorted", "peel", "weighted"}) {
    SCOPED_TRACE(technique);
    RenderPlan settings = settings_for(technique);
    settings.aovs = {"position"};
    const Picture picture = render(scene, settings).picture;
    const auto &x = channel(picture, "P.X"), &z = channel(picture, "P.Z"), &green = channel(picture, "G");
    for (std::size_t i = 0; i < green.size(); ++i) {
      const glm::dvec3 offset = kLamp - glm::dvec3(x[i], kHeight, z[i]);
      const double d2 = glm::dot(offset, offset), cosine = offset.y / std::sqrt(d2);
      ASSERT_NEAR(green[i] / (kAlpha * kColour / std::numbers::pi * kIntensity * cosine / d2), 1.0, 1e-4);
    }
  }
}

// Nothing of it is there for scenes without BLEND surfaces.
TEST_F(TransparencyTest, OpaqueScenesAreUntouched) {
  const Scene scene = lit_by(sun());
  const std::vector<float> traced = light(scene, settings_for("traced"));
  for (const std::string_view technique : {"sorted", "peel", "weighted", "screendoor", "refractive"})
    EXPECT_EQ(light(scene, settings_for(technique)), traced) << technique;
}

Material glass(float ior, float colour = 1.0f) {
  Material material = plain_material();
  material.base_color = {colour, colour, colour, 1.0f};
  material.metallic = material.roughness = 0.0f;
  material.transmission = 1.0f;
  material.ior = ior;
  return material;
}

// What bends and reflects nothing.
TEST_F(TransparencyTest, PanesOfAirColourTheOpaquePicture) {
  Scene scene = stack({{1.0f, 0.0f, 1.0f}});
  scene.materials[1] = glass(1.0f, 0.6f);
  expect_everywhere(scene, "refractive", 0.6f * kBackground);
}

// Emission is what is seen of the opaque picture's, whose whole light is kept for glass in the same place.
TEST_F(TransparencyTest, ChannelsOfRefractionAreThoseOfTheOpaquePicture) {
  Scene scene = stack({{1.0f, 0.0f, 1.0f}});
  scene.materials[0] = plain_material();
  scene.materials[1] = glass(1.0f);
  scene.lights.push_back(lamp({0.0, 0.5, 0.0}));
  RenderPlan settings = settings_for("refractive");
  settings.aovs = {"emission", "direct"};
  const Picture picture = render(scene, settings).picture;
  for (const float emission : channel(picture, "emission.G")) ASSERT_EQ(emission, 0.0f);
  EXPECT_GT(std::ranges::max(channel(picture, "direct.G")), 0.0f);
}

// Their light is in no opaque picture, which paths know better.
TEST_F(TransparencyTest, RefractionShowsTheNearestGlassAlone) {
  Scene scene = stack({{0.5f, 0.0f, 1.0f}, {1.0f, 0.0f, 1.0f}});
  scene.materials[1] = glass(1.0f, 0.25f);
  scene.materials[2] = glass(1.0f, 0.6f);
  expect_everywhere(scene, "refractive", 0.6f * kBackground);
  RenderPlan paths = settings_for("traced");
  paths.integrator = &kPath;
  paths.max_depth = 4;
  for (const float value : light(scene, paths)) ASSERT_NEAR(value, 0.6f * 0.25f * kBackground, 2e-6f);
}

// A surface without a bottom: light is absorbed as far as the ray goes to the floor.
TEST_F(TransparencyTest, WaterAbsorbsDownToTheFloor) {
  constexpr float kDepth = 0.7f, kAbsorption = 0.5f; // metres, 1/m
  Scene scene = stack({{kDepth, 0.0f, 1.0f}});
  scene.materials[1] = glass(1.0f);
  scene.materials[1].volume = true;
  scene.materials[1].attenuation = glm::vec3(kAbsorption);
  expect_everywhere(scene, "refractive", kBackground * std::exp(-kAbsorption * kDepth));
}

// Through a slab of glass the edge between two colours is where paths see it, and not where it would be without.
TEST_F(TransparencyTest, SlabsShiftWhatLiesBeneath) {
  Scene scene = bodies();
  scene.meshes.clear();
  scene.instances.clear();
  scene.materials = {plain_colour(0.2f, 1.0f), plain_colour(0.8f, 1.0f), glass(1.5f)};
  scene.materials[2].volume = true;
  add_instance(scene, add_mesh(scene, rectangle({0, 0, -10}, {0, 0, 10}, {20, 0, 0})));
  add_instance(scene, add_mesh(scene, rectangle({0, 0, 10}, {0, 0, 10}, {20, 0, 0}), 1));
  add_instance(scene, add_mesh(scene, box({0, 0.6, 0}, {20, 0.4, 20}), 2));
  RenderPlan settings = settings_for("refractive"), paths = settings;
  paths.transparency = index_of(kTransparencyTechniques.names(), "traced");
  paths.integrator = &kPath;
  paths.max_depth = 3;
  settings.width = paths.width = 96, settings.height = paths.height = 72;
  settings.last_sample = paths.last_sample = 32;
  // Rows above the edge, on average over columns.
  const auto edge = [](const std::vector<float>& picture) {
    double rows = 0.0;
    for (std::size_t i = 0; i < 96; ++i) {
      std::size_t row = 0;
      while (row < 71 && picture[row * 96 + i] < 0.5f) ++row;
      rows += static_cast<double>(row) / 96;
    }
    return rows;
  };
  Scene bare = scene;
  bare.instances.pop_back();
  const std::vector<float> truth = light(scene, paths), seen = light(scene, settings);
  EXPECT_NEAR(edge(seen), edge(truth), 0.5);
  EXPECT_GT(edge(light(bare, settings)), edge(truth) + 3.0);
  EXPECT_NEAR(truth.back(), 0.8f, 1e-4f);
  EXPECT_EQ(seen.back(), 0.0f); // bent to where the picture ends, and nothing is known
}

TEST(TransparencySettings, RefusesWhatATechniqueDoesNotTake) {
  const auto refusal = [](const RenderPlan& settings) {
    try {
      settings.integrator->check(settings);
    } catch (const UsageError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  RenderPlan settings = settings_for("sorted");
  EXPECT_EQ(refusal(settings), "");
  settings.transparency_layers = 2;
  EXPECT_NE(refusal(settings).find("--transparency-layers"), std::string::npos);
  settings = settings_for("peel");
  settings.transparency_layers = 2;
  EXPECT_EQ(refusal(settings), "");
  settings.direct = gpu::kDirectBsdf;
  EXPECT_NE(refusal(settings).find("--direct bsdf"), std::string::npos);
}

} // namespace
} // namespace wavepath::test
