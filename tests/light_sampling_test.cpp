// kernels/light/light_sampling.glsl on the device: which light, where on it, and how the environment is addressed and
// sampled.
#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>

#include "host/scene/pack/environment_light.h"
#include "tests/probe.h"
#include "tests/statistics.h"

#include "kernels/base/frame_types.h"
#include "kernels/base/scene_types.h"
#include "kernels/film/film_types.h"
#include "tests/probes/light_sampling_probe.spv.h"

namespace wavepath::test {
namespace {

constexpr double kPi = std::numbers::pi;

struct Element {
  glm::vec4 a{0.0f}, b{0.0f};
};

// Ends of intervals of the 32-bit integers with these probabilities; none of them is the last but the last.
std::vector<std::uint32_t> make_ends(const std::vector<double>& probability) {
  double sum = 0.0, total = 0.0;
  for (const double p : probability) total += p;
  std::vector<std::uint32_t> ends;
  for (const double p : probability) ends.push_back(std::uint32_t(std::min((sum += p) / total, 1.0) * 4294967295.0));
  return ends;
}

class LightSamplingTest : public VulkanTest {
protected:
  std::vector<Element> run(std::uint32_t mode, std::vector<Element> elements) {
    const Buffer frame_buffer = upload(device(), std::vector<gpu::Frame>{frame_});
    const Buffer light_buffer = upload(device(), lights_);
    const Buffer environment = upload(device(), environment_), ends = upload(device(), ends_);
    const Buffer element_buffer = upload(device(), elements);
    const std::vector<Binding> bindings{{gpu::kBindFrame, BindingKind::uniform, &frame_buffer},
                                        {gpu::kBindLights, BindingKind::texels_rgba32ui, &light_buffer},
                                        {gpu::kBindEnvironment, BindingKind::texels_rgba32f, &environment},
                                        {gpu::kBindEnvironmentEnds, BindingKind::texels_r32ui, &ends},
                                        {gpu::kBindFilm, BindingKind::storage, &element_buffer}};
    const gpu::Wave wave{.pixel_count = std::uint32_t(elements.size()), .bounce = mode};
    const BindingSet set(device(), bindings, sizeof wave);
    const Kernel kernel(device(), "light_sampling_probe", wavepath_light_sampling_probe_spv, set, {});
    Commands commands(device());
    commands.bind(set);
    commands.dispatch(kernel, (wave.pixel_count + gpu::kWorkgroupSize - 1) / gpu::kWorkgroupSize, &wave);
    commands.submit_and_wait();
    return download<Element>(element_buffer, elements.size());
  }

  // A map with these weights a texel, normalized to probabilities.
  void set_map(std::uint32_t width, std::uint32_t height, std::vector<double> weights) {
    frame_.environment_width = width;
    frame_.environment_height = height;
    double sum = 0.0;
    for (const double w : weights) sum += w;
    environment_.clear();
    for (double& w : weights) environment_.emplace_back(1.0f, 1.0f, 1.0f, w /= sum);
    ends_ = environment_intervals(weights, width, height);
  }
  void rotate(double degrees) {
    frame_.environment_rotation = {std::cos(degrees * kPi / 180.0), std::sin(degrees * kPi / 180.0)};
  }
  float next() { return float((state_ = state_ * 6364136223846793005u + 1442695040888963407u) >> 40) * 0x1p-24f; }

  void SetUp() override {
    VulkanTest::SetUp();
    rotate(0.0);
    set_map(1, 1, {1.0});
    lights_.resize(1);
  }

