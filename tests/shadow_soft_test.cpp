// Soft shadows from many points of a lamp and from summed-area tables: what they converge to, and how they show.
#include "tests/shadow_scene.h"

#include <random>

#include <gtest/gtest.h>

#include "kernels/base/frame_types.h"
#include "kernels/hybrid/shadows/sat_columns.spv.h"
#include "kernels/hybrid/shadows/sat_rows.spv.h"
#include "tests/probe.h"
#include "tests/probes/shadow_sat_probe.spv.h"

namespace wavepath::test {
namespace {

struct SatBox {
  glm::vec2 lo, hi;
  std::uint32_t about, size;
  glm::vec2 mean;
};

class SummedAreas : public VulkanTest {
protected:
  static constexpr std::uint32_t kSize = 64, kSteps = (1u << 20) - 1;

  // The table of a map, by the technique's own kernels.
  std::vector<glm::uvec4> table_of(const std::vector<float>& depths) {
    gpu::ShadowFrame frame{};
    frame.size = kSize;
    gpu::ShadowView view{};
    view.far = 1.0f;
    const Buffer frames = upload(device(), std::vector{frame}), views = upload(device(), std::vector{view}),
                 map = upload(device(), depths), table = upload(device(), std::vector<glm::uvec4>(kSize * kSize));
    const std::vector<Binding> bindings = {{gpu::kBindShadowFrame, BindingKind::uniform, &frames},
                                           {gpu::kBindShadowViews, BindingKind::texels_rgba32f, &views},
                                           {gpu::kBindShadowDepths, BindingKind::texels_r32f, &map},
                                           {gpu::kBindShadowScratch, BindingKind::storage, &table}};
    const BindingSet set(device(), bindings, sizeof(gpu::Wave));
    const Kernel rows(device(), "rows", wavepath_sat_rows_spv, set, {}),
        columns(device(), "columns", wavepath_sat_columns_spv, set, {});
    gpu::Wave wave{};
    wave.pixel_count = kSize;
    Commands commands(device());
    commands.bind(set);
    commands.dispatch(rows, 1 + kSize / gpu::kWorkgroupSize, &wave);
    commands.barrier();
    commands.dispatch(columns, 1 + kSize / gpu::kWorkgroupSize, &wave);
    commands.submit_and_wait();
    return download<glm::uvec4>(table, kSize * kSize);
  }
  static std::vector<float> random_depths() {
    std::mt19937 bits(1);
    std::vector<float> depths(kSize * kSize);
    for (float& depth : depths) depth = static_cast<float>(bits() * 0x1p-32);
    for (std::size_t i = 0; i < depths.size(); i += 7) depths[i] = gpu::kFar; // where nothing is
    return depths;
  }
  static std::uint64_t steps(float depth) {
    const float unit = glm::clamp(2.0f * depth - 1.0f, -1.0f, 1.0f);
    return static_cast<std::uint64_t>(std::nearbyint((0.5f + 0.5f * unit) * static_cast<float>(kSteps)));
  }
};

TEST_F(SummedAreas, EqualBruteForceToTheLastBit) {
  const std::vector<float> depths = random_depths();
  const std::vector<glm::uvec4> table = table_of(depths);
  const auto sum = [&](std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1, int which) {
    const auto at = [&](std::uint32_t x, std::uint32_t y) {
      if (x == 0 || y == 0) return std::uint64_t{0};
      const glm::uvec4& entry = table[(y - 1) * kSize + x - 1];
      return std::uint64_t{entry[2 * which + 1]} << 32 | entry[2 * which];
    };
    return at(x1, y1) - at(x0, y1) - at(x1, y0) + at(x0, y0);
  };
  std::mt19937 bits(2);
  for (int i = 0; i < 300; ++i) {
    const std::uint32_t x0 = bits() % kSize, x1 = x0 + 1 + bits() % (kSize - x0), y0 = bits() % kSize,
                        y1 = y0 + 1 + bits() % (kSize - y0);
    std::uint64_t first = 0, second = 0;
    for (std::uint32_t y = y0; y < y1; ++y)
      for (std::uint32_t x = x0; x < x1; ++x) {
        first += steps(depths[y * kSize + x]);
        second += steps(depths[y * kSize + x]) * steps(depths[y * kSize + x]);
      }
    ASSERT_EQ(sum(x0, y0, x1, y1, 0), first);
    ASSERT_EQ(sum(x0, y0, x1, y1, 1), second);
  }
}

// Boxes whose edges lie within texels, about some depth.
TEST_F(SummedAreas, MeansCountTexelsByThePartInside) {
  const std::vector<float> depths = random_depths();
  std::mt19937 bits(3);
  const auto random = [&](double most) { return static_cast<float>(most * bits() * 0x1p-32); };
  std::vector<SatBox> boxes;
  for (int i = 0; i < 500; ++i) {
    const glm::vec2 side(1.0f + random(i % 2 ? 3.0 : 30.0), 1.0f + random(30.0));
    const glm::vec2 lo(random(kSize - side.x), random(kSize - side.y));
    boxes.push_back({lo, lo + side, static_cast<std::uint32_t>(bits() % kSteps), kSize, {}});
  }
  std::vector<ProbeBuffer> buffers{to_probe(boxes), to_probe(table_of(depths))};
  run_probe(device(), wavepath_shadow_sat_probe_spv, static_cast<std::uint32_t>(boxes.size()), buffers);
  for (const SatBox& box : from_probe<SatBox>(buffers[0])) {
    double weight = 0.0, first = 0.0, second = 0.0;
    for (std::uint32_t y = 0; y < kSize; ++y)
      for (std::uint32_t x = 0; x < kSize; ++x) {
        const auto part = [](double lo, double hi, double at) {
          return std::max(std::min(hi, at + 1.0) - std::max(lo, at), 0.0);
        };
        const double w = part(box.lo.x, box.hi.x, x) * part(box.lo.y, box.hi.y, y);
        const double d = static_cast<double>(steps(depths[y * kSize + x])) - box.about;
        weight += w, first += w * d, second += w * d * d;
      }
    ASSERT_NEAR(box.mean.x, first / weight, 1e-5 * kSteps);
    ASSERT_NEAR(box.mean.y / (second / weight), 1.0, 1e-5);
  }
}

class SoftTest : public ShadowTest {
protected:
  // A small picture with little noise, and the same points of the lamp for all techniques.
  static RenderPlan fine(std::string_view name, std::uint32_t taps = 16) {
    RenderPlan settings = shadow_settings(name, name == "traced" ? 1024 : 512);
    settings.width = 32, settings.height = 24;
    settings.last_sample = 128;
    if (name != "traced" && name != "map") settings.shadow_taps = taps;
    return settings;
  }
  static double error(const std::vector<float>& truth, const std::vector<float>& picture) {
    double sum = 0.0, whole = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) sum += std::abs(truth[i] - picture[i]), whole += truth[i];
    return sum / whole;
  }
};

// All in one test, because the truth takes longest: 1024 rays a pixel.
TEST_F(SoftTest, PointsAndVarianceComeNearTheLamp) {
  const Scene scene = lit_by_square(0.4f);
  RenderPlan traced = fine("traced");
  traced.last_sample = 1024;
  const std::vector<float> truth = light(scene, traced);
  const double hard = error(truth, light(scene, fine("map")));
  std::vector<double> points;
  for (const std::uint32_t taps : {4u, 16u, 64u}) points.push_back(error(truth, light(scene, fine("average", taps))));
  EXPECT_LT(points[0], 0.4 * hard);
  EXPECT_LT(points[1], 0.7 * points[0]);
  EXPECT_LT(points[2], points[1]); // by now texels and what 128 frames leave of noise count as well
  EXPECT_LT(points[2], 0.01);
  const double variance = error(truth, light(scene, fine("vssm"))),
               closer = error(truth, light(scene, fine("pcss", 64)));
  EXPECT_LT(variance, 0.4 * hard);
  EXPECT_LT(variance, 1.2 * closer);
}

Scene lit_by_disc() {
  std::vector<glm::vec3> disc;
  const auto at = [](int i) { return 0.4f * glm::vec3(std::cos(0.2617994f * i), 6.25f, std::sin(0.2617994f * i)); };
  for (int i = 0; i < 24; ++i)
    for (const glm::vec3& p : {glm::vec3(0, 2.5f, 0), at(i), at((i + 1) % 24)}) disc.push_back(p);
  return lit_by_lamp(disc);
}

TEST_F(SoftTest, DiscsCastSoftShadowsToo) {
  const Scene scene = lit_by_disc();
  RenderPlan traced = fine("traced");
  traced.last_sample = 256;
  const std::vector<float> truth = light(scene, traced);
  const double hard = error(truth, light(scene, fine("map")));
  EXPECT_LT(error(truth, light(scene, fine("average", 32))), 0.3 * hard);
  EXPECT_LT(error(truth, light(scene, fine("vssm"))), 0.4 * hard);
}

// Seen from the middle, its own surface casts nothing; seen from points on it, it hides the far side.
TEST_F(SoftTest, SpheresCastSoftShadowsToo) {
  const Scene scene = lit_by_lamp(ball({-0.6f, 2.0f, 0.3f}, 0.35f));
  // As fractions of the light that would arrive without shadows: of 352 facets, each sample takes one, which is noise.
  const auto fractions = [&](std::string_view name, std::uint32_t samples, std::uint32_t taps) {
    RenderPlan settings = fine(name, taps), bright = fine("map");
    settings.last_sample = bright.last_sample = samples;
    bright.shadow_ambient = 1.0;
    std::vector<float> picture = light(scene, settings);
    const std::vector<float> whole = light(scene, bright);
    for (std::size_t i = 0; i < picture.size(); ++i) picture[i] = whole[i] > 0.0f ? picture[i] / whole[i] : -1.0f;
    return picture;
  };
  const std::vector<float> truth = fractions("traced", 512, 1);
  const auto off = [&](std::string_view name, std::uint32_t taps) { // mean square
    const std::vector<float> picture = fractions(name, 64, taps);
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i)
      if (truth[i] >= 0.0f && picture[i] >= 0.0f) sum += (truth[i] - picture[i]) * (truth[i] - picture[i]);
    return sum / static_cast<double>(truth.size());
  };
  const double hard = off("map", 1);
  EXPECT_LT(off("average", 64), 0.06 * hard);
  EXPECT_LT(off("lightmap", 64), 0.08 * hard);
  EXPECT_LT(off("pcss", 64), 0.08 * hard);
  EXPECT_LT(off("vssm", 1), 0.16 * hard);
}

