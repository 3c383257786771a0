// Shadow maps that are averaged before they are looked up: what they promise of the light, and where they leak.
#include "tests/shadow_scene.h"

#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "tests/probe.h"
#include "tests/probes/shadow_bounds_probe.spv.h"

namespace wavepath::test {
namespace {

struct Case {
  float depth = 0.0f, exponent = 80.0f;
  std::uint32_t first = 0, count = 0;
};
struct Answers {
  float variance, exponential, warped, four, four16;
};

// Lists of depths from -1 to 1, and what bounds make of them.
class ShadowBounds : public VulkanTest {
protected:
  void add(float depth, const std::vector<float>& depths, float exponent = 80.0f) {
    cases_.push_back(
        {depth, exponent, static_cast<std::uint32_t>(depths_.size()), static_cast<std::uint32_t>(depths.size())});
    depths_.insert(depths_.end(), depths.begin(), depths.end());
    const auto lit = std::ranges::count_if(depths, [&](float d) { return d >= depth; });
    fractions_.push_back(static_cast<double>(lit) / static_cast<double>(depths.size()));
  }
  std::vector<Answers> answers() {
    std::vector<ProbeBuffer> buffers{to_probe(cases_), to_probe(depths_), ProbeBuffer(cases_.size() * sizeof(Answers))};
    run_probe(device(), wavepath_shadow_bounds_probe_spv, static_cast<std::uint32_t>(cases_.size()), buffers);
    return from_probe<Answers>(buffers[2]);
  }
  float unit() { return static_cast<float>(bits_() * 0x1p-31) - 1.0f; }

  std::mt19937 bits_{1};
  std::vector<Case> cases_;
  std::vector<float> depths_;
  std::vector<double> fractions_; // truly lit
};

TEST_F(ShadowBounds, NoneIsDarkerThanComparisons) {
  for (int i = 0; i < 20000; ++i) {
    // Up to four surfaces, some texels of each.
    std::vector<float> depths;
    for (int s = 0; s <= i % 4; ++s) {
      const float middle = 0.9f * unit(), slope = 0.1f * unit() * std::abs(unit());
      for (int k = 0; k < 3 + 2 * s; ++k) depths.push_back(middle + slope * unit());
    }
    add(i % 2 ? unit() : depths[bits_() % depths.size()], depths);
  }
  const std::vector<Answers> bounds = answers();
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const double fraction = fractions_[i];
    ASSERT_GE(bounds[i].variance, fraction - 1e-5) << i;
    ASSERT_GE(bounds[i].exponential, fraction - 1e-5) << i;
    ASSERT_GE(bounds[i].warped, fraction - 1e-5) << i;
    ASSERT_GE(bounds[i].four, fraction - 2e-3) << i; // rounding of a system of equations that is next to singular
    ASSERT_GE(bounds[i].four16, fraction - 2e-2) << i;
  }
}

TEST_F(ShadowBounds, TwoPlanesAreExact) {
  for (int i = 0; i < 1000; ++i) {
    const float blocker = -0.9f + 0.8f * std::abs(unit()), receiver = blocker + 0.2f + 0.6f * std::abs(unit());
    std::vector<float> depths(25, receiver);
    for (int k = 0; k < i % 26; ++k) depths[k] = blocker;
    add(receiver - 1e-4f, depths);
  }
  const std::vector<Answers> bounds = answers();
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    EXPECT_NEAR(bounds[i].variance, fractions_[i], 1e-3) << i;
    EXPECT_NEAR(bounds[i].exponential, fractions_[i], 5e-3) << i; // exp(80 * 1e-4 / 2), and 1 / exp(8)
    EXPECT_NEAR(bounds[i].warped, fractions_[i], 1e-3) << i;
    EXPECT_NEAR(bounds[i].four, fractions_[i], 1e-3) << i;
    EXPECT_NEAR(bounds[i].four16, fractions_[i], 2e-2) << i;
  }
}

TEST_F(ShadowBounds, ExponentialsTendToComparisons) {
  constexpr std::array kExponents = {10.0f, 20.0f, 40.0f, 80.0f};
  for (const float exponent : kExponents)
    for (int i = 0; i < 1000; ++i) {
      std::vector<float> depths(9, 0.5f); // what is not in front is the receiver
      for (int k = 0; k < i % 10; ++k) depths[k] = 0.5f - std::abs(unit());
      add(0.5f, depths, exponent);
    }
  const std::vector<Answers> bounds = answers();
  std::array<double, kExponents.size()> leaks{};
  for (std::size_t i = 0; i < bounds.size(); ++i) leaks[i / 1000] += (bounds[i].exponential - fractions_[i]) / 1000.0;
  for (std::size_t i = 1; i < leaks.size(); ++i) EXPECT_LT(leaks[i], 0.6 * leaks[i - 1]);
  EXPECT_LT(leaks.back(), 0.02);
}