  gpu::Frame frame_{};
  std::vector<gpu::Light> lights_;
  std::vector<glm::vec4> environment_;
  std::vector<std::uint32_t> ends_;

private:
  std::uint64_t state_ = 1;
};

// The centre of the image looks along +X, three quarters across +Z, one quarter -Z, the top row +Y; a positive rotation
// turns the map counter-clockwise seen from above, so that its centre goes from +X towards -Z.
TEST_F(LightSamplingTest, EnvironmentIsAddressedAsDocumented) {
  const auto uv = [&](const glm::vec3& d) { return run(0, {{.a = glm::vec4(d, 0)}})[0].b; };
  EXPECT_NEAR(uv({1, 0, 0}).x, 0.5, 1e-6);
  EXPECT_NEAR(uv({1, 0, 0}).y, 0.5, 1e-6);
  EXPECT_NEAR(uv({0, 0, 1}).x, 0.75, 1e-6);
  EXPECT_NEAR(uv({0, 0, -1}).x, 0.25, 1e-6);
  EXPECT_NEAR(uv({0, 1, 0}).y, 0.0, 1e-6);
  EXPECT_NEAR(uv({0, -1, 0}).y, 1.0, 1e-6);
  EXPECT_LT(uv({0, -1, 0}).y, 1.0f);
  EXPECT_LT(uv({-1, 0, 0}).x, 1.0f);
  rotate(90.0);
  EXPECT_NEAR(uv({0, 0, -1}).x, 0.5, 1e-6);
  rotate(37.0);
  std::vector<Element> in;
  for (int i = 0; i < 10000; ++i)
    in.push_back({.a = glm::vec4(glm::normalize(glm::vec3(next(), next(), next()) - 0.5f), 0)});
  for (const Element& e : run(0, in)) ASSERT_LT(e.b.z, 3e-6f);
}

TEST_F(LightSamplingTest, TexelsTileTheSphereAndDirectionsStayInside) {
  for (const auto& [width, height] : {std::pair{8u, 4u}, std::pair{7u, 5u}, std::pair{8192u, 4096u}}) {
    frame_.environment_width = width;
    frame_.environment_height = height;
    double total = 0.0;
    std::vector<Element> in;
    for (std::uint32_t row = 0; row < height; ++row)
      for (const float t : {0.0f, 0.3f, 0.5f, 1.0f - 0x1p-24f})
        in.push_back({.a = {float(row % width), float(row), next(), t}});
    const auto out = run(3, in);
    for (std::size_t i = 0; i < in.size(); ++i) {
      const glm::dvec3 d(out[i].b);
      if (i % 4 == 0) total += double(out[i].b.w) * width;
      ASSERT_NEAR(glm::length(d), 1.0, 1e-6);
      const double v = std::atan2(std::hypot(d.x, d.z), d.y) / kPi * height,
                   u = std::atan2(d.z, d.x) / (2.0 * kPi) + 0.5;
      ASSERT_NEAR(v, in[i].a.y + 0.5, 0.5 + 2e-7 * height) << "row " << in[i].a.y << " of " << height;
      if (std::hypot(d.x, d.z) > 0.0) {
        ASSERT_NEAR(u * width, in[i].a.x + in[i].a.z, 1e-6 * width);
      }
      const double a = kPi * in[i].a.y / height, b = kPi * (in[i].a.y + 1.0) / height;
      const double exact = 2.0 * kPi / width * 2.0 * std::sin(0.5 * (a + b)) * std::sin(0.5 * (b - a));
      ASSERT_NEAR(out[i].b.w, exact, 1e-6 * exact);
    }
    EXPECT_NEAR(total, 4.0 * kPi, 1e-5);
  }
}

TEST_F(LightSamplingTest, EnvironmentSamplesFollowTheMap) {
  constexpr std::uint32_t kWidth = 24, kHeight = 13;
  std::vector<double> weights;
  for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) weights.push_back(i % 7 == 0 ? 0.0 : 0.1 + next());
  weights[100] = 300.0; // a sun
  set_map(kWidth, kHeight, weights);
  rotate(123.0);
  std::vector<Element> in(1 << 19);
  for (Element& e : in) e.a = {next(), next(), 0, 0};
  std::vector<double> counts(weights.size()), expected;
  Mean solid_angle;
  std::size_t strays = 0;
  for (const Element& e : run(1, in)) {
    const std::size_t texel = std::size_t(e.b.y) * kWidth + std::size_t(e.b.x);
    counts[texel] += 1.0;
    solid_angle.add(1.0 / e.a.w);
    strays += e.b.x != e.b.z || e.b.y != e.b.w; // rounding at a border
    ASSERT_GT(environment_[texel].w, 0.0f);
  }
  double lit = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    expected.push_back(environment_[i].w * double(in.size()));
    const double row = double(i / kWidth);
    if (weights[i] > 0.0)
      lit += 2.0 * kPi / kWidth * (std::cos(kPi * row / kHeight) - std::cos(kPi * (row + 1) / kHeight));
  }
  EXPECT_GT(chi_square(counts, expected).p_value, 0.01);
  EXPECT_NEAR(solid_angle.mean(), lit, 4.0 * solid_angle.error()); // E[1/pdf] = the solid angle that can be sampled
  EXPECT_LT(strays, in.size() / 10000);
}

// The entry that u picks, by a search without cuts.
std::uint32_t pick(std::span<const std::uint32_t> ends, std::uint32_t u) {
  return std::uint32_t(std::ranges::upper_bound(ends, u) - ends.begin());
}

