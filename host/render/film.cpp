#include "host/render/film.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/tile_order.h"

namespace wavepath {
namespace {

using Pixel = FilmImage::Pixel;

glm::dvec3 mean_of(const Pixel& pixel) {
  glm::dvec3 sum(0.0);
  double count = 0.0;
  for (std::uint32_t r = 0; r < gpu::kReplicates; ++r) {
    sum += pixel.mean[r] * static_cast<double>(pixel.count[r]);
    count += pixel.count[r];
  }
  return count > 0.0 ? sum / count : sum;
}

// Variance of the pixel's mean from two replicates a, b of n and m samples: (a - b)^2 nm / (n + m)^2, which is (a - b)^2 / 4
// where n = m.
glm::dvec3 variance_of(const Pixel& pixel) {
  static_assert(gpu::kReplicates == 2);
  const double n = pixel.count[0], m = pixel.count[1];
  if (n == 0.0 || m == 0.0) return glm::dvec3(std::numeric_limits<double>::quiet_NaN());
  const glm::dvec3 difference = pixel.mean[0] - pixel.mean[1];
  return difference * difference * (n * m / ((n + m) * (n + m)));
}

// Appends channels NAME + suffix for every letter, filled by value(pixel index, component).
template <class Value>
void add_channels(Picture& picture, const std::string& prefix, const std::string& letters, Value value) {
  for (std::size_t c = 0; c < letters.size(); ++c) {
    Channel channel{prefix + letters[c], std::vector<float>(std::size_t{picture.width} * picture.height)};
    for (std::size_t i = 0; i < channel.values.size(); ++i)
      channel.values[i] = static_cast<float>(value(i, static_cast<int>(c)));
    picture.channels.push_back(std::move(channel));
  }
}

void add_aov(Picture& picture, const FilmImage& film, const std::string& name, const glm::dvec3& origin) {
  constexpr float kNothing = 1e10f; // depth where nothing was hit, as other renderers write it
  const auto& aovs = film.aovs;
  if (name == "albedo") {
    add_channels(picture, "albedo.", "RGB", [&](std::size_t i, int c) { return aovs[i].albedo[c]; });
  } else if (name == "normal") {
    add_channels(picture, "N.", "XYZ", [&](std::size_t i, int c) { return aovs[i].normal[c]; });
  } else if (name == "depth") {
    add_channels(picture, "", "Z", [&](std::size_t i, int) { return aovs[i].hits > 0.0f ? aovs[i].depth : kNothing; });
  } else if (name == "position") {
    add_channels(picture, "P.", "XYZ", [&](std::size_t i, int c) {
      return aovs[i].hits > 0.0f ? aovs[i].position[c] + origin[c] : 0.0;
    });
  } else if (name == "variance") {
    add_channels(picture, "variance.", "RGB", [&](std::size_t i, int c) { return variance_of(film.pixels[i])[c]; });
  } else if (name == "samples") {
    Channel channel{"samples", {}};
    for (const Pixel& pixel : film.pixels) channel.values.push_back(static_cast<float>(pixel.count[0] + pixel.count[1]));
    picture.channels.push_back(std::move(channel));
  } else if (name == "direct") {
    add_channels(picture, "direct.", "RGB", [&](std::size_t i, int c) { return aovs[i].direct[c]; });
  } else if (name == "emission") {
    add_channels(picture, "emission.", "RGB", [&](std::size_t i, int c) { return aovs[i].emission[c]; });
  } else if (name == "indirect") {
    // What is left of the picture, so that emission + direct + indirect adds up to it.
    add_channels(picture, "indirect.", "RGB", [&](std::size_t i, int c) {
      return mean_of(film.pixels[i])[c] - aovs[i].direct[c] - aovs[i].emission[c];
    });
  }
}

} // namespace

FilmImage read_film(const PathTracer& tracer, std::uint32_t width, std::uint32_t height) {
  FilmImage film{width, height, std::vector<Pixel>(std::size_t{width} * height), {}};
  if (tracer.features() & gpu::kFeatureAovs) film.aovs.resize(film.pixels.size());
  constexpr std::uint32_t kChunk = 1u << 18; // pixels read at a time
  for (const FilmBand& band : tracer.bands())
    for (std::uint32_t first = 0; first < band.pixel_count; first += kChunk) {
      const std::uint32_t count = std::min(kChunk, band.pixel_count - first);
      const auto values = download<gpu::FilmPixel>(band.film, std::size_t{count} * gpu::kReplicates,
                                                   std::uint64_t{first} * gpu::kReplicates * sizeof(gpu::FilmPixel));
      std::vector<gpu::FilmAovs> aovs;
      if (!film.aovs.empty())
        aovs = download<gpu::FilmAovs>(band.aovs, count, std::uint64_t{first} * sizeof(gpu::FilmAovs));
      for (std::uint32_t i = 0; i < count; ++i) {
        const glm::uvec2 at = gpu::pixel_in_tile_order(band.first_pixel + first + i, width, height);
        const std::size_t index = std::size_t{at.y} * width + at.x;
        for (std::uint32_t r = 0; r < gpu::kReplicates; ++r) {
          const gpu::FilmPixel& from = values[std::size_t{i} * gpu::kReplicates + r];
          const glm::dvec3 sum = glm::dvec3(from.total) + glm::dvec3(from.compensation) + glm::dvec3(from.block);
          film.pixels[index].count[r] = from.count;
          if (from.count > 0) film.pixels[index].mean[r] = sum / static_cast<double>(from.count);
        }
        if (!film.aovs.empty()) film.aovs[index] = aovs[i];
      }
    }
  return film;
}

Picture develop(const FilmImage& film, const std::vector<std::string>& aovs, const glm::dvec3& origin) {
  Picture picture{film.width, film.height, {}};
  std::vector<glm::vec3> means;
  means.reserve(film.pixels.size());
  for (const Pixel& pixel : film.pixels) means.emplace_back(mean_of(pixel));
  add_channels(picture, "", "RGB", [&](std::size_t i, int c) { return means[i][c]; });
  add_channels(picture, "", "A", [](std::size_t, int) { return 1.0f; });
  for (const std::string& name : aovs) add_aov(picture, film, name, origin);
  return picture;
}

ErrorEstimate estimate_error(const FilmImage& film) {
  double sum = 0.0, sum_of_squares = 0.0;
  for (const Pixel& pixel : film.pixels) {
    const glm::dvec3 mean = mean_of(pixel), variance = variance_of(pixel);
    double relative = 0.0;
    for (int c = 0; c < 3; ++c) relative += variance[c] / (mean[c] * mean[c] + 0.01) / 3.0;
    sum += relative;
    sum_of_squares += relative * relative;
  }
  const double n = static_cast<double>(film.pixels.size());
  const double mean = sum / n;
  const double spread = std::sqrt(std::max(0.0, sum_of_squares / n - mean * mean) / n); // standard error of the mean
  constexpr double kNormal95 = 1.959964;
  return {std::sqrt(mean), {std::sqrt(std::max(0.0, mean - kNormal95 * spread)), std::sqrt(mean + kNormal95 * spread)}};
}

} // namespace wavepath