TEST_F(SoftTest, SameBitsHoweverTheWorkIsCut) {
  for (const auto& [name, scene] : {std::pair{"vssm", lit_by_disc()},
                                    {"average", lit_by_disc()},
                                    {"leak", lit_by(spot())},
                                    {"moment", lit_by(lamp())}}) {
    SCOPED_TRACE(name);
    RenderPlan settings = shadow_settings(name, 128);
    settings.last_sample = 3;
    const std::vector<float> whole = light(scene, settings);
    settings.wave_slots = 1024;
    EXPECT_EQ(light(scene, settings), whole);
  }
}

TEST_F(SoftTest, TheShadowOfAPointIsTheMapFiltered) {
  const Scene scene = lit_by_square(0.002f);
  const auto picture = [&](std::string_view name) {
    RenderPlan settings = shadow_settings(name, 256);
    settings.shadow_bias = gpu::kBiasConstant;
    if (name == "vsm") settings.shadow_blur = 0.0;
    return light(scene, settings);
  };
  const std::vector<float> filtered = picture("vsm"), soft = picture("vssm"), one = picture("average");
  EXPECT_LT(error(filtered, soft), 2e-3);
  EXPECT_LT(error(picture("map"), one), 3e-3); // of edges between the texels of two views
}

// The edge of a plate's shadow, from dark to light.
Scene half_plane() {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  add_instance(scene, add_mesh(scene, rectangle({0, 0, 0}, {0, 0, 4}, {4, 0, 0})));
  add_instance(scene, add_mesh(scene, rectangle({-2.0f, 1.0f, 0}, {0, 0, 4}, {2, 0, 0})));
  Material emitter = plain_material();
  emitter.emission = glm::vec3(30.0f);
  emitter.double_sided = false;
  scene.materials.push_back(emitter);
  add_instance(scene, add_mesh(scene, rectangle({0, 2.0f, 0}, {0.2f, 0, 0}, {0, 0, 0.2f}), 1));
  Camera camera;
  camera.orthographic = true;
  camera.xmag = 0.4, camera.ymag = 0.0025; // 160 pixels
  camera.world_from_camera = {{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 0.5, 0, 1}};
  scene.cameras.push_back(camera);
  return scene;
}