// Whatever the shape of the map: the texel that such a search finds, also at the ends of intervals; the density
// of that very texel, however dim its neighbours; and the radiance that its direction has.
TEST_F(LightSamplingTest, EnvironmentSamplesAreThoseOfAPlainSearch) {
  const auto dim = [&] { return 1e-9 + 1e-6 * next(); };
  struct Map {
    std::uint32_t width, height, bright, black_row;
  };
  for (const Map& map : {Map{1, 1, 0, 9}, Map{1, 37, 36, 3}, Map{9, 1, 8, 9}, Map{24, 13, 100, 12}, Map{64, 32, 700, 0},
                         Map{1000, 3, 1999, 2}, Map{70001, 2, 70000, 9}}) {
    SCOPED_TRACE(map.width);
    std::vector<double> weights(std::size_t{map.width} * map.height);
    for (std::size_t i = 0; i < weights.size(); ++i)
      weights[i] = i / map.width == map.black_row || i % 7 == 3 ? 0.0 : i % 5 == 0 ? 1.0 : dim();
    weights[map.bright] = 50.0;
    set_map(map.width, map.height, weights);
    for (glm::vec4& texel : environment_) texel.x = next();
    rotate(55.0);
    const auto rows = std::span<const std::uint32_t>(ends_).first(map.height);
    const auto columns = [&](std::size_t y) {
      return std::span<const std::uint32_t>(ends_).subspan(map.height + y * map.width, map.width);
    };

    std::vector<glm::uvec2> picks;
    const auto at_borders = [&](std::span<const std::uint32_t> ends, auto&& make) {
      const std::size_t step = std::max<std::size_t>(ends.size() / 500, 1);
      for (std::size_t i = 0; i < ends.size(); i += step)
        for (const std::uint32_t u : {ends[i] - 1, ends[i]}) picks.push_back(make(std::min(u, 0xfffffffeu)));
      for (std::uint64_t u = 0; u < std::uint64_t{1} << 32; u += 1u << 23) // of cuts
        for (const std::uint32_t border : {std::uint32_t(u), std::uint32_t(u) - 1})
          picks.push_back(make(std::min(border, 0xfffffffeu)));
    };
    at_borders(rows, [&](std::uint32_t u) { return glm::uvec2(std::uint32_t(next() * 0x1p32), u); });
    for (const std::size_t y : {pick(rows, 0), map.bright / map.width})
      at_borders(columns(y), [&](std::uint32_t u) { return glm::uvec2(u, y > 0 ? rows[y - 1] : 0); });
    std::vector<Element> in;
    for (const glm::uvec2& u : picks) in.push_back({.a = {std::bit_cast<float>(u.x), std::bit_cast<float>(u.y), 0, 0}});
    const std::vector<Element> out = run(8, in);
    for (std::size_t i = 0; i < picks.size(); ++i) {
      const std::uint32_t y = pick(rows, picks[i].y), x = pick(columns(y), picks[i].x);
      ASSERT_EQ(glm::vec2(out[i].b), glm::vec2(x, y)) << picks[i].x << " " << picks[i].y;
      const double top = kPi * y / map.height, bottom = kPi * (y + 1.0) / map.height;
      const double solid_angle =
          4.0 * kPi / map.width * std::sin(0.5 * (top + bottom)) * std::sin(0.5 * (bottom - top));
      const double density = environment_[std::size_t{y} * map.width + x].w / solid_angle;
      ASSERT_NEAR(out[i].a.y, density, 1e-5 * density);
      // Rounding, in texels, of what changes by 1 a texel at most; a direction to a pole does not know its column.
      if (out[i].b.w > 0.0f) {
        ASSERT_NEAR(out[i].a.x, out[i].b.z, 2e-6 * (map.width + map.height));
      }
    }
  }
}

TEST_F(LightSamplingTest, EnvironmentDensityIntegratesToOne) {
  constexpr std::uint32_t kWidth = 16, kHeight = 9;
  std::vector<double> weights;
  for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) weights.push_back(next());
  set_map(kWidth, kHeight, weights);
  rotate(-40.0);
  std::vector<Element> in;
  constexpr int kRows = 4096, kColumns = 64; // uniform in (height, azimuth): equal solid angles
  for (int i = 0; i < kRows; ++i)
    for (int k = 0; k < kColumns; ++k) {
      const double y = 1.0 - 2.0 * (i + 0.5) / kRows, phi = 2.0 * kPi * (k + 0.5) / kColumns,
                   r = std::sqrt(1.0 - y * y);
      in.push_back({.a = {r * std::cos(phi), y, r * std::sin(phi), 0}});
    }
  double sum = 0.0;
  for (const Element& e : run(0, in)) sum += e.b.w;
  EXPECT_NEAR(sum * 4.0 * kPi / double(in.size()), 1.0, 1e-3);
}

