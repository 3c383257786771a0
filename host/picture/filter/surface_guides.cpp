#include "host/picture/filter/surface_guides.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

namespace wavepath {
namespace {

// The smaller of two differences, because one side may lie across an edge. `known`: the sides that are seen.
float smaller(float a, bool known_a, float b, bool known_b) {
  if (!known_a || !known_b) return known_a ? a : known_b ? b : 0.0f;
  return std::abs(a) < std::abs(b) ? a : b;
}

} // namespace

std::vector<SurfaceGuide> surface_guides(const NoisyPicture& picture) {
  const std::size_t width = picture.width, height = picture.height;
  std::vector<SurfaceGuide> guides(picture.pixels());
  const auto disparity = [&](std::size_t i) { return picture.depth[i] > 0.0f ? 1.0f / picture.depth[i] : 0.0f; };
  tbb::parallel_for(std::size_t{0}, height, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t i = y * width + x;
      SurfaceGuide& guide = guides[i];
      guide.disparity = disparity(i);
      if (!(guide.disparity > 0.0f)) continue;
      guide.normal = picture.normal[i];
      guide.albedo = picture.albedo[i];
      guide.spread = std::max(0.0f, 1.0f - glm::dot(guide.normal, guide.normal));
      const auto slope = [&](std::size_t before, bool has_before, std::size_t after, bool has_after) {
        const float a = has_before ? disparity(before) : 0.0f, b = has_after ? disparity(after) : 0.0f;
        return smaller(guide.disparity - a, a > 0.0f, b - guide.disparity, b > 0.0f);
      };
      guide.slope.x = slope(i - 1, x > 0, i + 1, x + 1 < width);
      guide.slope.y = slope(i - width, y > 0, i + width, y + 1 < height);
    }
  });
  return guides;
}

} // namespace wavepath
