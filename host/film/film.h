// The film on the host: joins sums that devices accumulated, and develops them into a picture.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/picture/picture.h"
#include "kernels/base/error_probes.h"
#include "kernels/base/frame_types.h"
#include "kernels/film/cover_types.h"
#include "kernels/film/film_types.h"

namespace wavepath {

// Shape of a film: the number of its sums, and the pixels that they belong to.
struct FilmShape {
  std::uint32_t width = 0, height = 0;
  bool aovs = false, splats = false;
  bool has_probes = false;  // see kernels/base/error_probes.h
  std::uint32_t seed = 0;   // seed of the render, which picks the probed pixels
  bool quads = false;       // four neighbouring pixels share samples (host/render/settings/path_reuse.h)
  std::uint32_t groups = 0; // of lights, whose light has sums of its own
  bool cover = false;       // sums of transparency and shadow (host/render/settings/cover.h)
  PicturePlace place{};

  bool is_part() const { return place.whole_width > 0; }
  gpu::FilmArea area() const {
    if (!is_part()) return gpu::whole_area(width, height);
    return {place.left, place.top, width, height, place.whole_width, place.whole_height};
  }
  std::uint64_t pixels() const { return std::uint64_t{width} * height; }
  // Value of gpu::Frame::probes.
  std::uint32_t probes() const {
    return !has_probes ? gpu::kProbesNone : quads ? gpu::kProbesQuads : gpu::kProbesPixels;
  }
  // Number of probes of the upper `rows`, which must be all rows or end with a row of tiles.
  std::uint32_t probes_above(std::uint32_t rows) const {
    return rows > 0 && width > 0 ? gpu::probes_above(rows, area(), probes()) : 0;
  }
  std::uint64_t probe_count() const { return probes_above(height); }
  std::uint64_t entries() const { return pixels() + probe_count(); } // sums with AOVs of their own
  std::uint64_t replicates() const { return has_probes ? entries() : gpu::kReplicates * pixels(); }
  // Memory of all sums.
  std::uint64_t bytes() const {
    return replicates() * sizeof(gpu::FilmPixel) + (aovs ? entries() * sizeof(gpu::FilmAovs) : 0) +
           (cover ? entries() * sizeof(gpu::FilmCover) : 0) +
           (splats ? gpu::kReplicates * pixels() * sizeof(gpu::SplatPixel) : 0) + group_bytes();
  }
  std::uint64_t group_bytes() const {
    return groups * (entries() * sizeof(gpu::FilmPixel) + (splats ? pixels() * sizeof(gpu::SplatPixel) : 0));
  }
  bool operator==(const FilmShape&) const = default;
};

// The pixel that an entry of a film belongs to, in tile order of the whole picture. `entry`: of a film that kernels
// fill.
std::uint32_t in_picture(const FilmShape& shape, std::uint32_t entry);

// Exact sums of a render, row-major from the top left. Two films of different samples of one picture can be joined
// without loss.
struct Film {
  std::uint32_t width = 0, height = 0;
  // KReplicates for each pixel; with error probes, one for each pixel, then the probes by block.
  std::vector<gpu::FilmPixel> pixels;
  std::vector<gpu::FilmAovs> aovs;     // empty without AOVs; probes have their own
  std::vector<gpu::SplatPixel> splats; // kReplicates for each pixel; empty unless the integrator has light paths
  // Light of each group of lights: `group_count` for each pixel, then for each error probe. In integers the sums of all
  // groups of a pixel add up to those of its replicates.
  std::vector<gpu::FilmPixel> groups;
  std::vector<gpu::SplatPixel> group_splats; // of all replicates, `group_count` for each pixel; empty without splats
  std::uint32_t group_count = 0;
  std::vector<gpu::FilmCover> cover; // empty without; probes have their own
  // Number of light paths of each replicate: one for each sample of all pixels. Each may have added light to any pixel.
  std::array<std::uint64_t, gpu::kReplicates> light_paths{};
  bool has_probes = false;
  std::uint32_t seed = 0; // see FilmShape
  bool quads = false;
  // Probed pixel of each block; empty without probes. It is a table because every access to a pixel needs it.
  std::vector<std::uint32_t> probed;
  PicturePlace place{};
  // A part that is not cut at borders of blocks: by block, the first replicate of a probed pixel outside. Else empty.
  std::vector<gpu::FilmPixel> beside{};