TEST_F(LightSamplingTest, LightsArePickedByTheirProbability) {
  const std::vector<double> probability{0.5, 0.001, 0.0, 0.199, 0.3};
  const std::vector<std::uint32_t> ends = make_ends(probability);
  lights_.assign(probability.size(), {});
  for (std::size_t i = 0; i < probability.size(); ++i) lights_[i].end = ends[i];
  frame_.light_count = std::uint32_t(lights_.size());
  std::vector<Element> in;
  for (std::uint32_t i = 0; i < 1u << 20; ++i) { // Hammersley points: counts err by about log(n) / n
    float radical_inverse = 0.0f;
    for (int bit = 0; bit < 20; ++bit) radical_inverse += float(i >> bit & 1u) * std::ldexp(1.0f, -1 - bit);
    in.push_back({.a = {(float(i) + 0.5f) * 0x1p-20f, radical_inverse, 0, 0}});
  }
  in.front().a = {0, 0, 0, 0};
  in.back().a = {1.0f - 0x1p-24f, 1.0f - 0x1p-24f, 0, 0};
  std::vector<double> counts(probability.size()), rest(16);
  for (const Element& e : run(2, in)) {
    counts.at(std::size_t(e.b.x)) += 1.0;
    ASSERT_TRUE(e.b.y >= 0.0f && e.b.y < 1.0f) << e.b.y;
    rest.at(std::size_t(e.b.y * 16.0f)) += 1.0;
  }
  for (std::size_t i = 0; i < probability.size(); ++i) EXPECT_NEAR(counts[i] / double(in.size()), probability[i], 3e-5);
  for (const double n : rest)
    EXPECT_NEAR(n / double(in.size()), 1.0 / 16.0, 1e-3); // what is left of u.x is uniform again
}

// Of points that picked the same, what is left is as even as it was: it keeps its order and its full width.
TEST_F(LightSamplingTest, WhatIsLeftOfAPickIsExact) {
  std::vector<Element> in;
  const auto add = [&](std::uint32_t offset, std::uint32_t width) {
    in.push_back({.a = {std::bit_cast<float>(offset), std::bit_cast<float>(width), 0, 0}});
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs = {{0, 1},
                                                                {0, 5},
                                                                {4, 5},
                                                                {1, 3},
                                                                {2, 3},
                                                                {0, 0xffffffff},
                                                                {0xfffffffe, 0xffffffff},
                                                                {0x7fffffff, 0x80000001},
                                                                {123456789, 123456790},
                                                                {1, 0xffffffff}};
  for (int i = 0; i < 20000; ++i) {
    const std::uint32_t width = std::uint32_t(std::exp2(32.0 * double(next()))) | 1u;
    pairs.emplace_back(std::uint32_t(double(next()) * width), width);
  }
  for (const auto& [offset, width] : pairs) add(offset, width);
  const std::vector<Element> out = run(6, in);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double exact = std::floor(double(pairs[i].first) * 4294967296.0 / pairs[i].second);
    ASSERT_NEAR(double(std::bit_cast<std::uint32_t>(out[i].b.x)), exact, 2.0)
        << pairs[i].first << " " << pairs[i].second;
  }
}

// Parts of a triangle: a point of a part lies in one of its cells, whatever its size, and all cells are met.
TEST_F(LightSamplingTest, PartsOfATriangleTileIt) {
  const auto to_bits = [](std::uint32_t word) { return std::bit_cast<float>(word); };
  for (const std::uint32_t depth : {1u, 3u, 6u, 12u})
    for (std::uint32_t level = depth > 6 ? 10 : 0; level <= depth; ++level) {
      std::vector<Element> in;
      const std::uint32_t parts = std::min(1u << 2 * level, 4096u), cells = 1u << 2 * (depth - level);
      const std::uint32_t stride = (1u << 2 * level) / parts;
      for (std::uint32_t part = 0; part < parts; ++part)
        in.push_back({.a = {to_bits(depth), to_bits((part * stride + part % stride) * cells), to_bits(cells), 0},
                      .b = {0.05f + 0.4f * next(), 0.05f + 0.4f * next(), 0, 0}});
      const std::vector<Element> out = run(7, in);
      for (std::size_t i = 0; i < in.size(); ++i) {
        EXPECT_TRUE(out[i].b.x >= 0.0f && out[i].b.y >= 0.0f && out[i].b.x + out[i].b.y <= 1.0f);
        ASSERT_EQ(std::bit_cast<std::uint32_t>(out[i].b.z) / cells, std::bit_cast<std::uint32_t>(in[i].a.y) / cells);
      }
    }
}

