// Closed forms and quadratures; see oracles.h.
#include "host/selftest/oracles.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wavepath {
namespace {

// Angle of two directions, exact for small ones (an arc cosine is not).
double angle(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

} // namespace

double irradiance(const Triangles& light) {
  double total = 0.0;
  for (std::size_t t = 0; t + 2 < light.size(); t += 3) {
    const glm::dvec3 v[3] = {light[t], light[t + 1], light[t + 2]};
    if (glm::dot(glm::cross(v[1] - v[0], v[2] - v[0]), v[0]) >= 0.0) continue; // faces away
    for (int i = 0; i < 3; ++i) {
      const glm::dvec3 a = v[i], b = v[(i + 1) % 3], n = glm::cross(b, a);
      if (glm::length(n) > 0.0) total += 0.5 * angle(a, b) * n.y / glm::length(n);
    }
  }
  return total;
}

double fresnel(double cosine, double eta) {
  const double sine2 = (1.0 - cosine * cosine) / (eta * eta);
  if (sine2 >= 1.0) return 1.0;
  const double refracted = std::sqrt(1.0 - sine2);
  const double s = (cosine - eta * refracted) / (cosine + eta * refracted);
  const double p = (eta * cosine - refracted) / (eta * cosine + refracted);
  return 0.5 * (s * s + p * p);
}

// By areas in the projection of directions onto the floor: there the sun is a disc and the edge half an ellipse.
double sun_past_edge(double half_angle, double edge_slope) {
  constexpr int kSteps = 4000;
  const double radius = std::sin(half_angle);
  double area = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double z = radius * (2.0 * (i + 0.5) / kSteps - 1.0), half = std::sqrt(radius * radius - z * z);
    const double edge = edge_slope * std::sqrt((1.0 - z * z) / (1.0 + edge_slope * edge_slope));
    area += std::clamp(half - edge, 0.0, 2.0 * half) * 2.0 * radius / kSteps;
  }
  return area / (std::numbers::pi * radius * radius);
}

} // namespace wavepath
