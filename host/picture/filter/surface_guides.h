// Surface properties of every pixel, by which filters decide which pixels show the same surface.
#pragma once

#include <vector>

#include "host/picture/filter/noisy_picture.h"

namespace wavepath {

struct SurfaceGuide {
  glm::vec3 normal{0.0f}; // mean over samples
  glm::vec3 albedo{0.0f};
  float spread = 0.0f;    // mean squared distance of the samples' normals from their mean
  float disparity = 0.0f; // 1 / depth, linear across the picture of a plane; 0 = nothing is seen
  glm::vec2 slope{0.0f};  // change of the disparity from pixel to pixel, to the right and downwards
};

std::vector<SurfaceGuide> surface_guides(const NoisyPicture& picture);

// Scale of squared differences of normals: 1 / (2 sigma^2), where sigma is the difference between normals 14 degrees
// apart.
inline constexpr float kNormalScale = 8.0f;
// The same scale for albedos. Light is divided by the albedo before it is filtered, but surfaces of different colour
// often differ in their reflections as well.
inline constexpr float kAlbedoScale = 40.0f;
// Difference between a disparity and the one that the slope predicts, above which the pixel shows another plane.
inline constexpr float kDisparitySlack = 5e-3f;

// Approximation of e^-x for weights, as (1 + x/8)^-8, which compilers vectorize.
template <class T>
T falloff(T x) {
  T y = 1.0f / (1.0f + 0.125f * x);
  y = y * y, y = y * y;
  return y * y;
}

} // namespace wavepath
