// Random numbers and triangle meshes that the cases of the tree share. Meshes are lists of positions, three a triangle.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include <glm/glm.hpp>

#include "kernels/base/frame_types.h"

namespace wavepath {

struct Random {
  std::mt19937 engine;
  explicit Random(unsigned seed) : engine(seed) {}
  float uniform(float lo = 0.0f, float hi = 1.0f);
  float log_uniform(float lo, float hi) { return std::pow(10.0f, uniform(lo, hi)); } // 10^lo .. 10^hi
  std::size_t below(std::size_t n) { return engine() % n; }
  glm::vec3 point(float lo, float hi);
  glm::vec3 direction();
};

using Positions = std::vector<glm::vec3>;

// Closed; the radius wobbles by `roughness`, the poles are single vertices.
Positions uv_sphere(int rings, int segments, float roughness, glm::vec3 center = {}, float radius = 1.0f);

// Random triangles of about `size` in a cube of the given extent around the origin.
Positions triangle_soup(int count, unsigned seed, float size, float extent = 1.0f);

// A ray without an end. The kernels need no unit direction.
gpu::Ray ray_along(glm::vec3 origin, glm::vec3 direction);

} // namespace wavepath
