#include "host/scene/lat_long.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wavepath {
namespace {

// To 12 bits, ties away from zero.
float rounded(double value) {
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  return static_cast<float>(std::ldexp(std::round(std::ldexp(mantissa, 12)), exponent - 12));
}

} // namespace

double texel_solid_angle(std::size_t y, std::size_t width, std::size_t height) {
  const auto polar = [&](std::size_t row) {
    return std::cos(std::numbers::pi * static_cast<double>(row) / static_cast<double>(height));
  };
  return 2.0 * std::numbers::pi / static_cast<double>(width) * (polar(y) - polar(y + 1));
}

glm::dvec3 floor_irradiance(const Environment& environment) {
  const glm::dvec3 scale(environment.radiance);
  if (environment.map.empty()) return std::numbers::pi * scale;
  const std::size_t width = environment.width, height = environment.height;
  glm::dvec3 sum(0.0);
  for (std::size_t y = 0; y < (height + 1) / 2; ++y) {
    // Of a row, the integral of the cosine is half the difference of the squared sines of its edges.
    const double upper = std::numbers::pi * static_cast<double>(y) / static_cast<double>(height),
                 lower = std::min(std::numbers::pi * static_cast<double>(y + 1) / static_cast<double>(height),
                                  0.5 * std::numbers::pi);
    const double cosines = std::numbers::pi / static_cast<double>(width) *
                           (std::sin(lower) * std::sin(lower) - std::sin(upper) * std::sin(upper));
    glm::dvec3 row(0.0);
    for (std::size_t x = 0; x < width; ++x) row += glm::dvec3(environment.map[y * width + x]);
    sum += cosines * row;
  }
  return scale * sum;
}

void expose_for_white_floor(Environment& environment) {
  const glm::dvec3 irradiance = floor_irradiance(environment) / glm::dvec3(environment.radiance);
  const double luminance = 0.2126 * irradiance.x + 0.7152 * irradiance.y + 0.0722 * irradiance.z;
  for (glm::vec3& texel : environment.map)
    for (int c = 0; c < 3; ++c) texel[c] = rounded(std::numbers::pi / luminance * static_cast<double>(texel[c]));
}

glm::dvec2 environment_uv(const glm::dvec3& d, double rotation) {
  const double c = std::cos(rotation), s = std::sin(rotation);
  const double x = c * d.x - s * d.z, z = s * d.x + c * d.z;
  // atan2 rather than acos: exact towards the poles.
  return {std::atan2(z, x) / (2.0 * std::numbers::pi) + 0.5, std::atan2(std::hypot(x, z), d.y) / std::numbers::pi};
}

glm::dvec3 environment_direction(const glm::dvec2& uv, double rotation) {
  const double phi = (uv.x - 0.5) * 2.0 * std::numbers::pi, theta = uv.y * std::numbers::pi;
  const double x = std::sin(theta) * std::cos(phi), z = std::sin(theta) * std::sin(phi);
  const double c = std::cos(rotation), s = std::sin(rotation);
  return {c * x + s * z, std::cos(theta), -s * x + c * z};
}

} // namespace wavepath
