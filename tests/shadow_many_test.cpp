// Shadow techniques under many lights: maps of the default size always fit the device, and it is told where they are
// smaller.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "host/integrators/hybrid/kind.h"
#include "tests/shadow_scene.h"

namespace wavepath::test {
namespace {

enum class Many { spots, points, suns, squares };

Scene lit_by_many(Many kind, int count) {
  Scene scene = bodies();
  if (kind == Many::squares) {
    Material emitter = plain_material();
    emitter.base_color = {0, 0, 0, 1};
    emitter.emission = glm::vec3(30.0f);
    emitter.double_sided = false;
    scene.materials.push_back(emitter);
  }
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * 3.14159265 * i / count;
    const glm::dvec3 at(1.5 * std::cos(angle), 2.5, 1.5 * std::sin(angle));
    if (kind == Many::spots) scene.lights.push_back(spot(at));
    if (kind == Many::points) scene.lights.push_back(lamp(at));
    if (kind == Many::suns) scene.lights.push_back(sun({std::cos(angle), -1.5, std::sin(angle)}));
    if (kind == Many::squares)
      add_instance(scene, add_mesh(scene, rectangle(glm::vec3(at), {0.2f, 0, 0}, {0, 0, 0.2f}), 1));
  }
  for (PunctualLight& light : scene.lights) light.intensity /= static_cast<float>(count);
  return scene;
}

struct Technique {
  std::string_view name;
  Many lights;
};

RenderPlan small(std::string_view technique) {
  RenderPlan settings = shadow_settings(technique, RenderPlan{}.shadow_size);
  settings.width = 32, settings.height = 24;
  return settings;
}

class ManyLights : public ShadowTest, public testing::WithParamInterface<Technique> {};
class ChosenSize : public ShadowTest {};

TEST_P(ManyLights, EightFitAtTheDefaultSize) {
  const RenderPlan settings = small(GetParam().name);
  const RenderResult result = render(lit_by_many(GetParam().lights, 8), settings);
  const auto& green = result.picture.channels[1].values;
  EXPECT_GT(*std::ranges::max_element(green), 0.0f);
  ASSERT_TRUE(result.shadows);
  const ShadowReport& report = *result.shadows;
  if (report.size == 0) return; // it has no maps
  EXPECT_EQ(report.smaller.empty(), report.size == settings.shadow_size);
  EXPECT_LE(report.size, settings.shadow_size);
  const auto bias = kHybrid.bias(settings, result);
  EXPECT_EQ(std::ranges::count(bias, report.smaller), report.smaller.empty() ? 0 : 1);
}

INSTANTIATE_TEST_SUITE_P(OfEveryTechnique, ManyLights,
                         testing::Values(Technique{"map", Many::points}, Technique{"map-id", Many::spots},
                                         Technique{"pcf", Many::spots}, Technique{"vsm", Many::spots},
                                         Technique{"esm", Many::suns}, Technique{"evsm", Many::points},
                                         Technique{"moment", Many::spots}, Technique{"leak", Many::points},
                                         Technique{"pcss", Many::squares}, Technique{"vssm", Many::squares},
                                         Technique{"average", Many::squares}, Technique{"cascades", Many::suns},
                                         Technique{"sdsm", Many::suns}, Technique{"lispsm", Many::suns},
                                         Technique{"tsm", Many::suns}, Technique{"psm", Many::suns},
                                         Technique{"cube", Many::points}, Technique{"paraboloid", Many::points},
                                         Technique{"virtual", Many::spots}, Technique{"izb", Many::points},
                                         Technique{"planar", Many::points}, Technique{"lightmap", Many::points},
                                         Technique{"projected", Many::spots}, Technique{"zfail", Many::points}),
                         [](const auto& of) {
                           std::string name(of.param.name);
                           std::erase(name, '-');
                           return name;
                         });

TEST_F(ChosenSize, IsKeptOrRefused) {
  RenderPlan settings = small("vsm");
  settings.shadow_size = 512;
  const RenderResult result = render(lit_by_many(Many::spots, 2), settings);
  EXPECT_EQ(result.shadows->size, 512u);
  settings.shadow_size = 16384;
  try {
    render(lit_by_many(Many::points, 2), settings);
    FAIL() << "rendered";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("16384x16384"), std::string::npos) << error.what();
  }
}

} // namespace
} // namespace wavepath::test
