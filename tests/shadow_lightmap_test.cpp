// Lightmaps: texels hold what rays from their points find, and what is between them is interpolated in the atlas.
#include "tests/shadow_scene.h"

#include <gtest/gtest.h>

#include <map>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/raster/placed_triangles.h"
#include "host/integrators/hybrid/shadows/lightmap_charts.h"
#include "kernels/hybrid/shadows/lightmap_types.h"

namespace wavepath::test {
namespace {

PackedScene packed(Scene scene) { return pack(scene, {.direct = gpu::kDirectNee}); }

struct Texel {
  glm::dvec3 point; // world
  std::uint32_t side = 0;
};

// The points that the texels of an atlas stand for, worked out from what kernels/hybrid/shadows/lightmap_types.h says
// of charts.
std::vector<Texel> texels_of(const PackedScene& scene, std::uint32_t size) {
  const LightmapCharts atlas = make_lightmap_charts(scene, size);
  std::vector<Texel> texels;
  for (std::uint32_t y = 0; y < size; ++y)
    for (std::uint32_t x = 0; x < size; ++x) {
      const glm::uvec2 owner = atlas.texels[y * size + x];
      if (owner.x == gpu::kNone) continue;
      const glm::uvec2 chart = atlas.charts[atlas.first[owner.y] + owner.x];
      const std::uint32_t side = chart.y & gpu::kChartSideMask, apex = chart.y >> gpu::kChartApexShift & 3u;
      EXPECT_FALSE(chart.y & gpu::kChartSingle); // the scenes are of rectangles
      glm::dvec2 at = (glm::dvec2(x, y) + 0.5 - glm::dvec2(chart.x & 0xffffu, chart.x >> 16)) / double(side);
      EXPECT_TRUE(at.x > 0.0 && at.y > 0.0 && at.x < 1.0 && at.y < 1.0);
      if (chart.y & gpu::kChartUpper) at = 1.0 - at;
      EXPECT_LE(at.x + at.y, 1.0 + 1e-12);
      const auto p = placed_corners(scene.triangles[owner.x], instance_of(scene, owner.y));
      const glm::dvec3 &a = p[apex], &b = p[(apex + 1) % 3], &c = p[(apex + 2) % 3];
      texels.push_back({scene.origin + a + at.x * (b - a) + at.y * (c - a), side});
    }
  return texels;
}

double mean(const std::vector<float>& values) {
  double sum = 0.0;
  for (const float value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// Mean error over the mean.
double error(const std::vector<float>& truth, const std::vector<float>& picture) {
  double sum = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) sum += std::abs(picture[i] - truth[i]);
  return sum / (mean(truth) * static_cast<double>(truth.size()));
}

class LightmapTest : public ShadowTest {};

// The oracle: at the centres of texels, the picture is the traced one. Its pixels are as far apart as texels are, and a
// first picture tells how far the frame looks past their middles.
TEST_F(LightmapTest, TexelsHoldTheTracedShadowOfTheirPoint) {
  constexpr std::uint32_t kSize = 32, kPixels = 16;
  for (const auto& [name, scene] :
       {std::pair{"sun", lit_by(sun())}, {"spot", lit_by(spot())}, {"lamp", lit_by(lamp())}}) {
    SCOPED_TRACE(name);
    std::uint32_t side = 0;
    for (const Texel& texel : texels_of(packed(scene), kSize)) side = std::max(side, texel.side);
    ASSERT_GE(side, kPixels);
    const double pitch = 6.0 / side, first = pitch * (std::floor((side - kPixels) / 2.0) + 0.5) - 3.0;
    Scene seen = scene;
    const glm::dvec3 middle(glm::dvec3(1, 0, 1) * (first + 0.5 * (kPixels - 1) * pitch));
    seen.cameras.front() = camera_above(middle, 0.5 * kPixels * pitch);
    seen.cameras.front().world_from_camera[3].y = 0.01; // below all but the box that stands on the floor
    RenderPlan settings = shadow_settings("lightmap", kSize), bright = settings, traced = shadow_settings("traced");
    bright.shadow_ambient = 1.0;
    for (RenderPlan* one : {&settings, &bright, &traced}) one->width = one->height = kPixels;
    traced.aovs = {"position"};
    const Picture place = render(seen, traced).picture;
    const glm::dvec3 at(channel(place, "P.X").front(), 0.0, channel(place, "P.Z").front());
    seen.cameras.front().world_from_camera[3] += glm::dvec4(first - at.x, 0.0, first - at.z, 0.0);
    const RenderResult truth = render(seen, traced);
    const std::vector<float> whole = light(seen, bright), picture = light(seen, settings);
    const std::vector<float>&x = channel(truth.picture, "P.X"), &z = channel(truth.picture, "P.Z");
    int lit = 0, dark = 0;
    for (std::size_t i = 0; i < picture.size(); ++i) {
      EXPECT_NEAR(x[i], first + static_cast<double>(i % kPixels) * pitch, 1e-5);
      EXPECT_NEAR(z[i], first + static_cast<double>(i / kPixels) * pitch, 1e-5);
      if (std::abs(x[i] + 0.3f) < 0.32f && std::abs(z[i] - 0.1f) < 0.32f) continue; // two surfaces in one place
      const float traced_light = truth.picture.channels[1].values[i];
      EXPECT_NEAR(picture[i], traced_light, 1e-3 * whole[i]) << x[i] << " " << z[i];
      if (whole[i] > 0.0f) ++(traced_light > 0.0f ? lit : dark);
    }
    EXPECT_GE(lit, 20);
    EXPECT_GE(dark, 4);
  }
}

TEST_F(LightmapTest, ConvergesToTracedShadows) {
  for (const auto& [name, scene] :
       {std::pair{"sun", lit_by(sun())}, {"spot", lit_by(spot())}, {"lamp", lit_by(lamp())}}) {
    SCOPED_TRACE(name);
    const std::vector<float> truth = light(scene, shadow_settings("traced"));
    const double coarse = error(truth, light(scene, shadow_settings("lightmap", 64))),
                 fine = error(truth, light(scene, shadow_settings("lightmap", 512)));
    EXPECT_GT(coarse, 0.005); // there is something to get wrong
    EXPECT_LT(fine, 0.3 * coarse);
    EXPECT_LT(fine, 0.005);
  }
}

// Penumbrae: the fraction of the lamp's points that a texel sees.
TEST_F(LightmapTest, LampsWithAnExtentHavePenumbrae) {
  RenderPlan settings = shadow_settings("lightmap", 256), traced = shadow_settings("traced");
  settings.last_sample = traced.last_sample = 32;
  const std::vector<float> truth = light(lit_by_square(), traced);
  settings.shadow_taps = 32;
  const double many = error(truth, light(lit_by_square(), settings));
  settings.shadow_taps = 1;
  const double one = error(truth, light(lit_by_square(), settings));
  EXPECT_LT(many, 0.02);
  EXPECT_GT(one, 2.0 * many); // the middle alone casts a hard shadow
}

TEST_F(LightmapTest, PlacedTurnedAndMirroredSurfacesHaveChartsOfTheirOwn) {
  Scene scene = lit_by(sun());
  const std::uint32_t mesh = add_mesh(scene, box({0, 0, 0}, {0.1f, 0.1f, 0.1f}));
  for (int i = 0; i < 12; ++i) {
    const double turn = 0.7 * i, mirror = i % 2 ? -1.0 : 1.0;
    add_instance(scene, mesh,
                 {{mirror * std::cos(turn), 0, -std::sin(turn), 0},
                  {0, 1.0 + 0.1 * i, 0, 0},
                  {mirror * std::sin(turn), 0, std::cos(turn), 0},
                  {1.5 * std::cos(2.4 * i), 0.4 + 0.02 * i, 1.5 * std::sin(2.4 * i), 1}});
  }
  const std::vector<float> truth = light(scene, shadow_settings("traced"));
  const double coarse = error(truth, light(scene, shadow_settings("lightmap", 128))),
               fine = error(truth, light(scene, shadow_settings("lightmap", 1024)));
  EXPECT_LT(fine, 0.3 * coarse);
  EXPECT_LT(fine, 0.02);
}

// A veil takes its fraction of the light, as it does from rays.
TEST_F(LightmapTest, SurfacesLetLightThroughAsTracedOnesDo) {
  Scene scene = lit_by(sun({0.0, -1.0, 0.0}));
  Material veil = plain_material();
  veil.base_color = {0.5f, 0.5f, 0.5f, 0.3f};
  veil.alpha_mode = AlphaMode::blend;
  scene.materials.push_back(veil);
  add_instance(scene, add_mesh(scene, rectangle({-1.6f, 0.5f, -1.0f}, {0, 0, 0.8f}, {0.8f, 0, 0}), 1));
  scene.cameras.front() = camera_above({-1.6, 0.0, -1.0}, 0.3);
  scene.cameras.front().world_from_camera[3].y = 0.3; // below the veil
  RenderPlan settings = shadow_settings("lightmap", 256), traced = shadow_settings("traced"), bright = settings;
  bright.shadow_ambient = 1.0;
  const double truth = mean(light(scene, traced)), whole = mean(light(scene, bright));
  EXPECT_NEAR(truth, 0.7 * whole, 1e-4 * whole);
  EXPECT_NEAR(mean(light(scene, settings)), truth, 1e-5 * whole);
}

// The known artefact: what is interpolated at the edge of a chart is of whatever chart stands next to it in the atlas.
TEST_F(LightmapTest, LightLeaksAcrossEdgesOfCharts) {
  constexpr std::uint32_t kSize = 16;
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  for (const glm::vec3 middle : {glm::vec3(-5, 0, 0), glm::vec3(5, 0, 0), glm::vec3(5, 2, 0), glm::vec3(-5, 2, 9)})
    add_instance(scene, add_mesh(scene, rectangle(middle, {0, 0, 1}, {1, 0, 0})));
  add_instance(scene, add_mesh(scene, rectangle({5, 2.1f, 0}, {0, 0, 1.5f}, {1.5f, 0, 0}))); // a roof
  scene.lights.push_back(sun({0.0, -1.0, 0.0}));
  scene.cameras.push_back(camera_above({5, 0, 0}, 0.99));
  scene.cameras.front().world_from_camera[3].y = 1.0; // under the roof, where all is dark
  RenderPlan settings = shadow_settings("lightmap", kSize);
  settings.width = settings.height = 64;
  std::uint32_t side = 0;
  for (const Texel& texel : texels_of(packed(scene), kSize))
    if (glm::length(texel.point - glm::dvec3(5, 0, 0)) < 1.0) side = texel.side;
  ASSERT_GE(side, 3u);
  const double rim = 1.0 / side; // in fractions of the rectangle: a texel, and a little
  const std::vector<float> truth = light(scene, shadow_settings("traced")), picture = light(scene, settings);
  EXPECT_EQ(mean(truth), 0.0);
  int leaks = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const bool is_lit = picture[y * 64 + x] > 0.0f;
      leaks += is_lit;
      const double from_edge = std::min({x, y, 63 - x, 63 - y}) / 64.0;
      EXPECT_TRUE(from_edge <= rim || !is_lit) << x << " " << y;
    }
  EXPECT_GT(leaks, 40);
}

TEST_F(LightmapTest, ChartsAreAsLargeAsSurfaces) {
  constexpr std::uint32_t kSize = 256;
  const PackedScene scene = packed(lit_by(sun()));
  const LightmapCharts atlas = make_lightmap_charts(scene, kSize);
  EXPECT_EQ(atlas.count, 13u);        // a pair for each face
  std::map<std::uint32_t, int> sides; // of how many texels
  for (const Texel& texel : texels_of(scene, kSize)) ++sides[texel.side];
  double taken = 0.0;
  for (const auto& [side, texels] : sides) {
    EXPECT_EQ(texels % (side * side), 0u) << side; // none overlaps another
    taken += texels;
  }
  const double floor_side = sides.rbegin()->first; // 6 m long; faces are 0.6 x 0.6, 0.6 x 1, 0.7 x 0.7, 0.7 x 0.1 m
  for (const auto& [side, texels] : sides) {
    double nearest = std::abs(side - floor_side);
    for (const double metres : {0.6, std::sqrt(0.6), 0.7, std::sqrt(0.07)})
      nearest = std::min(nearest, std::abs(side - metres / 6.0 * floor_side));
    EXPECT_LT(nearest, 1.0) << side;
  }
  EXPECT_GE(sides.size(), 4u);
  EXPECT_GT(taken, 0.6 * kSize * kSize);
}

TEST_F(LightmapTest, SameBitsHoweverTheWorkIsCut) {
  RenderPlan settings = shadow_settings("lightmap", 128);
  settings.last_sample = 3;
  settings.shadow_samples = 2;
  const std::vector<float> whole = light(lit_by(lamp()), settings);
  settings.wave_slots = 1024;
  EXPECT_EQ(light(lit_by(lamp()), settings), whole);
}

TEST_F(LightmapTest, RefusesWhatDoesNotFit) {
  const auto refusal = [&](const Scene& scene, std::uint32_t size) -> std::string {
    try {
      render(scene, shadow_settings("lightmap", size));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  Scene crowded = lit_by(lamp());
  for (int i = 0; i < 300; ++i) add_instance(crowded, add_mesh(crowded, rectangle({0, 3, 0}, {0, 0, 1}, {1, 0, 0})));
  EXPECT_NE(refusal(crowded, 16).find("charts"), std::string::npos) << refusal(crowded, 16);
  EXPECT_EQ(refusal(crowded, 64), "");
  Scene bright = bodies();
  for (int i = 0; i < 9; ++i) bright.lights.push_back(lamp());
  EXPECT_NE(refusal(bright, 16384).find("MiB"), std::string::npos) << refusal(bright, 16384);
}

} // namespace
} // namespace wavepath::test