  FilmShape shape() const {
    return {width, height, !aovs.empty(), !splats.empty(), has_probes, seed, quads, group_count, !cover.empty(), place};
  }
  bool operator==(const Film& other) const; // bit by bit
};

// Number of probed pixels that a film of this shape holds.
std::uint64_t probes_within(const FilmShape& shape);

// A film without samples.
Film make_film(const FilmShape& shape);

// Copies what a film holds of a part of its picture. A block that the border of the part cuts keeps its probe.
Film cut(const Film& film, const FilmShape& part);

// Copies a part into a film that holds it. Returns false, and stops, where the film has other samples of a pixel.
// `known`: the pixels of the film that have been pasted; updated.
bool paste(Film& film, const Film& part, std::vector<bool>& known);

// For films with error probes: the block of a pixel, which is also the index of the block's probe; and the probed pixel
// of a block. Pixels are row-major indices. That of a probed pixel outside a part is pixels() + block.
std::size_t block_of(const Film& film, std::size_t pixel);
std::size_t probed_pixel(const Film& film, std::size_t block);
// Number of pixels in the block of this probed pixel.
std::size_t pixels_probed_by(const Film& film, std::size_t probed);

// Adds the samples of `other`, which must have the same size. The sums have the same bits as those of one render of all
// samples. AOVs of first hits are running means in floats, and are joined to within their rounding.
void join(Film& film, const Film& other);

// Sets light_paths from the samples of all pixels, if there are splats.
void count_light_paths(Film& film);

// Number of finite samples of a pixel in all its replicates; and their mean, including splatted light; 0 without
// samples.
std::uint32_t sample_count(const Film& film, std::size_t pixel);
glm::dvec3 mean_radiance(const Film& film, std::size_t pixel);

// Develops the film into a picture: channels R G B A, then those of `aovs` (values of --aov), then those of groups of
// lights, which have these names (see light_group_channels()). `origin`: world position of the device's origin, which
// is added to positions.
Picture develop(const Film& film, const std::vector<std::string>& aovs, const glm::dvec3& origin,
                const std::vector<std::string>& groups = {});

// The light of a group that reaches a pixel; 0 without samples.
glm::dvec3 mean_group(const Film& film, std::size_t pixel, std::uint32_t group);

// Means of a pixel's AOVs over the samples of all its replicates.
gpu::FilmAovs mean_aovs(const Film& film, std::size_t pixel);

// Part of all light that samples had before --clamp dimmed them to this radiance, which it took; R + G + B.
double clamped_fraction(const Film& film, double radiance);

// Share of the background that a pixel lets through, and of the direct light of its surfaces that arrives; 0 and 1
// without such sums.
double transparency(const Film& film, std::size_t pixel);
double lit_share(const Film& film, std::size_t pixel);

// The largest sample of a pixel, by R + G + B.
float largest_sample(const Film& film, std::size_t pixel);

// Mean of a pixel, to within rounding, and the estimated variance of that mean; NaN while a replicate of the pixel
// lacks samples. With error probes, the variance of all pixels of a block comes from the two replicates of its probed
// pixel.
struct PixelStatistics {
  glm::dvec3 mean, variance;
};
PixelStatistics statistics(const Film& film, std::size_t pixel);

// The same in two steps, for loops over pixels: the difference of the replicates of the probed pixel, and the
// statistics of a pixel from it.
struct ReplicateDifference {
  std::size_t probed = 0;
  glm::dvec3 squared{};
  double first = 0.0, second = 0.0; // numbers of samples of the two replicates
};
ReplicateDifference replicate_difference(const Film& film, std::size_t probed);
PixelStatistics statistics(const Film& film, std::size_t pixel, const ReplicateDifference& replicates);
glm::dvec3 mean_variance(const Film& film, std::size_t pixel);

} // namespace wavepath
