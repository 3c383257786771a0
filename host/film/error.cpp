#include "host/film/error.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <tbb/parallel_for.h>

#include "host/film/film.h"
#include "kernels/base/error_probes.h"
#include "kernels/base/frame_types.h"
#include "kernels/base/tile_order.h"

namespace wavepath {
namespace {

double mean_of(const glm::dvec3& v) { return (v.x + v.y + v.z) / 3.0; }

constexpr std::size_t kTileRows = 8, kBlockRows = 4 * kTileRows; // no quad lies in two blocks
constexpr double kFloor = 0.01;                                  // added to squared radiance, as in relMSE

// Statistics of the pixels of rows [first, end) and of their neighbours. Rows are processed in blocks, because the
// statistics of a whole picture take as much memory as its film.
struct Rows {
  Rows(const Film& film_, std::size_t first, std::size_t end)
      : film(film_),
        begin((first > 0 ? first - 1 : 0) * film.width),
        pixels(std::min<std::size_t>(end + 1, film.height) * film.width - begin) {
    // The same for consecutive pixels; with quads, for each rank.
    std::array<std::optional<ReplicateDifference>, gpu::kQuadPixels> ranks;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const std::size_t pixel = begin + i, block = film.has_probes ? block_of(film, pixel) : pixel;
      const std::size_t probed = film.has_probes ? probed_pixel(film, block) : pixel;
      std::optional<ReplicateDifference>& replicates = ranks[block % ranks.size()];
      if (!replicates || probed != replicates->probed) replicates = replicate_difference(film, probed);
      pixels[i] = statistics(film, pixel, *replicates);
    }
  }
  // `index`: of the pixel in the picture.
  const PixelStatistics& operator[](std::size_t index) const { return pixels[index - begin]; }

  const Film& film;
  std::size_t begin;
  std::vector<PixelStatistics> pixels;
};

// relMSE weighs a pixel by 1 / (r^2 + 0.01). The pixel's own mean alone is no good r: a sample that is bright by chance
// raises mean and spread alike, and so hides its own error (up to a third of it, where noise is strong). So r is the
// mean of the eight neighbours. At an edge, where the pixel differs from them by more than noise explains, r moves
// towards the pixel's own mean. Of the weights by r and by the own mean the larger counts, because neighbours across an
// edge may be far brighter. `least_noise`: the least variance of the pixel's mean.
glm::dvec3 weight(const Rows& rows, std::size_t index, double least_noise) {
  const int width = static_cast<int>(rows.film.width), height = static_cast<int>(rows.film.height);
  const int x = static_cast<int>(index % rows.film.width), y = static_cast<int>(index / rows.film.width);
  glm::dvec3 around(0.0), noise(0.0);
  double count = 0.0;
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height - 1); ++v)
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u) {
      const PixelStatistics& pixel = rows[static_cast<std::size_t>(v) * rows.film.width + static_cast<std::size_t>(u)];
      noise += pixel.variance;
      if (u == x && v == y) continue;
      around += pixel.mean;
      count += 1.0;
    }
  const PixelStatistics& own = rows[index];
  if (count == 0.0) return 1.0 / (own.mean * own.mean + kFloor);
  around /= count;
  noise = glm::max(glm::max(noise / (count + 1.0), own.variance), least_noise);
  const glm::dvec3 apart = own.mean - around, edge = glm::max(apart * apart - noise, 0.0);
  glm::dvec3 r = own.mean;
  for (int c = 0; c < 3; ++c)
    if (edge[c] + noise[c] > 0.0) r[c] = around[c] + apart[c] * edge[c] / (edge[c] + noise[c]);
  return 1.0 / (glm::min(r * r, own.mean * own.mean) + kFloor);
}

// Contribution of a pixel's largest sample to its mean, averaged over R G B.
double largest_alone(const Film& film, std::size_t index) {
  const double alone = largest_sample(film, index) / 3.0 / std::max(sample_count(film, index), 1u);
  if (film.splats.empty()) return alone;
  double splat = 0.0, paths = 0.0;
  for (std::uint32_t r = 0; r < gpu::kReplicates; ++r) {
    const std::uint32_t largest = film.splats[index * gpu::kReplicates + r].largest;
    splat = std::max(splat, std::bit_cast<float>(largest) / 3.0);
    paths += static_cast<double>(film.light_paths[r]);
  }
  return std::max(alone, splat / std::max(paths, 1.0));
}

