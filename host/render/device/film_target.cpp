#include "host/render/device/film_target.h"

#include <algorithm>
#include <cstring>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "host/render/device/resources.h"
#include "kernels/frame_types.h"
#include "kernels/tile_order.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kFilmPixelBytes = gpu::kReplicates * sizeof(gpu::FilmPixel);
constexpr std::uint64_t kSplatPixelBytes = gpu::kReplicates * sizeof(gpu::SplatPixel);

std::size_t row_major(std::uint32_t in_tile_order, const Film& film) {
  const glm::uvec2 at = gpu::pixel_in_tile_order(in_tile_order, film.width, film.height);
  return std::size_t{at.y} * film.width + at.x;
}

// Calls body(first pixel in the band, count) for pieces whose copies stay in a cache.
template <class Body>
void in_pieces(std::uint32_t pixel_count, Body body) {
  constexpr std::uint32_t kPiece = 1u << 15;
  for (std::uint32_t first = 0; first < pixel_count; first += kPiece)
    body(first, std::min(kPiece, pixel_count - first));
}

template <class Body>
void for_all(std::uint32_t count, Body body) {
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count, 4096), [&](const auto& range) {
    for (std::uint32_t i = range.begin(); i < range.end(); ++i) body(i);
  });
}

// Copies `each` values a pixel from tile order, beginning with pixel `first`, to rows.
template <class T>
void to_rows(const T* values, std::uint32_t first, std::uint32_t count, std::size_t each, const Film& film,
             std::vector<T>& rows) {
  for_all(count,
          [&](std::uint32_t i) { std::copy_n(&values[i * each], each, &rows[row_major(first + i, film) * each]); });
}

template <class T>
void read_rows(const FilmBand& band, const Buffer& buffer, std::size_t each, const Film& film, std::vector<T>& rows) {
  std::vector<T> values;
  in_pieces(band.pixel_count, [&](std::uint32_t first, std::uint32_t count) {
    values.resize(count * each);
    buffer.read(values.data(), values.size() * sizeof(T), first * each * sizeof(T));
    to_rows(values.data(), band.first_pixel + first, count, each, film, rows);
  });
}

template <class T>
void write_rows(const FilmBand& band, Buffer& buffer, std::size_t each, const Film& film, const std::vector<T>& rows) {
  std::vector<T> values;
  in_pieces(band.pixel_count, [&](std::uint32_t first, std::uint32_t count) {
    values.resize(count * each);
    for_all(count, [&](std::uint32_t i) {
      std::copy_n(&rows[row_major(band.first_pixel + first + i, film) * each], each, &values[i * each]);
    });
    buffer.write(values.data(), values.size() * sizeof(T), first * each * sizeof(T));
  });
}

Film empty_film(std::uint32_t width, std::uint32_t height, bool aovs, bool splats) {
  const std::size_t pixels = std::size_t{width} * height;
  Film film{width, height, std::vector<gpu::FilmPixel>(pixels * gpu::kReplicates), {}, {}};
  if (aovs) film.aovs.resize(pixels);
  if (splats) film.splats.resize(pixels * gpu::kReplicates);
  return film;
}

} // namespace

// A band is what one buffer may hold, written as storage and read as texels. Bands of a larger picture stay, empty.
bool FilmTarget::fit(std::uint32_t width, std::uint32_t height, bool aovs, bool room_for_aovs, bool splats) {
  width_ = width, height_ = height, has_aovs_ = aovs, has_splats_ = splats;
  const DeviceInfo& info = device_->info();
  const std::uint64_t range = std::min(info.max_storage_range, 16 * info.max_texel_elements);
  const std::uint64_t most = range / std::max(kFilmPixelBytes, sizeof(gpu::FilmAovs)) / gpu::kRunPixels *
                             gpu::kRunPixels; // no run lies in two
  bands_.resize(std::max<std::size_t>(bands_.size(), (pixels() + most - 1) / most));
  bool moved = false;
  std::uint64_t first = 0;
  for (FilmBand& band : bands_) {
    band.first_pixel = static_cast<std::uint32_t>(first);
    band.pixel_count = static_cast<std::uint32_t>(std::min(most, pixels() - first));
    first += band.pixel_count;
    const std::uint64_t aov_bytes = aovs || room_for_aovs ? std::uint64_t{band.pixel_count} * sizeof(gpu::FilmAovs) : 0;
    moved |= make_room(*device_, band.film, band.pixel_count * kFilmPixelBytes);
    moved |= make_room(*device_, band.aovs, aov_bytes);
    moved |= make_room(*device_, band.splats, splats ? band.pixel_count * kSplatPixelBytes : 0);
  }
  return moved;
}

