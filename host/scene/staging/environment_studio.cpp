// Draws the lamps of the studio into a lat-long map; see environment_studio.h.
#include "host/scene/staging/environment_studio.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <tbb/parallel_for.h>

#include "host/scene/lat_long.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kStudioWidth = 512,
                        kStudioHeight = 256; // 0.7 degrees a texel; the edges of the boxes are 3 wide

// A lamp with a rectangular face that is square to the line of sight from the subject.
struct SoftBox {
  double azimuth, elevation;      // of its middle, degrees; azimuth from +Z (the front) towards +X (the right)
  double half_width, half_height; // degrees
  double radiance;                // in its middle; two thirds of that at the edges
};

// In units of the white floor's radiance, but for a common factor.
constexpr SoftBox kBoxes[] = {
    {-48.0, 42.0, 24.0, 20.0, 11.0}, // key
    {68.0, 22.0, 26.0, 24.0, 1.6},   // fill
    {0.0, 84.0, 34.0, 20.0, 2.5},    // overhead
    {-112.0, 28.0, 5.0, 30.0, 8.0},  // edge, left
    {128.0, 34.0, 5.0, 30.0, 8.0},   // edge, right
};
constexpr double kSoftEdge = 2.0; // degrees over which a box begins

double smooth_step(double lo, double hi, double x) {
  const double t = std::clamp((x - lo) / (hi - lo), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

glm::dvec3 direction_of(double azimuth, double elevation) {
  const double a = glm::radians(azimuth), e = glm::radians(elevation);
  return {std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e)};
}

// Fraction of the box's radiance in direction `d`.
double shine(const SoftBox& box, const glm::dvec3& d) {
  const glm::dvec3 middle = direction_of(box.azimuth, box.elevation);
  const double ahead = glm::dot(d, middle);
  if (ahead <= 0.0) return 0.0;
  const double azimuth = glm::radians(box.azimuth);
  const glm::dvec3 right(std::cos(azimuth), 0.0, -std::sin(azimuth)), up = glm::cross(middle, right);
  const double x = glm::degrees(std::atan2(std::abs(glm::dot(d, right)), ahead)) / box.half_width,
               y = glm::degrees(std::atan2(std::abs(glm::dot(d, up)), ahead)) / box.half_height;
  const double inside = (1.0 - smooth_step(1.0 - kSoftEdge / box.half_width, 1.0, x)) *
                        (1.0 - smooth_step(1.0 - kSoftEdge / box.half_height, 1.0, y));
  return inside * (1.0 - (x * x + y * y) / 6.0);
}

// The room without its lamps: a floor that bends up into a backdrop, on which a light falls behind the subject; a dim
// ceiling; and darkness around the camera, which gives reflections their contrast.
double backdrop(const glm::dvec3& d) {
  constexpr double kFloor = 0.95, kBack = 0.95, kFront = 0.15, kCeiling = 0.25;
  constexpr double kGlow = 0.7, kGlowAzimuth = -156.0, kGlowElevation = -6.0, kGlowWidth = 27.0; // degrees
  const double elevation = glm::degrees(std::asin(std::clamp(d.y, -1.0, 1.0)));
  const double wall = glm::mix(kFront, kBack, smooth_step(-0.7, 0.5, -d.z)); // from the camera's side to the backdrop
  const double low = glm::mix(glm::mix(kFloor, wall, 0.5), wall, smooth_step(-60.0, 10.0, elevation));
  const double from_glow =
      glm::degrees(std::acos(std::clamp(glm::dot(d, direction_of(kGlowAzimuth, kGlowElevation)), -1.0, 1.0)));
  const double glow = kGlow * std::exp(-0.5 * from_glow * from_glow / (kGlowWidth * kGlowWidth));
  return glm::mix(low, kCeiling, smooth_step(20.0, 70.0, elevation)) + glow;
}

} // namespace

Environment studio_environment() {
  Environment studio;
  studio.radiance = glm::vec3(1.0f);
  studio.width = kStudioWidth, studio.height = kStudioHeight;
  studio.map.resize(std::size_t{kStudioWidth} * kStudioHeight);
  tbb::parallel_for(0u, kStudioHeight, [&](std::uint32_t y) {
    for (std::uint32_t x = 0; x < kStudioWidth; ++x) {
      const glm::dvec3 d = environment_direction({(x + 0.5) / kStudioWidth, (y + 0.5) / kStudioHeight}, 0.0);
      double radiance = backdrop(d);
      for (const SoftBox& box : kBoxes) radiance += box.radiance * shine(box, d);
      studio.map[std::size_t{y} * kStudioWidth + x] = glm::vec3(static_cast<float>(radiance));
    }
  });
  expose_for_white_floor(studio);
  return studio;
}

} // namespace wavepath