// Weighted sums of squared errors of pixels; with quads, of the means of quads.
struct Sums {
  double sum = 0.0, sum_of_squares = 0.0, largest_alone = 0.0;
  double represented = 0.0; // pixels

  // `pixels` of that squared error on average.
  void add(double squared, double pixels) {
    sum += squared * pixels;
    sum_of_squares += squared * squared * pixels;
    represented += pixels;
  }
};

// The pixels of a block, and the sum of their squared errors over that of the probed pixel, which has two replicates.
// The weight of the probed pixel stands for all weights: each pixel had the same chance to be probed, so that the sum
// over blocks is right on average, whatever the pixels of a block have in common.
struct BlockFactors {
  double pixels = 0.0, times = 0.0;
};
BlockFactors factors_of(const Film& film, std::size_t probed) {
  const auto pixels = static_cast<double>(pixels_probed_by(film, probed));
  const double both = sample_count(film, probed), first = film.pixels[probed].count;
  return {pixels, 1.0 + (pixels - 1.0) * both / std::max(first, 1.0)};
}

// Squared errors of the probed pixels of a quad, each times the number of pixels that it represents.
struct Quad {
  double squared = 0.0, pixels = 0.0;
};

// Quads of a row of tiles; no quad extends beyond one. The squared errors of a quad's pixels come from the light of the
// same paths, and four equal ones say no more than one: their mean counts once.
class Quads {
public:
  Quads(const Film& film, std::size_t row)
      : film_(film),
        area_(film.shape().area()),
        first_(static_cast<std::uint32_t>((row + area_.top) / kTileRows * kTileRows) * area_.whole_width /
               gpu::kQuadPixels),
        quads_(kTileRows * area_.whole_width / gpu::kQuadPixels) {}
  void add(std::size_t pixel, double squared, double pixels) {
    Quad& quad = quads_[tile_index_of(pixel) / gpu::kQuadPixels - first_];
    quad.squared += squared * pixels, quad.pixels += pixels;
  }
  void add_to(Sums& sums) const {
    for (const Quad& quad : quads_)
      if (quad.pixels > 0.0) sums.add(quad.squared / quad.pixels, quad.pixels);
  }

private:
  std::uint32_t tile_index_of(std::size_t pixel) const {
    const auto index = static_cast<std::uint32_t>(pixel), y = index / film_.width;
    return gpu::tile_order_of({index - y * film_.width + area_.left, y + area_.top}, area_.whole_width,
                              area_.whole_height);
  }

  const Film& film_;
  const gpu::FilmArea area_;
  std::uint32_t first_;
  std::vector<Quad> quads_;
};

// `largest_known`: largest value of earlier rows; the result is never less. `quads`: receives squared errors in place
// of the sums; null without quads.
Sums row_sums(const Rows& rows, std::size_t row, double largest_known, Quads* quads) {
  const Film& film = rows.film;
  Sums sums;
  sums.largest_alone = largest_known;
  for (std::size_t i = row * film.width; i < (row + 1) * film.width; ++i) {
    const bool probed = !film.has_probes || probed_pixel(film, block_of(film, i)) == i;
    const double largest = largest_alone(film, i), alone = largest * largest;
    if (!probed && alone / kFloor <= sums.largest_alone) continue; // whatever its weight
    // A pixel without a probe has the variance of a pixel that did not get its bright sample.
    const glm::dvec3 w = weight(rows, i, probed ? 0.0 : alone);
    const BlockFactors factors = film.has_probes && probed ? factors_of(film, i) : BlockFactors{1.0, 1.0};
    sums.largest_alone = std::max(sums.largest_alone, alone * mean_of(w) * factors.times);
    if (!probed) continue;
    const double squared = mean_of(rows[i].variance * w) * factors.times / factors.pixels;
    if (quads)
      quads->add(i, squared, factors.pixels);
    else
      sums.add(squared, factors.pixels);
  }
  return sums;
}

} // namespace

