#include "host/selftest/shapes.h"
#include "kernels/base/frame_types.h"

#include <numbers>

namespace wavepath {

float Random::uniform(float lo, float hi) {
  return lo + (hi - lo) * static_cast<float>(engine() >> 8) * 0x1p-24f; // the same numbers with every library
}

glm::vec3 Random::point(float lo, float hi) {
  const float x = uniform(lo, hi), y = uniform(lo, hi);
  return {x, y, uniform(lo, hi)};
}

glm::vec3 Random::direction() {
  for (;;) {
    const glm::vec3 p = point(-1, 1);
    const float square = glm::dot(p, p);
    if (square > 0.01f && square < 1.0f) return p / std::sqrt(square);
  }
}

Positions uv_sphere(int rings, int segments, float roughness, glm::vec3 center, float radius) {
  Random random(7);
  Positions vertices;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < segments; ++j) {
      const float theta = std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(rings);
      const float phi = 2 * std::numbers::pi_v<float> * static_cast<float>(j) / static_cast<float>(segments);
      const float r = radius * (1 + roughness * random.uniform(-1, 1));
      vertices.push_back(
          center + r * glm::vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)));
    }
  const auto vertex = [&](int i, int j) {
    const int column = i == 0 || i == rings ? 0 : j % segments;
    return vertices[static_cast<std::size_t>(i * segments + column)];
  };
  Positions triangles;
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < segments; ++j) {
      if (i + 1 != rings) triangles.insert(triangles.end(), {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      if (i != 0) triangles.insert(triangles.end(), {vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  return triangles;
}

Positions triangle_soup(int count, unsigned seed, float size, float extent) {
  Random random(seed);
  Positions triangles;
  for (int i = 0; i < count; ++i) {
    const glm::vec3 v0 = random.point(-extent, extent);
    triangles.push_back(v0);
    for (int v = 1; v < 3; ++v) triangles.push_back(v0 + random.point(-size, size));
  }
  return triangles;
}

gpu::Ray ray_along(glm::vec3 origin, glm::vec3 direction) { return {origin, 0, direction, gpu::kFar}; }

} // namespace wavepath
