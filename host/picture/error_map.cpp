#include "host/picture/error_map.h"

#include <algorithm>

#include "host/picture/tonemap.h"

namespace wavepath {
namespace {

// Black, purple, orange, pale yellow: brightness rises evenly, so that the map also reads in grey.
glm::vec3 map_color(float error) {
  const glm::vec3 stops[] = {
      {0.0f, 0.0f, 0.015f}, {0.32f, 0.07f, 0.48f}, {0.72f, 0.21f, 0.47f}, {0.99f, 0.53f, 0.38f}, {0.99f, 0.99f, 0.75f}};
  const float position = std::clamp(error, 0.0f, 1.0f) * 4.0f;
  const int first = std::min(static_cast<int>(position), 3);
  return glm::mix(stops[first], stops[first + 1], position - static_cast<float>(first));
}

} // namespace

Picture error_map(std::uint32_t width, std::uint32_t height, const std::vector<float>& error, double brightest) {
  Picture map{width, height, {{"R", {}}, {"G", {}}, {"B", {}}}};
  for (const float value : error) {
    const glm::vec3 color = map_color(static_cast<float>(value / brightest));
    for (int c = 0; c < 3; ++c) map.channels[static_cast<std::size_t>(c)].values.push_back(from_srgb(color[c]));
  }
  return map;
}

} // namespace wavepath
