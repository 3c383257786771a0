// What the device has accumulated, as the picture and the error that the user sees. All sums here are double.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/render/path_tracer.h"
#include "host/render/render.h"

namespace wavepath {

// Per pixel, row-major from the top left.
struct FilmImage {
  std::uint32_t width = 0, height = 0;
  struct Pixel {
    glm::dvec3 mean[gpu::kReplicates]{}; // of each replicate
    std::uint32_t count[gpu::kReplicates]{};
  };
  std::vector<Pixel> pixels;
  std::vector<gpu::FilmAovs> aovs; // empty unless the render has AOVs
};

FilmImage read_film(const PathTracer& tracer, std::uint32_t width, std::uint32_t height);

// Channels R G B A, then those of `aovs` (names of the contract's --aov). `origin` is added back to positions.
Picture develop(const FilmImage& film, const std::vector<std::string>& aovs, const glm::dvec3& origin);

// sqrt of the expected relMSE of the mean image: each pixel's variance is taken from the spread of its two replicates, which
// is unbiased for any sampler because they are scrambled independently. The interval treats pixels as independent.
// Not a number while a pixel lacks samples in either replicate.
ErrorEstimate estimate_error(const FilmImage& film);

} // namespace wavepath
