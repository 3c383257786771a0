// Colours of black bodies, against published chromaticities and sums over wavelengths.
#include <cmath>

#include <gtest/gtest.h>

#include "host/scene/blackbody.h"
#include "host/scene/spectrum.h"

namespace wavepath {
namespace {

glm::dvec2 chromaticity(double kelvin) {
  const glm::dvec3 xyz = xyz_of(black_body(kelvin));
  return glm::dvec2(xyz) / (xyz.x + xyz.y + xyz.z);
}

double luminance(const glm::dvec3& rgb) { return glm::dot(rgb, glm::dvec3(0.2126729, 0.7151522, 0.0721750)); }

TEST(Blackbody, LiesOnThePlanckianLocus) {
  // CIE standard illuminant A, and points of the locus (Wyszecki and Stiles, Color Science, table 1(3.11)).
  const struct {
    double kelvin, x, y;
  } published[] = {{2856.0, 0.44757, 0.40745},
                   {6504.0, 0.31352, 0.32363},
                   {1000.0, 0.65275, 0.34446},
                   {4000.0, 0.38045, 0.37676},
                   {10000.0, 0.28063, 0.28829}};
  for (const auto& point : published) {
    const glm::dvec2 found = chromaticity(point.kelvin);
    EXPECT_NEAR(found.x, point.x, 3e-4) << point.kelvin;
    EXPECT_NEAR(found.y, point.y, 3e-4) << point.kelvin;
  }
}

TEST(Blackbody, HasAMaximumOfOneOverAllWavelengths) {
  // Its luminance is the mean of the scaled spectrum, by the weights of the eye. At 5200 K nearly all is near 1.
  EXPECT_NEAR(luminance(blackbody_color(5200.0)), 0.99, 0.01);
  EXPECT_LT(luminance(blackbody_color(1500.0)), 0.02);
  // Far above, the maximum lies beyond the visible: (T_peak / T)^4 for the tail of Rayleigh and Jeans, at most.
  EXPECT_LT(luminance(blackbody_color(100000.0)), 1e-3);
  const glm::dvec3 direct = light_color(black_body(3000.0)) / planck(2.897771955e6 / 3000.0, 3000.0);
  for (int i = 0; i < 3; ++i) EXPECT_DOUBLE_EQ(blackbody_color(3000.0)[i], direct[i]);
}

TEST(Blackbody, IsDarkAndRedBeforeItIsWhite) {
  for (const double kelvin : {-10.0, 0.0, 99.0, 100.0}) EXPECT_EQ(blackbody_color(kelvin), glm::dvec3(0.0));
  const glm::dvec3 red = blackbody_color(1000.0);
  EXPECT_GT(red.r, 0.0);
  EXPECT_EQ(red.b, 0.0) << "outside of the gamut";
  EXPECT_FALSE(std::isnan(blackbody_color(100.5).r));
  const glm::dvec3 blue = blackbody_color(20000.0);
  EXPECT_GT(blue.b, blue.r);
}

TEST(Blackbody, TableHasEqualRatios) {
  const std::vector<glm::vec4> table = blackbody_table(500.0f, 8000.0f, 5);
  ASSERT_EQ(table.size(), 5u);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const glm::vec3 expected(blackbody_color(500.0 * std::pow(2.0, static_cast<double>(i))));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(table[i][c], expected[c], 1e-6f * expected[c]);
  }
}

} // namespace
} // namespace wavepath