constexpr std::array<std::string_view, 4> kFilterable = {"vsm", "esm", "evsm", "moment"};

RenderPlan filtered(std::string_view name, std::uint32_t size = 256, double blur = 2.5) {
  RenderPlan settings = shadow_settings(name, size);
  settings.shadow_blur = blur;
  settings.shadow_bias = gpu::kBiasConstant; // one depth for all of a filter's texels
  return settings;
}
// Comparisons over what the others average: 36 places in each texel. Each side of the square is found to 1/12 texel.
RenderPlan compared(std::uint32_t size = 256, double blur = 2.5) {
  RenderPlan settings = filtered("pcf", size, blur);
  settings.shadow_taps = 900;
  return settings;
}
constexpr float kTapError = 2.0f / 12.0f / 5.0f;

class FilterableTest : public ShadowTest {
protected:
  // Of the light that arrives without shadows.
  std::vector<float> lit_fraction(const Scene& scene, RenderPlan settings) {
    const std::vector<float> picture = light(scene, settings);
    RenderPlan whole = shadow_settings("map", 16);
    whole.width = settings.width, whole.height = settings.height;
    whole.shadow_ambient = 1.0;
    const std::vector<float> full = light(scene, whole);
    std::vector<float> fractions;
    for (std::size_t i = 0; i < full.size(); ++i) fractions.push_back(full[i] > 0.0f ? picture[i] / full[i] : 1.0f);
    return fractions;
  }
};

double mean(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}
double distance(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return sum / static_cast<double>(a.size());
}

TEST_F(FilterableTest, PicturesAreNoDarkerThanComparisons) {
  for (const auto& [light_name, scene] :
       {std::pair{"sun", lit_by(sun())}, {"spot", lit_by(spot())}, {"lamp", lit_by(lamp())}}) {
    const std::vector<float> fractions = lit_fraction(scene, compared());
    for (const std::string_view name : kFilterable) {
      SCOPED_TRACE(light_name + std::string(" ") + std::string(name));
      const std::vector<float> bound = lit_fraction(scene, filtered(name));
      for (std::size_t i = 0; i < fractions.size(); ++i) ASSERT_GE(bound[i], fractions[i] - kTapError - 2e-3f) << i;
      EXPECT_LT(mean(bound), 0.98); // and they do shade
    }
  }
}

// A plate above a floor, under a sun in the zenith.
Scene two_planes() {
  Scene scene = bodies();
  scene.instances.resize(1);
  add_instance(scene, add_mesh(scene, rectangle({0.2f, 1.0f, 0.1f}, {0, 0, 0.6f}, {0.6f, 0, 0})));
  scene.materials[0].double_sided = true;
  scene.lights.push_back(sun({0.0, -1.0, 0.0}));
  return scene;
}

TEST_F(FilterableTest, AParallelPlateCastsComparisonsShadow) {
  const Scene scene = two_planes();
  const std::vector<float> fractions = lit_fraction(scene, compared());
  ASSERT_LT(mean(fractions), 0.95);
  for (const std::string_view name : kFilterable) {
    SCOPED_TRACE(name);
    RenderPlan settings = filtered(name);
    settings.shadow_bias_amount = 1e-3; // more would bring the planes closer to each other
    const std::vector<float> bound = lit_fraction(scene, settings);
    for (std::size_t i = 0; i < fractions.size(); ++i) EXPECT_NEAR(bound[i], fractions[i], kTapError + 3e-3f) << i;
    EXPECT_LT(distance(bound, fractions), 1.5e-3);
  }
}

// Without a blur, depths are averaged between the four texels around a place alone.
TEST_F(FilterableTest, NoBlurIsASquareOfOneTexel) {
  const Scene scene = two_planes();
  const std::vector<float> fractions = lit_fraction(scene, compared(64, 0.5)),
                           bound = lit_fraction(scene, filtered("vsm", 64, 0.5));
  EXPECT_LT(distance(bound, fractions), 2e-3);
  EXPECT_GT(distance(bound, lit_fraction(scene, filtered("vsm", 64, 1.5))), 6e-3);
}

