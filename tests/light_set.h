// Lights of all kinds at random, for tests of the light tree.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "host/scene/pack/light_tree.h"

namespace wavepath::test {

// Triangles of one and of two sides, points and spots in a box of 20 m x 10 m x 5 m, of log-normal intensity.
inline std::vector<LightBounds> mixed_lights(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  std::normal_distribution<float> normal;
  const auto direction = [&] { return glm::normalize(glm::vec3(normal(random), normal(random), normal(random))); };
  std::vector<LightBounds> lights;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 place(20.0f * unit(random), 10.0f * unit(random), 5.0f * unit(random));
    const double strength = std::exp(2.0 * normal(random));
    const int kind = static_cast<int>(4.0f * unit(random));
    if (kind < 2) {
      const glm::vec3 corners[3] = {place, place + 0.1f * direction(), place + 0.1f * direction()};
      lights.push_back(triangle_light_bounds(corners, strength, kind == 1));
    } else if (kind == 2) {
      lights.push_back(point_light_bounds(place, strength));
    } else {
      const double outer = 0.1 + 1.4 * unit(random);
      const double power = 2.0 * std::numbers::pi * (1.0 - std::cos(outer)) * strength;
      lights.push_back(spot_light_bounds(place, direction(), outer, strength, power));
    }
  }
  return lights;
}

} // namespace wavepath::test
