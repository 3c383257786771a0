// kernels/base/math.glsl on the device: trigonometry against double precision, warps against their densities, rounding
// by bits.
#include <bit>
#include <limits>
#include <numbers>

#include "tests/probe.h"
#include "tests/statistics.h"

#include "tests/probes/math_probe.spv.h"

namespace wavepath::test {
namespace {

constexpr double kPi = std::numbers::pi;

struct Element {
  glm::vec4 a{0.0f}, b{0.0f}, c{0.0f}, d{0.0f};
};

class MathTest : public VulkanTest {
protected:
  std::vector<Element> run(std::uint32_t mode, const std::vector<Element>& elements) {
    std::vector<ProbeBuffer> buffers{to_probe(std::vector<std::uint32_t>{mode}), to_probe(elements)};
    run_probe(device(), wavepath_math_probe_spv, std::uint32_t(elements.size()), buffers);
    return from_probe<Element>(buffers[1]);
  }
  float next() { return float((state_ = state_ * 6364136223846793005u + 1442695040888963407u) >> 40) * 0x1p-24f; }

private:
  std::uint64_t state_ = 1;
};

TEST_F(MathTest, SinesAndCosinesOfTurns) {
  std::vector<Element> in;
  for (int i = -(1 << 17); i <= 1 << 17; ++i)
    in.push_back({.a = {float(i) / float(1 << 15) + 1e-6f * next(), 0, 0, 0}});
  double worst = 0.0;
  for (const Element& e : run(0, in)) {
    const double angle = 2.0 * kPi * double(e.a.x);
    worst = std::max({worst, std::abs(e.b.x - std::cos(angle)), std::abs(e.b.y - std::sin(angle))});
  }
  EXPECT_LT(worst, 2e-7);
  const auto exact =
      run(0, {{.a = {0.0f, 0, 0, 0}}, {.a = {0.25f, 0, 0, 0}}, {.a = {0.5f, 0, 0, 0}}, {.a = {0.75f, 0, 0, 0}}});
  EXPECT_EQ(exact[0].b.x, 1.0f);
  EXPECT_EQ(exact[1].b.y, 1.0f);
  EXPECT_EQ(exact[2].b.x, -1.0f);
  EXPECT_EQ(exact[3].b.y, -1.0f);
}

TEST_F(MathTest, ArcTangentAndArcCosine) {
  std::vector<Element> in;
  for (int i = 0; i < 1 << 16; ++i) {
    const float scale = std::ldexp(1.0f, int(next() * 120.0f) - 60);
    in.push_back({.a = {(2.0f * next() - 1.0f) * scale, (2.0f * next() - 1.0f) * scale, 0, 0}});
  }
  double worst = 0.0;
  for (const Element& e : run(0, in))
    worst = std::max(worst, std::abs(e.b.z - std::atan2(double(e.a.y), double(e.a.x))));
  EXPECT_LT(worst, 4e-7);
  for (Element& e : in) e.a.x = 2.0f * next() - 1.0f;
  for (int k = 0; k < 64; ++k) in.push_back({.a = {1.0f - std::ldexp(1.0f, -k % 25), 0, 0, 0}});
  worst = 0.0;
  for (const Element& e : run(0, in)) worst = std::max(worst, std::abs(e.b.w - std::acos(double(e.a.x))));
  EXPECT_LT(worst, 5e-7);
  const auto corner = run(0, {{.a = {0, 0, 0, 0}}, {.a = {-1, 0, 0, 0}}, {.a = {1, 0, 0, 0}}, {.a = {0, -1, 0, 0}}});
  EXPECT_EQ(corner[0].b.z, 0.0f);
  EXPECT_NEAR(corner[1].b.z, kPi, 3e-7);
  EXPECT_EQ(corner[2].b.z, 0.0f);
  EXPECT_NEAR(corner[3].b.z, -kPi / 2, 3e-7);
  EXPECT_NEAR(corner[1].b.w, kPi, 3e-7);
  EXPECT_EQ(corner[2].b.w, 0.0f);
}

TEST_F(MathTest, FinitenessAndNeighboursByBits) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Element> in;
  for (const float x : {0.0f, -0.0f, 1.0f, -1.0f, 1.2e-38f, 3.4e38f, -3.4e38f, 0.1f, -12345.678f, inf, -inf, nan})
    in.push_back({.a = {x, 5.0f, 0, 0}});
  // Vulkan lets a device take and return denormal numbers as zero (the float controls properties of a device), which is
  // what the neighbours of zero are.
  const auto expect_neighbour = [](float found, float exact, float of) {
    const bool flushed = std::fpclassify(exact) == FP_SUBNORMAL && found == 0.0f;
    EXPECT_TRUE(found == exact || flushed) << found << " beside " << of;
  };
  const std::vector<Element> out = run(1, in);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const float x = in[i].a.x;
    const Element& e = out[i];
    EXPECT_EQ(e.b.x, std::isfinite(x) ? 1.0f : 0.0f) << x;
    if (!std::isfinite(x)) continue;
    expect_neighbour(e.b.y, std::nextafter(x, inf), x);
    expect_neighbour(e.b.z, std::nextafter(x, -inf), x);
    EXPECT_NEAR(e.b.w, 5 * 0x1p-24 / (1 - 5 * 0x1p-24), 1e-13);
  }
}

