#include "host/integrators/hybrid/shadows/lamp_points.h"

#include <cmath>
#include <numbers>

namespace wavepath {
namespace {

// The digits of i in base 2, mirrored at the point (van der Corput 1935).
double mirrored_bits(std::uint32_t i) {
  double value = 0.0;
  for (double digit = 0.5; i > 0; i >>= 1, digit *= 0.5) value += (i & 1u) * digit;
  return value;
}

} // namespace

std::vector<glm::dvec3> lamp_points(const ShadowSource& source, std::uint32_t count) {
  std::vector<glm::dvec3> points;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double a = (i + 0.5) / count, b = mirrored_bits(i) + 0.5 / count;
    const double angle = 2.0 * std::numbers::pi * b;
    const glm::dvec2 around(std::cos(angle), std::sin(angle));
    if (source.kind == kSphereSource) { // slices of equal height have equal areas (Archimedes)
      const double height = 1.0 - 2.0 * a;
      points.push_back(source.position +
                       glm::length(source.u) * glm::dvec3(std::sqrt(1.0 - height * height) * around, height));
      continue;
    }
    const glm::dvec2 at = source.kind == kDiscSource ? std::sqrt(a) * around : 2.0 * glm::dvec2(a, b) - 1.0;
    points.push_back(source.position + at.x * source.u + at.y * source.v);
  }
  return points;
}

} // namespace wavepath
