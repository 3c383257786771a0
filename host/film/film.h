// The film on the host: joins the sums that the device accumulated, and develops them into a picture.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/picture/picture.h"
#include "kernels/base/error_probes.h"
#include "kernels/base/frame_types.h"
#include "kernels/film/film_types.h"

namespace wavepath {

// Shape of a film: how many sums it has, and which pixels they belong to.
struct FilmShape {
  std::uint32_t width = 0, height = 0;
  bool aovs = false, splats = false;
  bool has_probes = false; // see kernels/base/error_probes.h
  std::uint32_t seed = 0;  // of the render: it picks the probed pixels
  bool quads = false;      // four neighbouring pixels share samples (host/render/settings/path_reuse.h)

  std::uint64_t pixels() const { return std::uint64_t{width} * height; }
  // As gpu::Frame::probes.
  std::uint32_t probes() const {
    return !has_probes ? gpu::kProbesNone : quads ? gpu::kProbesQuads : gpu::kProbesPixels;
  }
  // Of the upper rows, which are all or end with a row of tiles.
  std::uint32_t probes_above(std::uint32_t rows) const {
    return rows > 0 && width > 0 ? gpu::probes_above(rows, width, height, probes()) : 0;
  }
  std::uint64_t probe_count() const { return probes_above(height); }
  std::uint64_t entries() const { return pixels() + probe_count(); } // with AOVs of their own
  std::uint64_t replicates() const { return has_probes ? entries() : gpu::kReplicates * pixels(); }
  // Memory of all sums.
  std::uint64_t bytes() const {
    return replicates() * sizeof(gpu::FilmPixel) + (aovs ? entries() * sizeof(gpu::FilmAovs) : 0) +
           (splats ? gpu::kReplicates * pixels() * sizeof(gpu::SplatPixel) : 0);
  }
  bool operator==(const FilmShape&) const = default;
};

// The exact sums of a render, row-major from the top left. Two films of different samples of one picture join without
// loss.
struct Film {
  std::uint32_t width = 0, height = 0;
  std::vector<gpu::FilmPixel> pixels;  // kReplicates a pixel; with error probes one a pixel, then the probes by block
  std::vector<gpu::FilmAovs> aovs;     // empty unless the render has AOVs; probes have their own
  std::vector<gpu::SplatPixel> splats; // kReplicates each; empty unless the integrator has light paths
  // Samples of all pixels, by replicate: each traced a light path, which may have brought light to any pixel.
  std::array<std::uint64_t, gpu::kReplicates> light_paths{};
  bool has_probes = false;
  std::uint32_t seed = 0; // see FilmShape
  bool quads = false;
  // The probed pixel of each block; empty without probes. A table, since every look at a pixel asks for it.
  std::vector<std::uint32_t> probed;

  FilmShape shape() const { return {width, height, !aovs.empty(), !splats.empty(), has_probes, seed, quads}; }
  bool operator==(const Film& other) const; // bit by bit
};

// Without samples.
Film make_film(const FilmShape& shape);

// Only with error probes: the block of a pixel, which is the index of its probe among all, and the probed pixel of a
// block.
std::size_t block_of(const Film& film, std::size_t pixel);
std::size_t probed_pixel(const Film& film, std::size_t block);
// Pixels of the block of that probed pixel.
std::size_t pixels_probed_by(const Film& film, std::size_t probed);

// The sums over both sets of samples, bit for bit those of one render of them all. AOVs of first hits are running means
// in floats, and join to within their rounding. Both have one size.
void join(Film& film, const Film& other);

// Sets light_paths from the samples of all pixels, where there are splats.
void count_light_paths(Film& film);

// Samples of a pixel that count, of all its replicates, and their mean with the light that was splatted; zero without
// any.
std::uint32_t sample_count(const Film& film, std::size_t pixel);
glm::dvec3 mean_radiance(const Film& film, std::size_t pixel);

// Channels R G B A, then those of `aovs` (values of --aov). `origin` is added back to positions.
Picture develop(const Film& film, const std::vector<std::string>& aovs, const glm::dvec3& origin);

// The means of a pixel's AOVs over the samples of all its replicates.
gpu::FilmAovs mean_aovs(const Film& film, std::size_t pixel);

// The largest sample of a pixel, R + G + B.
float largest_sample(const Film& film, std::size_t pixel);

// The mean of a pixel to within rounding, and an estimate of the variance of that mean; not a number while the pixel
// lacks samples in any replicate. With error probes, the difference of the two replicates of the block's probed pixel
// gives the variance of all pixels of the block.
struct PixelStatistics {
  glm::dvec3 mean, variance;
};
PixelStatistics statistics(const Film& film, std::size_t pixel);

// The same in two steps, for loops over pixels: the difference of the replicates of the pixel that is probed for this
// one, and the statistics from that.
struct ReplicateDifference {
  std::size_t probed = 0;
  glm::dvec3 squared{};
  double first = 0.0, second = 0.0; // samples of the replicates
};
ReplicateDifference replicate_difference(const Film& film, std::size_t probed);
PixelStatistics statistics(const Film& film, std::size_t pixel, const ReplicateDifference& replicates);
glm::dvec3 mean_variance(const Film& film, std::size_t pixel);

} // namespace wavepath
