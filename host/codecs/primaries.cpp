#include "host/codecs/primaries.h"

#include <algorithm>
#include <cmath>

#include "host/codecs/image.h"

namespace wavepath {
namespace {

using glm::dmat3;
using glm::dvec3;

// XYZ of luminance 1.
dvec3 xyz_of(float x, float y) { return {double{x} / double{y}, 1.0, (1.0 - double{x} - double{y}) / double{y}}; }

// Linear RGB to XYZ; white has Y = 1.
dmat3 rgb_to_xyz(const std::array<float, 8>& c) {
  const dmat3 primaries(xyz_of(c[0], c[1]), xyz_of(c[2], c[3]), xyz_of(c[4], c[5]));
  const dvec3 scale = glm::inverse(primaries) * xyz_of(c[6], c[7]);
  return dmat3(primaries[0] * scale[0], primaries[1] * scale[1], primaries[2] * scale[2]);
}

dmat3 adapt_to_d65(float x, float y) {
  const dmat3 cones = glm::transpose(dmat3(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296));
  const dvec3 ratio = (cones * xyz_of(kRec709[6], kRec709[7])) / (cones * xyz_of(x, y));
  return glm::inverse(cones) * dmat3(ratio.x, 0, 0, 0, ratio.y, 0, 0, 0, ratio.z) * cones;
}

} // namespace

bool is_rec709(const std::array<float, 8>& chromaticities) {
  return std::equal(kRec709.begin(), kRec709.end(), chromaticities.begin(),
                    [](float a, float b) { return std::abs(a - b) < 2e-4f; });
}

glm::dmat3 to_rec709(const std::array<float, 8>& chromaticities) {
  const dmat3 matrix = glm::inverse(rgb_to_xyz(kRec709)) * adapt_to_d65(chromaticities[6], chromaticities[7]) *
                       rgb_to_xyz(chromaticities);
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      if (!(std::abs(matrix[column][row]) < 1e3)) throw ImageError("has chromaticities that span no colours");
  return matrix;
}

} // namespace wavepath