// Two plates above each other: on the floor below the lower one, the edge of the upper one shines through.
Scene two_plates() {
  Scene scene = bodies();
  scene.instances.resize(1);
  scene.materials[0].double_sided = true;
  add_instance(scene, add_mesh(scene, rectangle({-2.0f, 2.0f, 0}, {0, 0, 2}, {2, 0, 0}))); // its edge at x = 0
  add_instance(scene, add_mesh(scene, rectangle({0, 0.8f, 0}, {0, 0, 2}, {2, 0, 0})));
  Camera camera; // between the floor and the lower plate
  camera.orthographic = true;
  camera.xmag = 0.5, camera.ymag = 0.375;
  camera.world_from_camera = {{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 0.4, 0, 1}};
  scene.cameras = {camera};
  scene.lights.push_back(sun({0.0, -1.0, 0.0}));
  return scene;
}

TEST_F(FilterableTest, LightLeaksWhereShadowsOverlap) {
  const Scene scene = two_plates();
  EXPECT_EQ(mean(lit_fraction(scene, compared(64))), 0.0);
  std::array<float, 4> leaks{};
  for (std::size_t i = 0; i < leaks.size(); ++i)
    leaks[i] = std::ranges::max(lit_fraction(scene, filtered(kFilterable[i], 64)));
  const auto [vsm, esm, evsm, moment] = leaks;
  EXPECT_LT(esm, 0.1f * vsm);
  EXPECT_GT(vsm, 0.1f);
  EXPECT_LT(evsm, 0.1f * vsm);
  EXPECT_LT(moment, 0.1f * vsm);
}

// A blocker close to what it shades: exponentials let light through, the less the greater the exponent.
TEST_F(FilterableTest, SmallExponentsLeakNearContacts) {
  const Scene scene = lit_by(sun());
  const std::vector<float> fractions = lit_fraction(scene, compared());
  std::vector<double> leaks;
  for (const double exponent : {10.0, 30.0, 80.0}) {
    RenderPlan settings = filtered("esm");
    settings.shadow_exponent = exponent;
    const std::vector<float> bound = lit_fraction(scene, settings);
    double leak = 0.0, dark = 0.0;
    for (std::size_t i = 0; i < fractions.size(); ++i)
      if (fractions[i] == 0.0f) leak += bound[i], ++dark;
    leaks.push_back(leak / dark);
  }
  EXPECT_GT(leaks[0], 0.05);
  EXPECT_LT(leaks[1], 0.1 * leaks[0]);
  EXPECT_LT(leaks[2], leaks[1]);
}

TEST_F(FilterableTest, SixteenBitsAreNearlyAsGood) {
  const Scene scene = lit_by(spot());
  RenderPlan whole = filtered("moment"), half = whole;
  half.shadow_bits = 16;
  const double difference = distance(lit_fraction(scene, whole), lit_fraction(scene, half));
  EXPECT_GT(difference, 1e-6);
  EXPECT_LT(difference, 1e-3);
}

TEST_F(FilterableTest, TheUsualBiasLeavesNoAcne) {
  for (const auto& [light_name, scene] :
       {std::pair{"sun", lit_by(sun())}, {"spot", lit_by(spot())}, {"lamp", lit_by(lamp())}}) {
    const std::vector<float> truth = light(scene, shadow_settings("traced"));
    for (const std::string_view name : kFilterable) {
      SCOPED_TRACE(light_name + std::string(" ") + std::string(name));
      const std::vector<float> picture = light(scene, shadow_settings(name));
      std::size_t darker = 0;
      for (std::size_t i = 0; i < truth.size(); ++i) darker += picture[i] < 0.3f * truth[i];
      EXPECT_LT(darker, truth.size() / 100);
    }
  }
}

// Its own depths differ most within a filter, which no bound must take for a shadow.
TEST_F(FilterableTest, AFloorThatTheSunGrazesIsLit) {
  Scene scene = lit_by(sun({1.0, -0.15, 0.3}));
  scene.instances.resize(1); // the floor alone
  for (const std::string_view name : kFilterable) {
    SCOPED_TRACE(name);
    RenderPlan settings = shadow_settings(name, 128);
    settings.shadow_blur = 2.5;
    for (const float fraction : lit_fraction(scene, settings))
      ASSERT_GT(fraction, 0.95f); // rounding, and rims of the view
  }
}

} // namespace
} // namespace wavepath::test
