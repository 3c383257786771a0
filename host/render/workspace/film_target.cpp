#include "host/render/workspace/film_target.h"

#include <algorithm>
#include <cstring>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "host/render/workspace/levels.h"
#include "host/render/workspace/resources.h"
#include "kernels/base/frame_types.h"
#include "kernels/base/tile_order.h"

namespace wavepath {
namespace {

// Sums of one entry: both replicates of a pixel where samples are split between them.
std::size_t replicates_each(const FilmShape& shape) { return shape.has_probes ? 1 : gpu::kReplicates; }

std::uint64_t film_bytes(const FilmBand& band, const FilmShape& shape) {
  return band.entries() * replicates_each(shape) * sizeof(gpu::FilmPixel);
}
std::uint64_t aov_bytes(const FilmBand& band) { return band.entries() * sizeof(gpu::FilmAovs); }
// Of the picture, and behind them of its groups of lights.
std::uint64_t cover_bytes(const FilmBand& band) { return band.entries() * sizeof(gpu::FilmCover); }
std::uint64_t splat_bytes(const FilmBand& band) {
  return std::uint64_t{band.pixel_count} * gpu::kReplicates * sizeof(gpu::SplatPixel);
}
std::uint64_t splat_bytes(const FilmBand& band, const FilmShape& shape) {
  return std::uint64_t{band.pixel_count} * (gpu::kReplicates + shape.groups) * sizeof(gpu::SplatPixel);
}
std::uint64_t group_bytes(const FilmBand& band, const FilmShape& shape) {
  return std::uint64_t{band.entries()} * shape.groups * sizeof(gpu::FilmPixel);
}

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

// The rows of a band's probes, `each` values a probe, which need no sorting.
template <class T>
auto* probes_of(const FilmBand& band, std::size_t each, const Film& film, T& rows) {
  return rows.data() + (film.shape().pixels() + band.first_probe) * each;
}

template <class T>
void read_rows(const FilmBand& band, const Buffer& buffer, std::size_t each, Film& film, std::vector<T>& rows,
               std::uint64_t first_byte = 0) {
  std::vector<T> values;
  const auto* there = static_cast<const T*>(buffer.in_place());
  if (there) there += first_byte / sizeof(T);
  in_pieces(band.pixel_count, [&](std::uint32_t first, std::uint32_t count) {
    if (there) return to_rows(there + first * each, band.first_pixel + first, count, each, film, rows);
    values.resize(count * each);
    buffer.read(values.data(), values.size() * sizeof(T), first_byte + first * each * sizeof(T));
    to_rows(values.data(), band.first_pixel + first, count, each, film, rows);
  });
  if (band.probe_count > 0)
    buffer.read(probes_of(band, each, film, rows), band.probe_count * each * sizeof(T),
                band.pixel_count * each * sizeof(T));
}

template <class T>
void write_rows(const FilmBand& band, Buffer& buffer, std::size_t each, const Film& film, const std::vector<T>& rows,
                std::uint64_t first_byte = 0) {
  std::vector<T> values;
  in_pieces(band.pixel_count, [&](std::uint32_t first, std::uint32_t count) {
    values.resize(count * each);
    for_all(count, [&](std::uint32_t i) {
      std::copy_n(&rows[row_major(band.first_pixel + first + i, film) * each], each, &values[i * each]);
    });
    buffer.write(values.data(), values.size() * sizeof(T), first_byte + first * each * sizeof(T));
  });
  if (band.probe_count > 0)
    buffer.write(probes_of(band, each, film, rows), band.probe_count * each * sizeof(T),
                 band.pixel_count * each * sizeof(T));
}

} // namespace

namespace {

// Pixels of a band: what one buffer may hold, written as storage and read as texels.
std::uint64_t most_pixels(const FilmShape& shape, const DeviceInfo& info) {
  const std::uint64_t range = std::min(info.max_storage_range, 16 * info.max_texels(16));
  const std::uint64_t most_entries =
      range / std::max<std::uint64_t>({replicates_each(shape) * sizeof(gpu::FilmPixel), sizeof(gpu::FilmAovs),
                                       shape.groups * sizeof(gpu::FilmPixel), shape.cover ? sizeof(gpu::FilmCover) : 0,
                                       shape.splats ? (gpu::kReplicates + shape.groups) * sizeof(gpu::SplatPixel) : 0});
  std::uint64_t step = kRunPixels; // few runs lie in two
  std::uint64_t most = most_entries;
  if (shape.has_probes) { // nor does a block: bands are whole rows of tiles, which hold whole rows of blocks
    step = 8 * std::uint64_t{shape.width};
    most = most_entries / (step + shape.probes_above(std::min(8u, shape.height))) * step;
  }
  return std::max(most / step, std::uint64_t{1}) * step;
}

// Of the first band where a film holds the whole picture.
std::uint64_t first_band_bytes(FilmShape shape, const DeviceInfo& info) {
  const gpu::FilmArea area = shape.area();
  shape.width = area.whole_width, shape.height = area.whole_height, shape.place = {};
  FilmBand band;
  band.pixel_count = static_cast<std::uint32_t>(std::min(most_pixels(shape, info), shape.pixels()));
  band.probe_count = shape.probes_above(band.pixel_count / shape.width);
  return film_bytes(band, shape);
}

// Of a pilot of the noise in a whole picture, of which a film holds a part.
std::uint64_t noise_pilot_bytes(const FilmShape& shape) {
  const gpu::FilmArea area = shape.area();
  const std::uint32_t part = noise_pilot_part(std::uint64_t{area.whole_width} * area.whole_height);
  return std::uint64_t{(area.whole_width + part - 1) / part} * ((area.whole_height + part - 1) / part) *
         gpu::kReplicates * sizeof(gpu::FilmPixel);
}

} // namespace

// Bands of a larger picture stay, empty.
bool FilmTarget::fit(const FilmShape& shape, bool capacity_for_aovs) {
  bool moved = (shape_.groups > 0) != (shape.groups > 0); // kernels are bound to more, or to less
  shape_ = shape;
  const std::uint64_t most = most_pixels(shape, device_->info());
  bands_.resize(std::max<std::size_t>(bands_.size(), (pixels() + most - 1) / most));
  std::uint64_t first = 0;
  std::uint32_t first_probe = 0;
  for (FilmBand& band : bands_) {
    band.first_pixel = static_cast<std::uint32_t>(first);
    band.pixel_count = static_cast<std::uint32_t>(std::min(most, pixels() - first));
    first += band.pixel_count;
    band.first_probe = first_probe;
    const auto rows = static_cast<std::uint32_t>(first / shape.width); // up to its end, with error probes
    band.probe_count = shape.probes_above(rows) - first_probe;
    first_probe += band.probe_count;
    band.picture_pixels = static_cast<std::uint32_t>(pixels());
    std::uint64_t film = film_bytes(band, shape);
    if (shape.is_part() && &band == &bands_.front())
      film = std::max(film, std::min(first_band_bytes(shape, device_->info()), noise_pilot_bytes(shape)));
    moved |= reserve(*device_, band.film, film);
    moved |= reserve(*device_, band.aovs, shape.aovs || capacity_for_aovs ? aov_bytes(band) : 0);
    moved |= reserve(*device_, band.splats, shape.splats ? splat_bytes(band, shape) : 0);
    if (shape.groups > 0) moved |= reserve(*device_, band.groups, group_bytes(band, shape));
    moved |= reserve(*device_, band.cover, shape.cover ? cover_bytes(band) : 0);
  }
  pilot_bytes_ = shape.is_part() ? first_band_bytes(shape, device_->info()) : bands_.front().film.bytes();
  return moved;
}

void FilmTarget::clear() {
  for (FilmBand& band : bands_) {
    band.film.fill_zero(shape_.is_part() ? band.film.bytes() : film_bytes(band, shape_)); // a pilot's film is larger
    if (band.aovs.bytes()) band.aovs.fill_zero(aov_bytes(band));
    if (shape_.splats) band.splats.fill_zero(splat_bytes(band, shape_));
    if (shape_.groups > 0) band.groups.fill_zero(group_bytes(band, shape_));
    if (shape_.cover) band.cover.fill_zero(cover_bytes(band));
  }
}

Film FilmTarget::download() const {
  Film film = make_film(shape_);
  for (const FilmBand& band : bands_) {
    read_rows(band, band.film, replicates_each(shape_), film, film.pixels);
    if (shape_.aovs) read_rows(band, band.aovs, 1, film, film.aovs);
    if (shape_.splats) read_rows(band, band.splats, gpu::kReplicates, film, film.splats);
    if (shape_.groups > 0) read_rows(band, band.groups, shape_.groups, film, film.groups);
    if (!film.group_splats.empty())
      read_rows(band, band.splats, shape_.groups, film, film.group_splats, splat_bytes(band));
    if (shape_.cover) read_rows(band, band.cover, 1, film, film.cover);
  }
  count_light_paths(film);
  return film;
}

Film FilmTarget::download_small(const FilmShape& shape) const {
  Film film = make_film(shape);
  FilmBand all;
  all.pixel_count = static_cast<std::uint32_t>(shape.pixels());
  read_rows(all, bands_.front().film, replicates_each(shape), film, film.pixels);
  return film;
}

void FilmTarget::upload(const Film& film) {
  for (FilmBand& band : bands_) {
    write_rows(band, band.film, replicates_each(shape_), film, film.pixels);
    if (!film.aovs.empty()) write_rows(band, band.aovs, 1, film, film.aovs);
    if (!film.splats.empty()) write_rows(band, band.splats, gpu::kReplicates, film, film.splats);
    if (shape_.groups > 0) write_rows(band, band.groups, shape_.groups, film, film.groups);
    if (!film.group_splats.empty())
      write_rows(band, band.splats, shape_.groups, film, film.group_splats, splat_bytes(band));
    if (!film.cover.empty()) write_rows(band, band.cover, 1, film, film.cover);
  }
}

std::uint64_t FilmTarget::bytes() const {
  std::uint64_t sum = 0;
  for (const FilmBand& band : bands_)
    sum += band.film.bytes() + band.aovs.bytes() + band.splats.bytes() + band.groups.bytes() + band.cover.bytes();
  return sum;
}

void FilmSnapshot::fit(Device& device, const FilmTarget& target) {
  shape_ = target.shape();
  bands_.resize(target.bands().size());
  for (std::size_t i = 0; i < bands_.size(); ++i) {
    FilmBand& band = bands_[i];
    const FilmBand& from = target.bands()[i];
    band.first_pixel = from.first_pixel, band.pixel_count = from.pixel_count;
    band.first_probe = from.first_probe, band.probe_count = from.probe_count;
    const auto make = [&](Buffer& buffer, std::uint64_t bytes) {
      if (buffer.handle() && buffer.bytes() >= bytes) return;
      buffer = Buffer();
      buffer = Buffer(device, bytes, BufferHome::readback);
    };
    make(band.film, film_bytes(band, shape_));
    if (shape_.aovs) make(band.aovs, aov_bytes(band));
    if (shape_.splats) make(band.splats, splat_bytes(band, shape_));
    if (shape_.groups > 0) make(band.groups, group_bytes(band, shape_));
    if (shape_.cover) make(band.cover, cover_bytes(band));
  }
}

void FilmSnapshot::record(Commands& commands, const FilmTarget& target) const {
  for (std::size_t i = 0; i < bands_.size(); ++i) {
    const FilmBand& band = target.bands()[i];
    if (band.pixel_count == 0) continue;
    const auto copy = [&](const Buffer& from, const Buffer& to, std::uint64_t bytes) {
      commands.copy(from, to, bytes, Commands::Order::unordered);
    };
    copy(band.film, bands_[i].film, film_bytes(band, shape_));
    if (shape_.aovs) copy(band.aovs, bands_[i].aovs, aov_bytes(band));
    if (shape_.splats) copy(band.splats, bands_[i].splats, splat_bytes(band, shape_));
    if (shape_.groups > 0) copy(band.groups, bands_[i].groups, group_bytes(band, shape_));
    if (shape_.cover) copy(band.cover, bands_[i].cover, cover_bytes(band));
  }
}

Film FilmSnapshot::read() const {
  Film film = make_film(shape_);
  for (const FilmBand& band : bands_) {
    if (band.pixel_count == 0) continue;
    const auto read = [&]<class T>(const Buffer& buffer, std::size_t each, std::vector<T>& rows,
                                   std::uint64_t first_byte = 0) {
      buffer.invalidate();
      const T* values = static_cast<const T*>(buffer.mapped()) + first_byte / sizeof(T);
      to_rows(values, band.first_pixel, band.pixel_count, each, film, rows);
      std::copy_n(values + band.pixel_count * each, band.probe_count * each, probes_of(band, each, film, rows));
    };
    read(band.film, replicates_each(shape_), film.pixels);
    if (shape_.aovs) read(band.aovs, 1, film.aovs);
    if (shape_.splats) read(band.splats, gpu::kReplicates, film.splats);
    if (shape_.groups > 0) read(band.groups, shape_.groups, film.groups);
    if (!film.group_splats.empty()) read(band.splats, shape_.groups, film.group_splats, splat_bytes(band));
    if (shape_.cover) read(band.cover, 1, film.cover);
  }
  count_light_paths(film);
  return film;
}

void add_bindings(const FilmBand& band, std::vector<Binding>& bindings) {
  bindings.insert(bindings.end(), {{gpu::kBindFilm, BindingKind::storage, &band.film},
                                   {.slot = gpu::kBindFilmTexels,
                                    .kind = BindingKind::texels_rgba32ui,
                                    .buffer = &band.film,
                                    .words = gpu::kBindFilm},
                                   {gpu::kBindFilmAovs, BindingKind::storage, &band.aovs}});
}

std::vector<Binding> film_layout() {
  std::vector<Binding> layout;
  add_bindings(FilmBand{}, layout);
  for (Binding& binding : layout) binding.buffer = nullptr;
  return layout;
}

} // namespace wavepath
