// Input of the filters of a finished picture: its light, how uncertain that is, and what the camera saw.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace wavepath {

struct Film; // host/film/film.h

// Values by pixel, row-major from the top left.
struct NoisyPicture {
  std::uint32_t width = 0, height = 0;
  std::vector<glm::vec3> color;    // radiance
  std::vector<glm::vec3> variance; // of its mean; not a number where there is no estimate
  std::vector<glm::vec3> emission; // radiance seen without a bounce, a part of the color
  std::vector<glm::vec3> albedo;
  std::vector<glm::vec3> normal; // mean over samples: shorter than 1 where they differ
  std::vector<float> depth;      // along the view axis; 0 = nothing was hit

  std::size_t pixels() const { return std::size_t{width} * height; }
};

// The noisy picture of a film that has AOVs.
NoisyPicture noisy_picture(const Film& film);

} // namespace wavepath
