// Irregular z-buffers: the picture is that of traced shadows to the bit, whatever the lights, surfaces and cells are.
#include "tests/shadow_scene.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include "host/base/error.h"

namespace wavepath::test {
namespace {

class IzbTest : public ShadowTest {
protected:
  // Every channel is that of traced shadows, and those are none that light samples alone would make.
  RenderResult expect_traced(const Scene& scene, const RenderPlan& settings) {
    RenderPlan traced = settings;
    traced.shadows = kShadowsTraced;
    traced.shadow_size = RenderPlan{}.shadow_size;
    const RenderResult truth = render(scene, traced);
    RenderResult listed = render(scene, settings);
    for (std::size_t channel = 0; channel < 3; ++channel)
      EXPECT_EQ(truth.picture.channels[channel].values, listed.picture.channels[channel].values) << channel;
    EXPECT_TRUE(listed.shadows && listed.shadows->longest_list > 0);
    return listed;
  }
};

TEST_F(IzbTest, ShadowsAreTracedOnes) {
  for (const auto& [name, scene] :
       {std::pair{"sun", lit_by(sun())}, {"spot", lit_by(spot())}, {"lamp", lit_by(lamp())}})
    for (const std::uint32_t size : {16u, 333u, 1024u}) {
      SCOPED_TRACE(fmt::format("{} {}", name, size));
      expect_traced(scene, shadow_settings("izb", size));
    }
}

// With all light in shadows, what is dark is what lists left to rays: nothing, or the equality would tell nothing.
TEST_F(IzbTest, ListsHoldEveryRay) {
  for (const auto& [name, scene] :
       {std::pair{"sun", lit_by(sun())}, {"spot", lit_by(spot())}, {"lamp", lit_by(lamp())}}) {
    SCOPED_TRACE(name);
    RenderPlan all = shadow_settings("izb"), dark = all;
    all.shadow_ambient = 1.0;
    RenderPlan by_map = shadow_settings("map");
    by_map.shadow_ambient = 1.0;
    EXPECT_EQ(light(scene, all), light(scene, by_map));
    EXPECT_GT(false_fractions(light(scene, all), light(scene, dark)).dark, 0.02); // there are shadows
  }
}

// A sheet a hair's breadth before the lamp covers cells far and wide; one around it, all.
TEST_F(IzbTest, SurfacesNextToTheLightCount) {
  Scene scene = lit_by(lamp({0.2, 2.0, 0.3}));
  add_instance(scene, add_mesh(scene, rectangle({0.6f, 1.9999f, 0.3f}, {0.4f, 0, 0}, {0, 0, 0.4f})));
  add_instance(scene, add_mesh(scene, rectangle({-0.5f, 1.0f, 0.3f}, {0, 3.0f, 0}, {0, 0, 0.02f})));
  for (const std::uint32_t size : {64u, 1024u}) expect_traced(scene, shadow_settings("izb", size));
}

// What lets a fraction of the light through takes it from a ray in whichever order lists have it.
TEST_F(IzbTest, SurfacesLetLightThroughAsTracedOnesDo) {
  Scene scene = lit_by(spot());
  Material veil = plain_material();
  veil.base_color = {0.5f, 0.5f, 0.5f, 0.3f};
  veil.alpha_mode = AlphaMode::blend;
  scene.materials.push_back(veil);
  Material holes = plain_material();
  holes.base_color = {0.5f, 0.5f, 0.5f, 0.3f}; // below the cutoff
  holes.alpha_mode = AlphaMode::mask;
  scene.materials.push_back(holes);
  for (const float height : {1.2f, 1.4f, 1.6f, 1.8f})
    add_instance(scene, add_mesh(scene, rectangle({-0.4f, height, height - 1.5f}, {0, 0, 0.4f}, {0.5f, 0, 0}), 1));
  add_instance(scene, add_mesh(scene, rectangle({0.4f, 1.3f, 0.2f}, {0, 0, 0.6f}, {0.6f, 0, 0}), 2));
  RenderPlan settings = shadow_settings("izb", 256);
  settings.last_sample = 2;
  expect_traced(scene, settings);
}

TEST_F(IzbTest, SurfacesAreCulledAsTracedOnesAre) {
  Scene scene = lit_by(sun());
  add_instance(scene, add_mesh(scene, rectangle({-0.5f, 1.5f, 0.5f}, {0, 0, 0.6f}, {0.6f, 0, 0}))); // faces the sun
  std::vector<std::vector<float>> pictures;
  for (const std::uint32_t cull : {gpu::kCullCamera, gpu::kCullAll}) {
    RenderPlan settings = shadow_settings("izb", 256);
    settings.cull = cull;
    pictures.push_back(expect_traced(scene, settings).picture.channels[1].values);
  }
  EXPECT_NE(pictures[0], pictures[1]);
}

// One mesh placed often, turned, stretched and mirrored: rays are tested in its space.
TEST_F(IzbTest, InstancesAreTestedInTheirSpace) {
  Scene scene = lit_by(lamp());
  const std::uint32_t mesh = add_mesh(scene, box({0, 0, 0}, {0.1f, 0.1f, 0.1f}));
  for (int i = 0; i < 24; ++i) {
    const double turn = 0.7 * i, x = 1.5 * std::cos(2.4 * i), z = 1.5 * std::sin(2.4 * i);
    const double stretch = 0.2 + 0.15 * i, mirror = i % 2 ? -1.0 : 1.0;
    add_instance(scene, mesh,
                 {{mirror * std::cos(turn), 0, -std::sin(turn), 0},
                  {0, stretch, 0, 0},
                  {mirror * std::sin(turn), 0, std::cos(turn), 0},
                  {x, 0.3 + 0.02 * i, z, 1}});
  }
  expect_traced(scene, shadow_settings("izb", 512));
}

// What few cells cost: long lists, of which each ray is tested with all triangles of its cell.
TEST_F(IzbTest, FewCellsHaveLongLists) {
  const Scene scene = lit_by(sun());
  const auto longest = [&](std::uint32_t size) {
    return render(scene, shadow_settings("izb", size)).shadows->longest_list;
  };
  const std::uint32_t coarse = longest(16), fine = longest(2048);
  EXPECT_GE(coarse, 96u * 72 / (16 * 16)); // the mean of all pixels, all of which see the scene or there would be fewer
  EXPECT_LE(fine, 16u);
}

TEST_F(IzbTest, SameBitsHoweverTheWorkIsCut) {
  RenderPlan settings = shadow_settings("izb", 64);
  settings.last_sample = 3;
  const std::vector<float> whole = light(lit_by(lamp()), settings);
  settings.wave_slots = 1024;
  EXPECT_EQ(light(lit_by(lamp()), settings), whole);
}

TEST_F(IzbTest, RefusesWhatItHasNoListsFor) {
  EXPECT_THROW(render(lit_by_square(), shadow_settings("izb")), Error);
  try {
    render(lit_by(lamp()), shadow_settings("izb", 16384));
    FAIL() << "it fitted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("--shadow-size"), std::string::npos) << error.what();
  }
}

} // namespace
} // namespace wavepath::test
