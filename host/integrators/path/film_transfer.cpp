#include "host/integrators/path/film_transfer.h"

#include <algorithm>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "kernels/tile_order.h"

namespace wavepath {
namespace {

std::size_t row_major(std::uint32_t in_tile_order, const Film& film) {
  const glm::uvec2 at = gpu::pixel_in_tile_order(in_tile_order, film.width, film.height);
  return std::size_t{at.y} * film.width + at.x;
}

// Calls body(first pixel in the band, count) for pieces whose copies stay in a cache.
template <class Body>
void in_pieces(const FilmBand& band, Body body) {
  constexpr std::uint32_t kPiece = 1u << 15;
  for (std::uint32_t first = 0; first < band.pixel_count; first += kPiece)
    body(first, std::min(kPiece, band.pixel_count - first));
}

template <class Body>
void for_all(std::uint32_t count, Body body) {
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count, 4096), [&](const auto& range) {
    for (std::uint32_t i = range.begin(); i < range.end(); ++i) body(i);
  });
}

// Values of a band's pixels, `each` to a pixel, from tile order on the device to rows.
template <class T>
void read_rows(const FilmBand& band, const Buffer& buffer, std::size_t each, const Film& film, std::vector<T>& rows) {
  std::vector<T> values;
  in_pieces(band, [&](std::uint32_t first, std::uint32_t count) {
    values.resize(count * each);
    buffer.read(values.data(), values.size() * sizeof(T), first * each * sizeof(T));
    for_all(count, [&](std::uint32_t i) {
      std::copy_n(&values[i * each], each, &rows[row_major(band.first_pixel + first + i, film) * each]);
    });
  });
}

template <class T>
void write_rows(const FilmBand& band, Buffer& buffer, std::size_t each, const Film& film, const std::vector<T>& rows) {
  std::vector<T> values;
  in_pieces(band, [&](std::uint32_t first, std::uint32_t count) {
    values.resize(count * each);
    for_all(count, [&](std::uint32_t i) {
      std::copy_n(&rows[row_major(band.first_pixel + first + i, film) * each], each, &values[i * each]);
    });
    buffer.write(values.data(), values.size() * sizeof(T), first * each * sizeof(T));
  });
}

} // namespace

Film download_film(const PathTracer& tracer, std::uint32_t width, std::uint32_t height) {
  const std::size_t pixels = std::size_t{width} * height;
  Film film{width, height, std::vector<gpu::FilmPixel>(pixels * gpu::kReplicates), {}};
  if (tracer.has_aovs()) film.aovs.resize(pixels);
  for (const FilmBand& band : tracer.bands()) {
    read_rows(band, band.film, gpu::kReplicates, film, film.pixels);
    if (!film.aovs.empty()) read_rows(band, band.aovs, 1, film, film.aovs);
  }
  return film;
}

void upload_film(PathTracer& tracer, const Film& film) {
  for (FilmBand& band : tracer.bands()) {
    write_rows(band, band.film, gpu::kReplicates, film, film.pixels);
    if (!film.aovs.empty()) write_rows(band, band.aovs, 1, film, film.aovs);
  }
}

} // namespace wavepath