TEST_F(MathTest, BasesAreOrthonormalEverywhere) {
  std::vector<Element> in;
  const auto add = [&](glm::dvec3 n) {
    n = glm::normalize(n);
    in.push_back({.a = glm::vec4(n, 0.0), .d = {next(), next(), next(), 0}});
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0})
      for (const double tilt : {0.0, 1e-20, 1e-8, 1e-5, 1e-3}) {
        glm::dvec3 n(tilt, -tilt, tilt);
        n[axis] = sign;
        add(n);
      }
  for (int i = 0; i < 10000; ++i) add({2.0 * next() - 1.0, 2.0 * next() - 1.0, 2.0 * next() - 1.0});
  const auto out = run(3, in);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const glm::dvec3 n(out[i].a), t(out[i].b), b(out[i].c);
    ASSERT_NEAR(glm::dot(t, t), 1.0, 2e-6);
    ASSERT_NEAR(glm::dot(b, b), 1.0, 2e-6);
    ASSERT_NEAR(glm::dot(t, b), 0.0, 1e-6);
    ASSERT_NEAR(glm::dot(t, n), 0.0, 1e-6);
    ASSERT_NEAR(glm::dot(b, n), 0.0, 1e-6);
    ASSERT_NEAR(glm::dot(glm::cross(t, b), n), 1.0, 2e-6); // right-handed
    ASSERT_LT(glm::length(out[i].d - in[i].d), 1e-6f);     // there and back
  }
}

TEST_F(MathTest, NormalizesWhatHasADirection) {
  const auto out = run(5, {{.a = {3e30f, -4e30f, 0, 0}},
                           {.a = {0, 3e-30f, 4e-30f, 0}},
                           {.a = {0, 0, 0, 0}},
                           {.a = {std::numeric_limits<float>::infinity(), 0, 0, 0}}});
  EXPECT_LT(glm::length(glm::vec3(out[0].b) - glm::vec3(0.6f, -0.8f, 0.0f)), 1e-6f);
  EXPECT_LT(glm::length(glm::vec3(out[1].b) - glm::vec3(0.0f, 0.6f, 0.8f)), 1e-6f);
  EXPECT_EQ(glm::vec3(out[2].b), glm::vec3(0, 0, 1));
  EXPECT_EQ(glm::vec3(out[3].b), glm::vec3(0, 0, 1));
}

// The origin lies on w's side of the slab in which the surface may be, at any scale, and hardly further.
TEST_F(MathTest, RayOriginsLeaveTheErrorSlab) {
  std::vector<Element> in;
  for (int i = 0; i < 20000; ++i) {
    const float scale = std::ldexp(1.0f, int(next() * 40.0f) - 20);
    const glm::vec3 p = (glm::vec3(next(), next(), next()) - 0.5f) * scale;
    const glm::vec3 n = glm::normalize(glm::vec3(next(), next(), next()) - 0.5f);
    const glm::vec3 w = glm::normalize(glm::vec3(next(), next(), next()) - 0.5f);
    in.push_back({glm::vec4(p, 0), glm::vec4(glm::abs(p) * 4e-7f, 0), glm::vec4(n, 0), glm::vec4(w, 0)});
  }
  const auto out = run(4, in);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const glm::dvec3 p(in[i].a), error(in[i].b), n(in[i].c), w(in[i].d), q(out[i].a);
    const double slab = glm::dot(glm::abs(n), error), moved = glm::dot(q - p, n) * (glm::dot(w, n) < 0.0 ? -1.0 : 1.0);
    ASSERT_GE(moved, slab * (1.0 - 1e-6));
    ASSERT_LE(moved, slab + 4e-7 * glm::length(p));
  }
  const auto exact = run(4, {{.a = {1, 2, 3, 0}, .c = {0, 0, 1, 0}, .d = {0, 0, 1, 0}}});
  EXPECT_EQ(glm::vec3(exact[0].a), glm::vec3(1, 2, 3)); // no error, no step
}

// ---- warps ----------------------------------------------------------------------------------------------------------

