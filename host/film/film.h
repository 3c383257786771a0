// The film on the host: joins the sums that the device accumulated, and develops them into a picture.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/film/picture.h"
#include "kernels/film/film_types.h"
#include "kernels/frame_types.h"

namespace wavepath {

// The exact sums of a render, row-major from the top left. Two films of different samples of one picture join without
// loss.
struct Film {
  std::uint32_t width = 0, height = 0;
  std::vector<gpu::FilmPixel> pixels;  // kReplicates each
  std::vector<gpu::FilmAovs> aovs;     // empty unless the render has AOVs
  std::vector<gpu::SplatPixel> splats; // kReplicates each; empty unless the integrator has light paths
  // Samples of all pixels, by replicate: each traced a light path, which may have brought light to any pixel.
  std::array<std::uint64_t, gpu::kReplicates> light_paths{};

  bool operator==(const Film& other) const; // bit by bit
};

// The sums over both sets of samples, bit for bit those of one render of them all. AOVs of first hits are running means
// in floats, and join to within their rounding. Both have one size.
void join(Film& film, const Film& other);

// Sets light_paths from the samples of all pixels, where there are splats.
void count_light_paths(Film& film);

// Samples of a pixel that count, and their mean with the light that was splatted; zero without any.
std::uint32_t sample_count(const Film& film, std::size_t pixel);
glm::dvec3 mean_radiance(const Film& film, std::size_t pixel);

// Channels R G B A, then those of `aovs` (values of --aov). `origin` is added back to positions.
Picture develop(const Film& film, const std::vector<std::string>& aovs, const glm::dvec3& origin);

// The mean of a pixel to within rounding, and an estimate of the variance of that mean; not a number while the pixel
// lacks samples in any replicate.
struct PixelStatistics {
  glm::dvec3 mean, variance;
};
PixelStatistics statistics(const Film& film, std::size_t pixel);
glm::dvec3 mean_variance(const Film& film, std::size_t pixel);

} // namespace wavepath
