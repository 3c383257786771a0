// Closed forms and quadratures; see oracles.h.
#include "host/selftest/oracles.h"

#include <cmath>
#include <numbers>

namespace wavepath {
namespace {

constexpr double kPi = std::numbers::pi;

// Angle of two directions, exact for small ones (an arc cosine is not).
double angle(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

double smith_lambda(double alpha, double cosine) {
  const double tangent2 = (1.0 - cosine * cosine) / (cosine * cosine);
  return 0.5 * (std::sqrt(1.0 + alpha * alpha * tangent2) - 1.0);
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

// With D(h) cos(h) dh = dt dphi / 2pi for tan^2(h) = alpha^2 t / (1 - t), the albedo is the mean over t and phi of
// G2(o, i) (o.h) / (cos(o) cos(h)). 1 - t = q^3 resolves the flat normals' tail, which counts at grazing angles.
double ggx_albedo(double alpha, double cosine) {
  constexpr int kRings = 512, kSpokes = 256;
  const double sine = std::sqrt(1.0 - cosine * cosine);
  double total = 0.0;
  for (int ring = 0; ring < kRings; ++ring) {
    const double q = (ring + 0.5) / kRings, rest = q * q * q;
    const double z = 1.0 / std::sqrt(1.0 + alpha * alpha * (1.0 - rest) / rest), r = std::sqrt(1.0 - z * z);
    for (int spoke = 0; spoke < kSpokes; ++spoke) {
      const double phi = kPi * (spoke + 0.5) / kSpokes; // the other half is its mirror image
      const double oh = sine * r * std::cos(phi) + cosine * z;
      const double i = 2.0 * oh * z - cosine; // cosine of the mirrored direction
      if (oh > 0.0 && i > 0.0)
        total += 3.0 * q * q * oh / (cosine * z * (1.0 + smith_lambda(alpha, cosine) + smith_lambda(alpha, i)));
    }
  }
  return total / (kRings * kSpokes);
}

} // namespace wavepath