void FilmTarget::clear() {
  for (FilmBand& band : bands_) {
    band.film.fill_zero(band.pixel_count * kFilmPixelBytes);
    if (band.aovs.bytes()) band.aovs.fill_zero(band.pixel_count * sizeof(gpu::FilmAovs));
    if (has_splats_) band.splats.fill_zero(band.pixel_count * kSplatPixelBytes);
  }
}

Film FilmTarget::download() const {
  Film film = empty_film(width_, height_, has_aovs_, has_splats_);
  for (const FilmBand& band : bands_) {
    read_rows(band, band.film, gpu::kReplicates, film, film.pixels);
    if (has_aovs_) read_rows(band, band.aovs, 1, film, film.aovs);
    if (has_splats_) read_rows(band, band.splats, gpu::kReplicates, film, film.splats);
  }
  count_light_paths(film);
  return film;
}

void FilmTarget::upload(const Film& film) {
  for (FilmBand& band : bands_) {
    write_rows(band, band.film, gpu::kReplicates, film, film.pixels);
    if (!film.aovs.empty()) write_rows(band, band.aovs, 1, film, film.aovs);
    if (!film.splats.empty()) write_rows(band, band.splats, gpu::kReplicates, film, film.splats);
  }
}

std::uint64_t FilmTarget::bytes() const {
  std::uint64_t sum = 0;
  for (const FilmBand& band : bands_) sum += band.film.bytes() + band.aovs.bytes() + band.splats.bytes();
  return sum;
}

void FilmSnapshot::fit(Device& device, const FilmTarget& target) {
  width_ = target.width(), height_ = target.height();
  has_aovs_ = target.has_aovs(), has_splats_ = target.has_splats();
  bands_.resize(target.bands().size());
  for (std::size_t i = 0; i < bands_.size(); ++i) {
    Band& band = bands_[i];
    band.first_pixel = target.bands()[i].first_pixel;
    band.pixel_count = target.bands()[i].pixel_count;
    const auto make = [&](Buffer& buffer, std::uint64_t bytes) {
      if (buffer.handle() && buffer.bytes() >= bytes) return;
      buffer = Buffer();
      buffer = Buffer(device, bytes, BufferHome::readback);
    };
    make(band.film, band.pixel_count * kFilmPixelBytes);
    if (has_aovs_) make(band.aovs, band.pixel_count * sizeof(gpu::FilmAovs));
    if (has_splats_) make(band.splats, band.pixel_count * kSplatPixelBytes);
  }
}

void FilmSnapshot::record(Commands& commands, const FilmTarget& target) const {
  for (std::size_t i = 0; i < bands_.size(); ++i) {
    const FilmBand& band = target.bands()[i];
    if (band.pixel_count == 0) continue;
    const auto copy = [&](const Buffer& from, const Buffer& to, std::uint64_t bytes) {
      commands.copy(from, to, bytes, Commands::Order::unordered);
    };
    copy(band.film, bands_[i].film, band.pixel_count * kFilmPixelBytes);
    if (has_aovs_) copy(band.aovs, bands_[i].aovs, band.pixel_count * sizeof(gpu::FilmAovs));
    if (has_splats_) copy(band.splats, bands_[i].splats, band.pixel_count * kSplatPixelBytes);
  }
}

Film FilmSnapshot::read() const {
  Film film = empty_film(width_, height_, has_aovs_, has_splats_);
  for (const Band& band : bands_) {
    if (band.pixel_count == 0) continue;
    const auto read = [&]<class T>(const Buffer& buffer, std::size_t each, std::vector<T>& rows) {
      buffer.invalidate();
      to_rows(static_cast<const T*>(buffer.mapped()), band.first_pixel, band.pixel_count, each, film, rows);
    };
    read(band.film, gpu::kReplicates, film.pixels);
    if (has_aovs_) read(band.aovs, 1, film.aovs);
    if (has_splats_) read(band.splats, gpu::kReplicates, film.splats);
  }
  count_light_paths(film);
  return film;
}

void add_bindings(const FilmBand& band, std::vector<Binding>& bindings) {
  bindings.insert(bindings.end(), {{gpu::kBindFilm, BindingKind::storage, &band.film},
                                   {gpu::kBindFilmTexels, BindingKind::texels_rgba32ui, &band.film},
                                   {gpu::kBindFilmAovs, BindingKind::storage, &band.aovs}});
}

std::vector<Binding> film_layout() {
  std::vector<Binding> layout;
  add_bindings(FilmBand{}, layout);
  for (Binding& binding : layout) binding.buffer = nullptr;
  return layout;
}

} // namespace wavepath
