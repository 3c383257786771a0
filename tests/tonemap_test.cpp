// Tone curves: published values, range, order and bad input.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "host/picture/tonemap.h"

namespace wavepath {
namespace {

using glm::vec3;

constexpr Tonemap kAll[] = {Tonemap::none, Tonemap::aces, Tonemap::agx, Tonemap::neutral};

float grey(Tonemap curve, float value) { return tonemap(curve, vec3(value)).g; }

TEST(Tonemap, StaysInRange) {
  for (const Tonemap curve : kAll)
    for (int r = -20; r <= 40; r += 5)
      for (int g = -20; g <= 40; g += 5) {
        const vec3 c = tonemap(curve, vec3(std::exp2(r), std::exp2(g), 0.18f));
        for (int i = 0; i < 3; ++i)
          EXPECT_TRUE(c[i] >= 0.0f && c[i] <= 1.0f) << static_cast<int>(curve) << " " << r << " " << g;
      }
}

TEST(Tonemap, BrighterGreyNeverComesOutDarker) {
  for (const Tonemap curve : kAll) {
    float last = 0.0f;
    for (float stops = -20.0f; stops < 20.0f; stops += 0.01f) {
      const float value = grey(curve, std::exp2(stops));
      EXPECT_GE(value, last - 1e-6f) << static_cast<int>(curve) << " at " << stops;
      last = value;
    }
    EXPECT_GT(last, 0.97f) << static_cast<int>(curve);
    EXPECT_LT(grey(curve, 1e-6f), 1e-3f);
  }
}

TEST(Tonemap, BadValuesAreBlackOrWhite) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const Tonemap curve : kAll) {
    const vec3 black = tonemap(curve, vec3(0.0f));
    EXPECT_EQ(tonemap(curve, vec3(nan)), black);
    EXPECT_EQ(tonemap(curve, vec3(-1.0f, -inf, nan)), black);
    EXPECT_GT(tonemap(curve, vec3(inf)).r, 0.97f);
  }
}

TEST(Tonemap, NoneClamps) { EXPECT_EQ(tonemap(Tonemap::none, vec3(0.25f, 1.0f, 3.0f)), vec3(0.25f, 1.0f, 1.0f)); }

// By hand: above 0.08 the offset is 0.04; 0.8 reaches the start of compression; 1.0 becomes 1 - 0.24^2 / (0.96 + 0.24 -
// 0.76).
TEST(Tonemap, NeutralKeepsBaseColours) {
  EXPECT_NEAR(grey(Tonemap::neutral, 0.5f), 0.46f, 1e-6f);
  EXPECT_NEAR(grey(Tonemap::neutral, 0.8f), 0.76f, 1e-6f);
  EXPECT_NEAR(grey(Tonemap::neutral, 1.0f), 0.869090909f, 1e-6f);
  EXPECT_NEAR(grey(Tonemap::neutral, 0.04f), 6.25f * 0.04f * 0.04f, 1e-6f);
  const vec3 color = tonemap(Tonemap::neutral, vec3(0.7f, 0.3f, 0.2f));
  EXPECT_NEAR(color.r, 0.66f, 1e-6f);
  EXPECT_NEAR(color.g, 0.26f, 1e-6f);
  EXPECT_NEAR(color.b, 0.16f, 1e-6f);
}

// A saturated light of 10: peak 9.96 or so compresses to 1 - 0.0576 / 9.48 and 58 % of it fades to white.
TEST(Tonemap, NeutralFadesToWhite) {
  const double peak = 10.0, new_peak = 1.0 - 0.0576 / (peak + 0.24 - 0.76),
               g = 1.0 - 1.0 / (0.15 * (peak - new_peak) + 1.0);
  const vec3 color = tonemap(Tonemap::neutral, vec3(10.0f, 0.0f, 0.0f)); // black channels take no offset
  EXPECT_NEAR(color.r, new_peak, 1e-5);
  EXPECT_NEAR(color.g, new_peak * g, 1e-5);
  EXPECT_NEAR(color.b, new_peak * g, 1e-5);
}

// The matrices' rows sum to one, so grey passes through the rational curve alone.
TEST(Tonemap, AcesOfGrey) {
  for (const double x : {0.01, 0.18, 1.0, 4.0, 16.0}) {
    const double y = (x * (x + 0.0245786) - 0.000090537) / (x * (0.983729 * x + 0.4329510) + 0.238081);
    EXPECT_NEAR(grey(Tonemap::aces, static_cast<float>(x)), std::min(y, 1.0), 2e-5);
  }
  EXPECT_NEAR(grey(Tonemap::aces, 0.18f), 0.1056, 1e-3);
  const vec3 red = tonemap(Tonemap::aces, vec3(1.0f, 0.0f, 0.0f));
  EXPECT_GT(red.r, 4.0f * red.g);
}

// ---- AgX
//
// Sobotka's AgX in double precision, twice: with the matrix and the polynomial of Wrensch's "Minimal AgX
// Implementation", which is what is shipped, and from the definitions that these were fitted to.

// Light of sRGB's primaries, moved by 20 % towards the white point D65, in sRGB.
glm::dmat3 inset_of_primaries() {
  const glm::dvec2 white(0.3127, 0.3290), primaries[] = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}};
  const auto xyz = [](glm::dvec2 c) { return glm::dvec3(c.x, c.y, 1.0 - c.x - c.y) / c.y; };
  const auto xyz_from_rgb = [&](double moved) {
    glm::dmat3 columns;
    for (int i = 0; i < 3; ++i) columns[i] = xyz(glm::mix(primaries[i], white, moved));
    const glm::dvec3 scale = glm::inverse(columns) * xyz(white);
    for (int i = 0; i < 3; ++i) columns[i] *= scale[i];
    return columns;
  };
  return glm::inverse(xyz_from_rgb(0.0)) * xyz_from_rgb(0.2);
}