class WarpTest : public MathTest {
protected:
  std::vector<Element> warp(float kind, int count) {
    std::vector<Element> in;
    for (int i = 0; i < count; ++i) in.push_back({.a = {next(), next(), kind, 0}});
    return run(2, in);
  }
  // Chi-square of positions in [0,1)^2 that should be uniform there: what the warp's own distribution functions make of
  // it.
  static void expect_uniform(const std::vector<glm::dvec2>& positions, const char* what) {
    constexpr int kBins = 32;
    std::vector<double> counts(kBins * kBins);
    for (const glm::dvec2& p : positions) {
      const int x = std::clamp(int(p.x * kBins), 0, kBins - 1), y = std::clamp(int(p.y * kBins), 0, kBins - 1);
      counts[std::size_t(y * kBins + x)] += 1.0;
    }
    EXPECT_GT(chi_square_uniform(counts).p_value, sidak(0.01, 5)) << what;
  }
  static double turns(const glm::vec4& v) { return std::atan2(double(v.y), double(v.x)) / (2.0 * kPi) + 0.5; }
};

TEST_F(WarpTest, FollowTheirDensities) {
  constexpr int kCount = 1 << 18;
  std::vector<glm::dvec2> disk, cosine, hemisphere, sphere, triangle;
  for (const Element& e : warp(0, kCount)) {
    disk.emplace_back(double(e.b.x) * e.b.x + double(e.b.y) * e.b.y, turns(e.b)); // radius^2 is uniform
    ASSERT_NEAR(e.b.w, 1.0 / kPi, 1e-6);
    ASSERT_LE(disk.back().x, 1.0 + 1e-6);
  }
  for (const Element& e : warp(1, kCount)) {
    cosine.emplace_back(double(e.b.z) * e.b.z, turns(e.b)); // cos^2 is uniform
    ASSERT_NEAR(glm::length(glm::vec3(e.b)), 1.0, 1e-6);
    ASSERT_NEAR(e.b.w, e.b.z / kPi, 1e-6);
    ASSERT_GT(e.b.z, 0.0f);
  }
  for (const Element& e : warp(2, kCount)) {
    hemisphere.emplace_back(double(e.b.z), turns(e.b));
    ASSERT_NEAR(glm::length(glm::vec3(e.b)), 1.0, 1e-6);
    ASSERT_NEAR(e.b.w, 0.5 / kPi, 1e-6);
    ASSERT_GT(e.b.z, 0.0f);
  }
  for (const Element& e : warp(3, kCount)) {
    sphere.emplace_back(0.5 + 0.5 * e.b.z, turns(e.b));
    ASSERT_NEAR(glm::length(glm::vec3(e.b)), 1.0, 1e-6);
    ASSERT_NEAR(e.b.w, 0.25 / kPi, 1e-6);
  }
  for (const Element& e :
       warp(4, kCount)) { // barycentric b1 has the distribution 1 - (1 - b1)^2, b2 / (1 - b1) is uniform
    ASSERT_TRUE(e.b.x >= 0.0f && e.b.y >= 0.0f && e.b.x + e.b.y <= 1.0f);
    triangle.emplace_back(1.0 - (1.0 - e.b.x) * (1.0 - e.b.x), e.b.y / std::max(1.0 - double(e.b.x), 1e-9));
    ASSERT_NEAR(e.b.w, 2.0, 1e-6);
  }
  expect_uniform(disk, "disk");
  expect_uniform(cosine, "cosine hemisphere");
  expect_uniform(hemisphere, "uniform hemisphere");
  expect_uniform(sphere, "sphere");
  expect_uniform(triangle, "triangle");
}

TEST_F(WarpTest, CosineMomentsAreThoseOfLambert) {
  Mean first, second;
  for (const Element& e : warp(1, 1 << 18)) first.add(e.b.z), second.add(double(e.b.z) * e.b.z);
  EXPECT_NEAR(first.mean(), 2.0 / 3.0, 4.0 * first.error());
  EXPECT_NEAR(second.mean(), 0.5, 4.0 * second.error());
}

TEST_F(WarpTest, CornersOfTheSquareAreFine) {
  std::vector<Element> in;
  for (const float x : {0.0f, 0x1p-24f, 0.5f, 1.0f - 0x1p-24f})
    for (const float y : {0.0f, 0x1p-24f, 0.5f, 1.0f - 0x1p-24f})
      for (const float kind : {0.0f, 1.0f, 2.0f, 3.0f, 4.0f}) in.push_back({.a = {x, y, kind, 0}});
  for (const Element& e : run(2, in)) {
    for (int k = 0; k < 4; ++k) ASSERT_TRUE(std::isfinite(e.b[k]));
    if (e.a.z == 1.0f || e.a.z == 2.0f) {
      EXPECT_GT(e.b.z, 0.0f);
      EXPECT_GT(e.b.w, 0.0f);
    }
  }
}

} // namespace
} // namespace wavepath::test