ErrorEstimate estimate_error(const Film& film) {
  std::vector<Sums> rows(film.height);                   // added up in order: the same for any number of threads
  const std::size_t above = film.place.top % kBlockRows; // rows of the first block that a part lacks
  tbb::parallel_for(std::size_t{0}, (above + rows.size() + kBlockRows - 1) / kBlockRows, [&](std::size_t block) {
    const std::size_t first = std::max(block * kBlockRows, above) - above,
                      end = std::min((block + 1) * kBlockRows - above, rows.size());
    const Rows statistics(film, first, end);
    std::optional<Quads> quads;
    for (std::size_t y = first; y < end; ++y) {
      const std::size_t next = above + y + 1;
      if (film.quads && (y == first || (next - 1) % kTileRows == 0)) quads.emplace(film, y);
      rows[y] = row_sums(statistics, y, y > first ? rows[y - 1].largest_alone : 0.0, quads ? &*quads : nullptr);
      if (quads && (next % kTileRows == 0 || y + 1 == end)) quads->add_to(rows[y]);
    }
  });
  const std::size_t pixel_count = std::size_t{film.width} * film.height;
  double sum = 0.0, sum_of_squares = 0.0, largest = 0.0, represented = 0.0;
  for (const Sums& row : rows) {
    represented += row.represented;
    sum += row.sum;
    sum_of_squares += row.sum_of_squares;
    largest = std::max(largest, row.largest_alone);
  }
  // A part cuts blocks. The probed pixel of a block lies in the part with the probability of any other, and then stands
  // for the whole block: the sum is right on average, and so is its ratio to the pixels that are stood for.
  const bool cuts_blocks = film.has_probes && film.shape().is_part();
  const auto within = [&](std::uint32_t pixel) { return pixel < pixel_count; };
  const auto probes = static_cast<std::uint64_t>(std::ranges::count_if(film.probed, within));
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  if (cuts_blocks && probes < kFewestProbes) return {kUnknown, {kUnknown, kUnknown}, 0.0};
  const double n = cuts_blocks ? represented : static_cast<double>(pixel_count), mean = sum / n;
  // The interval is that of this picture's error, not of its expectation. Both the estimate, over probed pixels, and
  // the error, over all pixels, scatter alike and independently: the sum and the difference of two replicates are
  // independent if they are normal. The weights are known less well: over scenes and sample counts they left the
  // squared error at 0.91x to 1.0x of the true one. There are a quarter as many quads as pixels, probed or not. If the
  // pixels of a quad err independently, their mean scatters a quarter as much as a pixel. If they err alike, it
  // scatters as much, and the interval is twice as wide.
  constexpr double kWeights = 0.05; // standard deviation of the weights' error
  const double probed = film.has_probes ? static_cast<double>(probes) : n;
  const double together = film.quads ? gpu::kQuadPixels : 1.0; // pixels for each squared error
  const double scatter = std::max(0.0, sum_of_squares / n - mean * mean) * together * (1.0 / probed + 1.0 / n);
  const double spread = std::sqrt(scatter + kWeights * kWeights * mean * mean);
  constexpr double kNormal95 = 1.959964;
  double high = mean + kNormal95 * spread, fraction = sum > 0.0 ? largest / sum : 0.0;
  if (film.has_probes) { // the largest sample may lie at a pixel that is not probed
    high = std::max(high, mean + largest / n);
    fraction = std::min(fraction, 1.0);
  }
  return {std::sqrt(mean), {std::sqrt(std::max(0.0, mean - kNormal95 * spread)), std::sqrt(high)}, fraction};
}

bool has_estimate(std::uint32_t spp, const ErrorEstimate& error) {
  return spp >= gpu::kReplicates && std::isfinite(error.relative_rms);
}

double fit_slope(const std::vector<Checkpoint>& checkpoints, Against against) {
  constexpr double kPoints = 5.0; // four octaves, if none was left out
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (std::size_t i = checkpoints.size(); i-- > 0 && n < kPoints;) {
    const Checkpoint& c = checkpoints[i];
    const double cost = against == Against::seconds ? c.seconds : c.spp;
    if (!(c.error.relative_rms > 0.0) || !(cost > 0.0)) continue;
    const double x = std::log(cost), y = std::log(c.error.relative_rms);
    n += 1.0, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const double determinant = n * sxx - sx * sx;
  constexpr double kMonteCarlo = -0.5; // slope of any unbiased method in the limit
  return n >= 3.0 && determinant > 1e-9 ? (n * sxy - sx * sy) / determinant : kMonteCarlo;
}

double growth_for(double ratio, double slope) {
  if (ratio <= 1.0) return 1.0;
  return slope < 0.0 ? std::pow(ratio, -1.0 / slope) : std::numeric_limits<double>::infinity();
}

} // namespace wavepath
