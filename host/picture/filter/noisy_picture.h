// Input of the filters of finished pictures: light, its variance, and what the camera saw.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace wavepath {

struct Film; // host/film/film.h

// Values of each pixel, row-major from the top left.
struct NoisyPicture {
  std::uint32_t width = 0, height = 0;
  std::vector<glm::vec3> color;    // radiance
  std::vector<glm::vec3> variance; // variance of the mean radiance; NaN = no estimate
  std::vector<glm::vec3> emission; // radiance seen without a bounce, included in `color`
  std::vector<glm::vec3> albedo;
  std::vector<glm::vec3> normal; // mean over samples; shorter than 1 if they differ
  std::vector<float> depth;      // distance along the view axis; 0 = no hit

  std::size_t pixels() const { return std::size_t{width} * height; }
};

// The noisy picture of a film, which must have AOVs.
NoisyPicture noisy_picture(const Film& film);

} // namespace wavepath