class EdgeTest : public SoftTest {
protected:
  // Fractions of the light along the edge's normal, from -0.4 to 0.4 metres.
  std::vector<float> profile(std::string_view name, std::uint32_t taps) {
    RenderPlan settings = shadow_settings(name, 512);
    settings.width = 160, settings.height = 1;
    settings.shadow_taps = taps;
    const std::vector<float> dark = light(half_plane(), settings);
    settings.shadow_ambient = 1.0;
    const std::vector<float> whole = light(half_plane(), settings);
    std::vector<float> fractions;
    for (std::size_t i = 0; i < dark.size(); ++i) fractions.push_back(dark[i] / whole[i]);
    return fractions;
  }
};

// Half-planes parallel to the lamp are what both estimates are exact for: light rises linearly over 0.4 m.
TEST_F(EdgeTest, PenumbrasAreAsWideAsTheLampMakesThem) {
  for (const auto& [name, taps, tolerance] :
       {std::tuple{"vssm", 1u, 0.01f}, {"vssm", 16u, 0.01f}, {"average", 16u, 0.045f}, {"average", 100u, 0.02f}}) {
    SCOPED_TRACE(name);
    const std::vector<float> fractions = profile(name, taps);
    float worst = 0.0f;
    for (std::size_t i = 0; i < fractions.size(); ++i) {
      const float x = (static_cast<float>(i) + 0.5f) * 0.005f - 0.4f;
      worst = std::max(worst, std::abs(fractions[i] - std::clamp(x / 0.4f + 0.5f, 0.0f, 1.0f)));
    }
    EXPECT_LT(worst, tolerance);
  }
}

// Few points cast few hard shadows, each of which can be told from the next.
TEST_F(EdgeTest, FewPointsCastBands) {
  const auto between_bands =
      [](const std::vector<float>& fractions) { // pixels whose fraction is no multiple of a quarter
        return std::ranges::count_if(fractions,
                                     [](float s) { return std::abs(4.0f * s - std::round(4.0f * s)) > 0.1f; });
      };
  EXPECT_LT(between_bands(profile("average", 4)), 4);
  EXPECT_GT(between_bands(profile("average", 64)), 40);
}

} // namespace
} // namespace wavepath::test
