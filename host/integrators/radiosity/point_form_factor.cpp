#include "host/integrators/radiosity/point_form_factor.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace wavepath {
namespace {

// The part of a triangle above the horizon. It has four corners at most.
struct Polygon {
  std::array<glm::dvec3, 4> corners;
  std::size_t count = 0;
};

Polygon above_horizon(const std::array<glm::dvec3, 3>& triangle, const glm::dvec3& n) {
  Polygon result;
  if (std::ranges::none_of(triangle, [&](const glm::dvec3& corner) { return glm::dot(corner, n) > 0.0; }))
    return result;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 &a = triangle[i], &b = triangle[(i + 1) % 3];
    const double height_a = glm::dot(a, n), height_b = glm::dot(b, n);
    if (height_a >= 0.0) result.corners[result.count++] = a;
    if (height_a * height_b < 0.0) result.corners[result.count++] = glm::mix(a, b, height_a / (height_a - height_b));
  }
  return result;
}

} // namespace

double point_form_factor(const glm::dvec3& x, const glm::dvec3& n, const std::array<glm::dvec3, 3>& triangle) {
  const Polygon seen = above_horizon({triangle[0] - x, triangle[1] - x, triangle[2] - x}, n);
  double sum = 0.0;
  for (std::size_t i = 0; i < seen.count; ++i) {
    const glm::dvec3 &a = seen.corners[i], &b = seen.corners[(i + 1) % seen.count];
    const glm::dvec3 across = glm::cross(a, b);
    const double length = glm::length(across); // 0: x is on the line of this side, which adds nothing
    if (length > 0.0) sum += std::atan2(length, glm::dot(a, b)) * glm::dot(across, n) / length;
  }
  return std::clamp(std::abs(sum) / (2.0 * std::numbers::pi), 0.0, 1.0);
}

} // namespace wavepath