glm::dmat3 published_inset() {                                                                // by rows
  return glm::transpose(glm::dmat3(0.842479062253094, 0.0784335999999992, 0.0792237451477643, //
                                   0.0423282422610123, 0.878468636469772, 0.0791661274605434, //
                                   0.0423756549057051, 0.0784336, 0.879142973793104));
}

// The hyperbolic sigmoid of the log-encoded signal: slope 2 at the pivot, which is middle grey at one half; powers 3
// below and 3.25 above.
double sigmoid(double x) {
  const double pivot = 10.0 / 16.5, slope = 2.0;
  const bool above = x >= pivot;
  const double power = above ? 3.25 : 3.0, length = above ? 1.0 - pivot : pivot; // to the end of the curve
  const double steep = std::pow(slope * length / 0.5, power) - 1.0;
  const double scale = slope * length / std::pow(steep, 1.0 / power), t = slope * std::abs(x - pivot) / scale;
  const double rise = scale * t / std::pow(1.0 + std::pow(t, power), 1.0 / power);
  return above ? 0.5 + rise : 0.5 - rise;
}

double published_polynomial(double x) {
  return -0.00232 + x * (0.1191 + x * (0.4298 + x * (-6.868 + x * (31.96 + x * (-40.14 + x * 15.5)))));
}

// The display signal; the picture is its power of 2.2.
template <class Curve>
glm::dvec3 agx_signal(const glm::dmat3& inset, Curve curve, glm::dvec3 radiance) {
  glm::dvec3 c = inset * radiance;
  for (int i = 0; i < 3; ++i) c[i] = curve(std::clamp((std::log2(c[i] / 0.18) + 10.0) / 16.5, 0.0, 1.0));
  return glm::clamp(glm::inverse(inset) * c, 0.0, 1.0);
}

std::vector<glm::dvec3> agx_samples() { // greys, saturated colors and mixtures, over more than the 16.5 stops
  std::vector<glm::dvec3> colors;
  for (double stops = -14.0; stops <= 6.0; stops += 0.25)
    for (const glm::dvec3 hue : {glm::dvec3(1, 1, 1), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1),
                                 glm::dvec3(1, 0.5, 0.1), glm::dvec3(0.2, 0.3, 0.9)})
      colors.push_back(glm::dvec3(glm::vec3(hue * std::exp2(stops)))); // as the float picture holds it
  return colors;
}

TEST(Tonemap, AgxIsThePublishedFit) {
  for (const glm::dvec3 color : agx_samples()) {
    const vec3 found = tonemap(Tonemap::agx, vec3(color));
    const glm::dvec3 expected = glm::pow(agx_signal(published_inset(), published_polynomial, color), glm::dvec3(2.2));
    for (int i = 0; i < 3; ++i)
      ASSERT_NEAR(found[i], expected[i], 2e-5) << color.r << ", " << color.g << ", " << color.b;
  }
}

// The polynomial follows the sigmoid to 0.0058, at its worst near 0.95; the matrix that undoes the inset magnifies that
// by up to 1.4.
TEST(Tonemap, AgxFollowsItsDefinition) {
  double squares = 0.0;
  std::size_t greys = 0;
  for (const glm::dvec3 color : agx_samples()) {
    const vec3 found = tonemap(Tonemap::agx, vec3(color));
    const glm::dvec3 expected = agx_signal(inset_of_primaries(), sigmoid, color);
    for (int i = 0; i < 3; ++i)
      ASSERT_NEAR(std::pow(found[i], 1.0 / 2.2), expected[i], 0.0081) << color.r << ", " << color.g << ", " << color.b;
    if (color.r != color.b) continue;
    squares += std::pow(std::pow(found.g, 1.0 / 2.2) - expected.g, 2), ++greys;
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(greys)), 0.003);
}

// The pivot of AgX's sigmoid puts middle grey at half of the display signal, and saturated lights lose their colour.
TEST(Tonemap, AgxPivotsAtMiddleGrey) {
  EXPECT_NEAR(grey(Tonemap::agx, 0.18f), std::pow(0.5, 2.2), 0.005);
  const vec3 dim = tonemap(Tonemap::agx, vec3(0.2f, 0.01f, 0.01f)),
             bright = tonemap(Tonemap::agx, vec3(200.0f, 10.0f, 10.0f));
  EXPECT_LT(bright.r / bright.g, dim.r / dim.g);
  EXPECT_GT(bright.r, 0.9f);
}

TEST(Srgb, KnownValuesAndInverse) {
  EXPECT_NEAR(to_srgb(0.5f), 0.735357f, 1e-5f);
  EXPECT_NEAR(to_srgb(0.001f), 0.01292f, 1e-6f);
  EXPECT_NEAR(from_srgb(0.5f), 0.214041f, 1e-5f);
  for (int i = 0; i <= 1000; ++i)
    EXPECT_NEAR(from_srgb(to_srgb(static_cast<float>(i) / 1000.0f)), static_cast<float>(i) / 1000.0f, 2e-6f);
}

} // namespace
} // namespace wavepath
