// Which pixels show one surface: what filters of finished pictures may mix.
#pragma once

#include <vector>

#include "host/picture/filter/noisy_picture.h"

namespace wavepath {

struct SurfaceGuide {
  glm::vec3 normal{0.0f}; // mean over samples
  glm::vec3 albedo{0.0f};
  float spread = 0.0f;    // of the normals of the samples: mean squared distance from their mean
  float disparity = 0.0f; // 1 / depth, linear across the picture of a plane; 0 = nothing is seen
  glm::vec2 slope{0.0f};  // its change from pixel to pixel, to the right and downwards
};

std::vector<SurfaceGuide> surface_guides(const NoisyPicture& picture);

// Squared difference of normals at which two surfaces count as one standard deviation apart, twice: 14 degrees.
inline constexpr float kNormalScale = 8.0f;
// Squared difference of albedos that counts as one standard deviation, twice. Light is divided by the albedo, but what
// is painted differently often mirrors differently as well.
inline constexpr float kAlbedoScale = 40.0f;
// Difference of a disparity from the one that the slope of its plane predicts, above which it counts as another plane.
inline constexpr float kDisparitySlack = 5e-3f;

// e^-x to within what a weight needs, in operations that compilers turn into vector code: (1 + x/8)^-8.
template <class T>
T falloff(T x) {
  T y = 1.0f / (1.0f + 0.125f * x);
  y = y * y, y = y * y;
  return y * y;
}

} // namespace wavepath