// The corners of quarters are where the host has them (quarter_of() in host/scene/pack/emission.cpp).
TEST_F(LightSamplingTest, QuartersOfATriangleStandAtItsCorners) {
  const auto to_bits = [](std::uint32_t word) { return std::bit_cast<float>(word); };
  std::vector<Element> in;
  for (std::uint32_t quarter = 0; quarter < 4; ++quarter)
    for (const glm::vec2& corner : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(0, 1)})
      in.push_back({.a = {to_bits(1), to_bits(quarter), to_bits(1), 0}, .b = {corner.x, corner.y, 0, 0}});
  const glm::vec2 expected[] = {{0, 0},    {0.5f, 0},    {0, 0.5f}, {0.5f, 0},    {1, 0},    {0.5f, 0.5f},
                                {0, 0.5f}, {0.5f, 0.5f}, {0, 1},    {0.5f, 0.5f}, {0, 0.5f}, {0.5f, 0}};
  const std::vector<Element> out = run(7, in);
  for (std::size_t i = 0; i < out.size(); ++i) EXPECT_EQ(glm::vec2(out[i].b), expected[i]) << i;
}

TEST_F(LightSamplingTest, PunctualLightsFollowTheirLaws) {
  const double inner = 0.3, outer = 0.6, scale = 1.0 / (std::cos(inner) - std::cos(outer));
  gpu::Light spot{};
  spot.kind = gpu::kLightSpot;
  spot.position = {0, 2, 0};
  spot.direction = {0, -1, 0};
  spot.intensity = {8, 4, 2};
  spot.spot_scale = float(scale);
  spot.spot_offset = float(-std::cos(outer) * scale);
  gpu::Light point = spot, sun = spot;
  point.kind = gpu::kLightPoint;
  sun.kind = gpu::kLightDirectional;
  sun.direction = {0, 1, 0};
  lights_ = {point, spot, sun};
  const auto at = [&](double angle, float light) { // below the light, `angle` off its axis, at distance 2
    return Element{.a = {2.0 * std::sin(angle), 2.0 - 2.0 * std::cos(angle), 0.0, light}};
  };
  const auto out =
      run(4, {at(0.0, 0), at(1.0, 0), at(0.2, 1), at(0.45, 1), at(0.7, 1), at(0.3, 2), {.a = {0, 2, 0, 0}}});
  EXPECT_NEAR(out[0].a.x, 2.0, 1e-5); // I / d^2
  EXPECT_NEAR(out[0].a.z, 0.5, 1e-5);
  EXPECT_NEAR(out[1].a.x, 2.0, 1e-5);
  EXPECT_LT(glm::length(glm::vec3(out[0].b) - glm::vec3(0, 2, 0)), 1e-6f);
  EXPECT_NEAR(out[2].a.x, 2.0, 1e-5);
  const double falloff = (std::cos(0.45) - std::cos(outer)) * scale;
  EXPECT_NEAR(out[3].a.x, 2.0 * falloff * falloff, 1e-5);
  EXPECT_EQ(out[4].a.x, 0.0f);
  EXPECT_EQ(glm::vec3(out[5].a), glm::vec3(8, 4, 2));
  EXPECT_EQ(glm::vec3(out[5].b), glm::vec3(0, 1, 0));
  EXPECT_EQ(glm::vec3(out[6].a), glm::vec3(0)); // at the light itself
}

TEST_F(LightSamplingTest, AreaDensitiesBecomeSolidAngleDensities) {
  const auto out =
      run(5, {{{0, 0, 3, 0.5f}, {0, 0, -1, 0}}, {{0, 3, 3, 0.5f}, {0, 0, 1, 0}}, {{3, 0, 0, 0.5f}, {0, 0, 1, 0}}});
  EXPECT_NEAR(out[0].b.w, 4.5, 1e-5);
  EXPECT_NEAR(out[1].b.w, 0.5 * 18.0 * std::sqrt(2.0), 1e-4);
  EXPECT_EQ(out[2].b.w, 0.0f); // edge on
}

} // namespace
} // namespace wavepath::test
