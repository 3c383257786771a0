#include "host/film/film.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "host/film/exact_sum.h"
#include "host/film/group_layers.h"
#include "kernels/base/frame_types.h"
#include "kernels/film/film_types.h"

namespace wavepath {
namespace {

std::uint32_t top_of(const gpu::FilmPixel& pixel, int channel) { return pixel.tops >> 8 * channel & 0xff; }

const gpu::ExactSum& sum_of(const gpu::FilmPixel& pixel, int channel) {
  return channel == 0 ? pixel.red : channel == 1 ? pixel.green : pixel.blue;
}
gpu::ExactSum& sum_of(gpu::FilmPixel& pixel, int channel) {
  return channel == 0 ? pixel.red : channel == 1 ? pixel.green : pixel.blue;
}

glm::dvec3 total_of(const gpu::FilmPixel& pixel) {
  glm::dvec3 total;
  for (int c = 0; c < 3; ++c) total[c] = value_of(sum_of(pixel, c), top_of(pixel, c));
  return total;
}

void join(gpu::FilmPixel& pixel, const gpu::FilmPixel& other) {
  std::uint32_t tops = 0;
  for (int c = 0; c < 3; ++c) {
    std::uint32_t top = top_of(pixel, c);
    add(sum_of(pixel, c), top, sum_of(other, c), top_of(other, c));
    tops |= top << 8 * c;
  }
  pixel.tops = tops;
  pixel.count += other.count;
  pixel.largest = std::max(pixel.largest, other.largest);
  pixel.clamped += std::min(other.clamped, ~pixel.clamped); // stays at the largest number
}

void join(gpu::FilmAovs& mean, const gpu::FilmAovs& other) {
  const auto mix = [](auto& a, const auto& b, float n, float m) {
    if (n + m > 0.0f) a += (b - a) * (m / (n + m));
  };
  mix(mean.albedo, other.albedo, mean.count, other.count);
  mix(mean.emission, other.emission, mean.count, other.count);
  mix(mean.direct, other.direct, mean.count, other.count);
  mix(mean.normal, other.normal, mean.hits, other.hits);
  mix(mean.position, other.position, mean.hits, other.hits);
  mix(mean.depth, other.depth, mean.hits, other.hits);
  mix(mean.unoccluded, other.unoccluded, mean.hits, other.hits);
  mix(mean.roughness, other.roughness, mean.hits, other.hits);
  mix(mean.metallic, other.metallic, mean.hits, other.hits);
  if (mean.hits == 0.0f) {
    mean.triangle = other.triangle;
    mean.instance = other.instance;
    mean.material = other.material;
  }
  mean.count += other.count;
  mean.hits += other.hits;
}

constexpr int kCoverSums = 8; // of FilmCover, the first three of the environment

const gpu::ExactSum& sum_of(const gpu::FilmCover& cover, int index) {
  const gpu::ExactSum* const others[] = {&cover.escaped, &cover.unblocked, &cover.arrived, &cover.caught_unblocked,
                                         &cover.caught_arrived};
  return index < 3 ? cover.environment[index] : *others[index - 3];
}
gpu::ExactSum& sum_of(gpu::FilmCover& cover, int index) {
  return const_cast<gpu::ExactSum&>(sum_of(std::as_const(cover), index));
}
std::uint32_t top_of(const gpu::FilmCover& cover, int index) { return cover.tops[index / 4] >> 8 * (index % 4) & 0xff; }
double total_of(const gpu::FilmCover& cover, int index) { return value_of(sum_of(cover, index), top_of(cover, index)); }

void join(gpu::FilmCover& cover, const gpu::FilmCover& other) {
  std::uint32_t tops[2] = {};
  for (int i = 0; i < kCoverSums; ++i) {
    std::uint32_t top = top_of(cover, i);
    add(sum_of(cover, i), top, sum_of(other, i), top_of(other, i));
    tops[i / 4] |= top << 8 * (i % 4);
  }
  std::copy_n(tops, 2, cover.tops);
  cover.count += other.count;
  cover.caught += other.caught;
}

void join(std::uint32_t sum[4], const std::uint32_t other[4]) {
  std::uint64_t carry = 0;
  for (int word = 0; word < 4; ++word) {
    carry += std::uint64_t{sum[word]} + other[word];
    sum[word] = static_cast<std::uint32_t>(carry);
    carry >>= 32;
  }
}

void join(gpu::SplatPixel& pixel, const gpu::SplatPixel& other) {
  join(pixel.red, other.red);
  join(pixel.green, other.green);
  join(pixel.blue, other.blue);
  pixel.largest = std::max(pixel.largest, other.largest); // positive floats are ordered as their bits
}

// Rounded to 53 bits, a pure function of the sum.
double value_of(const std::uint32_t sum[4]) {
  __extension__ using Wide = unsigned __int128;
  Wide value = 0;
  for (int word = 3; word >= 0; --word) value = value << 32 | sum[word];
  return std::ldexp(static_cast<double>(value), -static_cast<int>(gpu::kSplatFraction));
}

glm::dvec3 total_of(const gpu::SplatPixel& pixel) {
  return {value_of(pixel.red), value_of(pixel.green), value_of(pixel.blue)};
}

// The replicates of a pixel; the second is null where the pixel is not probed.
struct PixelReplicates {
  const gpu::FilmPixel *first, *second;
};
PixelReplicates replicates_of(const Film& film, std::size_t pixel) {
  if (!film.has_probes) return {&film.pixels[2 * pixel], &film.pixels[2 * pixel + 1]};
  const std::size_t block = block_of(film, pixel);
  const bool probed = probed_pixel(film, block) == pixel;
  return {&film.pixels[pixel], probed ? &film.pixels[film.shape().pixels() + block] : nullptr};
}

gpu::FilmCover cover_of(const Film& film, std::size_t pixel) {
  gpu::FilmCover cover = film.cover[pixel];
  if (!film.has_probes) return cover;
  const std::size_t block = block_of(film, pixel);
  if (probed_pixel(film, block) == pixel) join(cover, film.cover[film.shape().pixels() + block]);
  return cover;
}

// The share of light that arrives; all where there is none.
double arrived_share(const gpu::FilmCover& cover, int unblocked, int arrived) {
  const double all = total_of(cover, unblocked);
  return all > 0.0 ? std::clamp(total_of(cover, arrived) / all, 0.0, 1.0) : 1.0;
}

// Mean light that the light paths of one replicate brought to a pixel.
glm::dvec3 mean_splat(const Film& film, std::size_t pixel, std::uint32_t replicate) {
  const std::uint64_t paths = film.light_paths[replicate];
  if (film.splats.empty() || paths == 0) return glm::dvec3(0.0);
  return total_of(film.splats[pixel * gpu::kReplicates + replicate]) / static_cast<double>(paths);
}

glm::dvec3 mean_splat(const Film& film, std::size_t pixel) {
  if (film.splats.empty()) return glm::dvec3(0.0);
  gpu::SplatPixel all = film.splats[pixel * gpu::kReplicates];
  std::uint64_t paths = film.light_paths[0];
  for (std::uint32_t r = 1; r < gpu::kReplicates; ++r) {
    join(all, film.splats[pixel * gpu::kReplicates + r]);
    paths += film.light_paths[r];
  }
  return paths > 0 ? total_of(all) / static_cast<double>(paths) : glm::dvec3(0.0);
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
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

template <class Value>
void add_channel(Picture& picture, const std::string& name, Value value) {
  Channel channel{name, std::vector<float>(std::size_t{picture.width} * picture.height)};
  for (std::size_t i = 0; i < channel.values.size(); ++i) channel.values[i] = static_cast<float>(value(i));
  picture.channels.push_back(std::move(channel));
}

void add_aov(Picture& picture, const Film& film, const std::string& name, const glm::dvec3& origin) {
  constexpr float kNothing = 1e10f; // depth where nothing was hit, as other renderers write it
  std::vector<gpu::FilmAovs> aovs(film.aovs.empty() ? 0 : film.shape().pixels());
  for (std::size_t i = 0; i < aovs.size(); ++i) aovs[i] = mean_aovs(film, i);
  if (name == "albedo") {
    add_channels(picture, "albedo.", "RGB", [&](std::size_t i, int c) { return aovs[i].albedo[c]; });
  } else if (name == "normal") {
    add_channels(picture, "N.", "XYZ", [&](std::size_t i, int c) { return aovs[i].normal[c]; });
  } else if (name == "depth") {
    add_channels(picture, "", "Z", [&](std::size_t i, int) { return aovs[i].hits > 0.0f ? aovs[i].depth : kNothing; });
  } else if (name == "position") {
    add_channels(picture, "P.", "XYZ",
                 [&](std::size_t i, int c) { return aovs[i].hits > 0.0f ? aovs[i].position[c] + origin[c] : 0.0; });
  } else if (name == "ao") {
    add_channel(picture, "ao", [&](std::size_t i) { return aovs[i].unoccluded; });
  } else if (name == "roughness") {
    add_channel(picture, "roughness", [&](std::size_t i) { return aovs[i].roughness; });
  } else if (name == "metallic") {
    add_channel(picture, "metallic", [&](std::size_t i) { return aovs[i].metallic; });
  } else if (name == "ids") {
    const auto known = [&](std::size_t i, std::uint32_t id) {
      return aovs[i].hits > 0.0f ? static_cast<double>(id) : -1.0;
    };
    add_channel(picture, "id.triangle", [&](std::size_t i) { return known(i, aovs[i].triangle); });
    add_channel(picture, "id.instance", [&](std::size_t i) { return known(i, aovs[i].instance); });
    add_channel(picture, "id.material", [&](std::size_t i) { return known(i, aovs[i].material); });
  } else if (name == "variance") {
    add_channels(picture, "variance.", "RGB", [&](std::size_t i, int c) { return mean_variance(film, i)[c]; });
  } else if (name == "samples") {
    add_channel(picture, "samples", [&](std::size_t i) { return sample_count(film, i); });
  } else if (name == "shadow") {
    add_channel(picture, "shadow", [&](std::size_t i) { return lit_share(film, i); });
  } else if (name == "environment") {
    add_channels(picture, "environment.", "RGB", [&](std::size_t i, int c) {
      const gpu::FilmCover cover = cover_of(film, i);
      return cover.count > 0 ? total_of(cover, c) / cover.count : 0.0;
    });
  } else if (name == "direct") {
    add_channels(picture, "direct.", "RGB", [&](std::size_t i, int c) { return aovs[i].direct[c]; });
  } else if (name == "emission") {
    add_channels(picture, "emission.", "RGB", [&](std::size_t i, int c) { return aovs[i].emission[c]; });
  } else if (name == "indirect") {
    // The rest of the picture, so that emission + direct + indirect adds up to it.
    add_channels(picture, "indirect.", "RGB", [&](std::size_t i, int c) {
      return mean_radiance(film, i)[c] - aovs[i].direct[c] - aovs[i].emission[c];
    });
  }
}

// The number in `other` of a block of `film`, in another part of the same picture that has this block.
std::size_t block_there(const Film& film, std::size_t block, const Film& other) {
  const gpu::FilmArea own = film.shape().area(), there = other.shape().area();
  const std::uint32_t probes = film.shape().probes(), each = film.quads ? gpu::kQuadPixels : 1;
  const std::uint32_t x = gpu::probe_shift_x(own, probes), y = gpu::probe_shift_y(own, probes);
  const std::size_t across = gpu::blocks_touched(own.left, own.width, x), index = block / each;
  const std::size_t row = index / across + (own.top >> y) - (there.top >> y),
                    column = index % across + (own.left >> x) - (there.left >> x);
  return (row * gpu::blocks_touched(there.left, there.width, x) + column) * each + block % each;
}

// The place that a film has for the probed pixel of a block: its index, or pixels() + block if it lies outside.
std::uint32_t place_of_probed(const FilmShape& shape, std::uint32_t block) {
  const gpu::FilmArea area = shape.area();
  const std::uint32_t whole = gpu::block_in_picture(block, area, shape.probes());
  const glm::uvec2 at = gpu::probed_pixel(whole, area.whole_width, area.whole_height, shape.seed, shape.probes()) -
                        glm::uvec2(area.left, area.top);
  const bool within = at.x < shape.width && at.y < shape.height; // unsigned: also not left of it, nor above
  return within ? at.y * shape.width + at.x : static_cast<std::uint32_t>(shape.pixels()) + block;
}

} // namespace

std::uint64_t probes_within(const FilmShape& shape) {
  if (!shape.is_part()) return shape.probe_count();
  std::uint64_t count = 0;
  for (std::uint32_t block = 0; block < shape.probe_count(); ++block)
    count += place_of_probed(shape, block) < shape.pixels();
  return count;
}

std::uint32_t in_picture(const FilmShape& shape, std::uint32_t entry) {
  const gpu::FilmArea area = shape.area();
  const auto pixels = static_cast<std::uint32_t>(shape.pixels());
  if (entry < pixels) {
    if (!shape.is_part()) return entry;
    const glm::uvec2 at = gpu::pixel_in_tile_order(entry, area.width, area.height) + glm::uvec2(area.left, area.top);
    return gpu::tile_order_of(at, area.whole_width, area.whole_height);
  }
  const std::uint32_t block = gpu::block_in_picture(entry - pixels, area, shape.probes());
  const glm::uvec2 at = gpu::probed_pixel(block, area.whole_width, area.whole_height, shape.seed, shape.probes());
  return gpu::tile_order_of(at, area.whole_width, area.whole_height);
}

bool Film::operator==(const Film& other) const {
  return width == other.width && height == other.height && same_bytes(pixels, other.pixels) &&
         same_bytes(aovs, other.aovs) && same_bytes(groups, other.groups) &&
         same_bytes(group_splats, other.group_splats) && same_bytes(splats, other.splats) &&
         same_bytes(cover, other.cover) && light_paths == other.light_paths && has_probes == other.has_probes &&
         quads == other.quads && (!has_probes || seed == other.seed) && place == other.place &&
         same_bytes(beside, other.beside);
}

Film make_film(const FilmShape& shape) {
  Film film{shape.width, shape.height, std::vector<gpu::FilmPixel>(shape.replicates()), {}, {}, {}};
  if (shape.aovs) film.aovs.resize(shape.entries());
  if (shape.cover) film.cover.resize(shape.entries());
  if (shape.splats) film.splats.resize(gpu::kReplicates * shape.pixels());
  film.groups.resize(shape.entries() * shape.groups), film.group_count = shape.groups;
  if (shape.splats) film.group_splats.resize(shape.pixels() * shape.groups);
  film.has_probes = shape.has_probes, film.seed = shape.seed, film.quads = shape.quads;
  film.place = shape.place;
  film.probed.resize(shape.probe_count());
  bool all_within = true;
  for (std::uint32_t block = 0; block < film.probed.size(); ++block) {
    film.probed[block] = place_of_probed(shape, block);
    all_within &= film.probed[block] < shape.pixels();
  }
  if (!all_within) film.beside.resize(film.probed.size());
  return film;
}

Film cut(const Film& film, const FilmShape& part) {
  Film result = make_film(part);
  const gpu::FilmArea from = film.shape().area(), to = part.area();
  const std::size_t each = film.has_probes ? 1 : gpu::kReplicates;
  for (std::size_t y = 0; y < to.height; ++y) {
    const std::size_t first = (y + to.top - from.top) * from.width + to.left - from.left, at = y * to.width;
    std::copy_n(&film.pixels[first * each], to.width * each, &result.pixels[at * each]);
    if (part.aovs) std::copy_n(&film.aovs[first], to.width, &result.aovs[at]);
    if (part.splats)
      std::copy_n(&film.splats[first * gpu::kReplicates], to.width * gpu::kReplicates,
                  &result.splats[at * gpu::kReplicates]);
    if (part.cover) std::copy_n(&film.cover[first], to.width, &result.cover[at]);
    std::copy_n(film.groups.begin() + static_cast<std::ptrdiff_t>(first * part.groups), to.width * part.groups,
                result.groups.begin() + static_cast<std::ptrdiff_t>(at * part.groups));
    if (part.splats)
      std::copy_n(film.group_splats.begin() + static_cast<std::ptrdiff_t>(first * part.groups), to.width * part.groups,
                  result.group_splats.begin() + static_cast<std::ptrdiff_t>(at * part.groups));
  }
  for (std::size_t block = 0; block < result.probed.size(); ++block) {
    const std::size_t there = block_there(result, block, film);
    result.pixels[part.pixels() + block] = film.pixels[film.shape().pixels() + there];
    if (part.aovs) result.aovs[part.pixels() + block] = film.aovs[film.shape().pixels() + there];
    if (part.cover) result.cover[part.pixels() + block] = film.cover[film.shape().pixels() + there];
    for (std::uint32_t g = 0; g < part.groups; ++g)
      result.groups[(part.pixels() + block) * part.groups + g] =
          film.groups[(film.shape().pixels() + there) * part.groups + g];
    if (result.probed[block] < part.pixels()) continue;
    const std::size_t probed = film.probed[there];
    result.beside[block] = probed < film.shape().pixels() ? film.pixels[probed] : film.beside[there];
  }
  result.light_paths = film.light_paths;
  return result;
}

bool paste(Film& film, const Film& part, std::vector<bool>& known) {
  const gpu::FilmArea to = film.shape().area(), from = part.shape().area();
  const std::size_t each = film.has_probes ? 1 : gpu::kReplicates;
  const auto copy = [](const auto* values, std::size_t count, auto* there, bool is_known) {
    if (is_known && std::memcmp(values, there, count * sizeof(*values)) != 0) return false;
    std::copy_n(values, count, there);
    return true;
  };
  for (std::size_t i = 0; i < part.shape().pixels(); ++i) {
    const std::size_t at = (i / from.width + from.top - to.top) * to.width + i % from.width + from.left - to.left;
    if (!copy(&part.pixels[i * each], each, &film.pixels[at * each], known[at])) return false;
    if (!part.aovs.empty()) film.aovs[at] = part.aovs[i];
    if (!part.cover.empty()) film.cover[at] = part.cover[i];
    for (std::uint32_t g = 0; g < part.group_count; ++g) {
      film.groups[at * part.group_count + g] = part.groups[i * part.group_count + g];
      if (!part.group_splats.empty())
        film.group_splats[at * part.group_count + g] = part.group_splats[i * part.group_count + g];
    }
    if (!part.splats.empty() &&
        !copy(&part.splats[i * gpu::kReplicates], gpu::kReplicates, &film.splats[at * gpu::kReplicates], known[at]))
      return false;
    known[at] = true;
  }
  for (std::size_t block = 0; block < part.probed.size(); ++block) {
    const std::size_t there = block_there(part, block, film);
    film.pixels[film.shape().pixels() + there] = part.pixels[part.shape().pixels() + block];
    const bool within = part.probed[block] < part.shape().pixels(); // the part has its AOVs, groups and cover
    const std::size_t to_probe = film.shape().pixels() + there, from_probe = part.shape().pixels() + block;
    if (within && !part.aovs.empty()) film.aovs[to_probe] = part.aovs[from_probe];
    if (within && !part.cover.empty()) film.cover[to_probe] = part.cover[from_probe];
    for (std::uint32_t g = 0; within && g < part.group_count; ++g)
      film.groups[to_probe * part.group_count + g] = part.groups[from_probe * part.group_count + g];
    if (film.probed[there] >= film.shape().pixels()) film.beside[there] = part.beside[block];
  }
  film.light_paths = part.light_paths;
  return true;
}

// gpu::probe_block_of() with one division, in 32 bits.
std::size_t block_of(const Film& film, std::size_t pixel) {
  const gpu::FilmArea area = film.shape().area();
  const auto index = static_cast<std::uint32_t>(pixel), row = index / film.width;
  const std::uint32_t y = row + area.top, x = index - row * film.width + area.left;
  const std::uint32_t probes = film.quads ? gpu::kProbesQuads : gpu::kProbesPixels;
  const std::uint32_t shift_x = gpu::probe_shift_x(area, probes), shift_y = gpu::probe_shift_y(area, probes);
  const std::size_t across = gpu::blocks_touched(area.left, area.width, shift_x);
  const std::size_t block = ((y >> shift_y) - (area.top >> shift_y)) * across + (x >> shift_x) - (area.left >> shift_x);
  if (!film.quads) return block;
  const std::uint32_t entry = gpu::tile_order_of({x, y}, area.whole_width, area.whole_height);
  return block * gpu::kQuadPixels + entry % gpu::kQuadPixels;
}

std::size_t probed_pixel(const Film& film, std::size_t block) { return film.probed[block]; }

std::size_t pixels_probed_by(const Film& film, std::size_t probed) {
  const gpu::FilmArea area = film.shape().area();
  if (film.quads) {
    const auto own = static_cast<std::uint32_t>(block_of(film, probed));
    const std::uint32_t block = gpu::block_in_picture(own, area, gpu::kProbesQuads), rank = block % gpu::kQuadPixels;
    const gpu::TileBlock all = gpu::tile_block(block / gpu::kQuadPixels, area.whole_width, area.whole_height);
    return (all.pixels - rank + gpu::kQuadPixels - 1) / gpu::kQuadPixels; // every fourth, from that rank on
  }
  const std::size_t whole = gpu::probe_block_side(area.whole_width, area.whole_height);
  const auto side = [&](std::size_t at, std::uint32_t size) { return std::min(whole, size - at / whole * whole); };
  return side(probed % film.width + area.left, area.whole_width) *
         side(probed / film.width + area.top, area.whole_height);
}

void join(Film& film, const Film& other) {
  for (std::size_t i = 0; i < film.pixels.size(); ++i) join(film.pixels[i], other.pixels[i]);
  for (std::size_t i = 0; i < film.aovs.size(); ++i) join(film.aovs[i], other.aovs[i]);
  for (std::size_t i = 0; i < film.splats.size(); ++i) join(film.splats[i], other.splats[i]);
  for (std::size_t i = 0; i < film.groups.size(); ++i) join(film.groups[i], other.groups[i]);
  for (std::size_t i = 0; i < film.group_splats.size(); ++i) join(film.group_splats[i], other.group_splats[i]);
  for (std::size_t i = 0; i < film.cover.size(); ++i) join(film.cover[i], other.cover[i]);
  for (std::size_t i = 0; i < film.beside.size(); ++i) join(film.beside[i], other.beside[i]);
  for (std::size_t r = 0; r < gpu::kReplicates; ++r) film.light_paths[r] += other.light_paths[r];
}

void count_light_paths(Film& film) {
  film.light_paths = {};
  if (film.splats.empty()) return;
  for (std::size_t i = 0; i < film.pixels.size(); ++i) film.light_paths[i % gpu::kReplicates] += film.pixels[i].count;
}

std::uint32_t sample_count(const Film& film, std::size_t pixel) {
  const auto [a, b] = replicates_of(film, pixel);
  return a->count + (b ? b->count : 0);
}

double clamped_fraction(const Film& film, double radiance) {
  double kept = 0.0, lost = 0.0;
  for (const gpu::FilmPixel& pixel : film.pixels) {
    if (pixel.count == 0) continue;
    const glm::dvec3 total = total_of(pixel);
    kept += (total.r + total.g + total.b) / pixel.count;
    lost += radiance / gpu::kClampUnits * pixel.clamped / pixel.count;
  }
  return lost > 0.0 ? lost / (kept + lost) : 0.0;
}

double transparency(const Film& film, std::size_t pixel) {
  if (film.cover.empty()) return 0.0;
  const gpu::FilmCover cover = cover_of(film, pixel);
  if (cover.count == 0) return 0.0;
  const double seen = total_of(cover, 3) + cover.caught * arrived_share(cover, 6, 7);
  return std::clamp(seen / cover.count, 0.0, 1.0);
}

double lit_share(const Film& film, std::size_t pixel) {
  return film.cover.empty() ? 1.0 : arrived_share(cover_of(film, pixel), 4, 5);
}

float largest_sample(const Film& film, std::size_t pixel) {
  const auto [a, b] = replicates_of(film, pixel);
  return std::max(a->largest, b ? b->largest : 0.0f);
}

glm::dvec3 mean_radiance(const Film& film, std::size_t pixel) {
  const auto [a, b] = replicates_of(film, pixel);
  gpu::FilmPixel all = *a;
  if (b) join(all, *b);
  const glm::dvec3 mean = all.count > 0 ? total_of(all) / static_cast<double>(all.count) : glm::dvec3(0.0);
  return mean + mean_splat(film, pixel);
}

glm::dvec3 mean_group(const Film& film, std::size_t pixel, std::uint32_t group) {
  gpu::FilmPixel all = film.groups[pixel * film.group_count + group];
  if (film.has_probes) {
    const std::size_t block = block_of(film, pixel);
    if (probed_pixel(film, block) == pixel)
      join(all, film.groups[(film.shape().pixels() + block) * film.group_count + group]);
  }
  glm::dvec3 mean = all.count > 0 ? total_of(all) / static_cast<double>(all.count) : glm::dvec3(0.0);
  std::uint64_t paths = 0;
  for (const std::uint64_t of_replicate : film.light_paths) paths += of_replicate;
  if (!film.group_splats.empty() && paths > 0)
    mean += total_of(film.group_splats[pixel * film.group_count + group]) / static_cast<double>(paths);
  return mean;
}

gpu::FilmAovs mean_aovs(const Film& film, std::size_t pixel) {
  gpu::FilmAovs mean = film.aovs[pixel];
  if (!film.has_probes) return mean;
  const std::size_t block = block_of(film, pixel);
  if (probed_pixel(film, block) == pixel) join(mean, film.aovs[film.shape().pixels() + block]);
  return mean;
}

// Means a, b of two replicates of n and m samples have the variances v / n and v / m, whose sum (a - b)^2 estimates. So
// a mean of k samples has the variance v / k = (a - b)^2 nm / (n + m) / k; for the mean of both, with n = m, that is
// (a - b)^2 / 4.
ReplicateDifference replicate_difference(const Film& film, std::size_t probed) {
  static_assert(gpu::kReplicates == 2);
  const std::size_t pixels = film.shape().pixels();
  const auto [a, b] = probed < pixels ? replicates_of(film, probed)
                                      : PixelReplicates{&film.beside[probed - pixels], &film.pixels[probed]};
  const double n = a->count, m = b->count;
  if (n == 0.0 || m == 0.0) return {probed, glm::dvec3(0.0), n, m};
  const glm::dvec3 difference =
      total_of(*a) / n - total_of(*b) / m + mean_splat(film, probed, 0) - mean_splat(film, probed, 1);
  return {probed, difference * difference, n, m};
}

PixelStatistics statistics(const Film& film, std::size_t pixel, const ReplicateDifference& replicates) {
  const double n = replicates.first, m = replicates.second;
  const double count = pixel == replicates.probed ? n + m : film.pixels[pixel].count;
  if (n == 0.0 || m == 0.0 || count == 0.0)
    return {mean_radiance(film, pixel), glm::dvec3(std::numeric_limits<double>::quiet_NaN())};
  glm::dvec3 sum;
  if (pixel == replicates.probed) {
    const auto [a, b] = replicates_of(film, pixel);
    sum = total_of(*a) + total_of(*b);
  } else {
    sum = total_of(film.pixels[pixel]);
  }
  return {sum / count + mean_splat(film, pixel), replicates.squared * (n * m / ((n + m) * count))};
}

PixelStatistics statistics(const Film& film, std::size_t pixel) {
  const std::size_t probed = film.has_probes ? probed_pixel(film, block_of(film, pixel)) : pixel;
  return statistics(film, pixel, replicate_difference(film, probed));
}

glm::dvec3 mean_variance(const Film& film, std::size_t pixel) { return statistics(film, pixel).variance; }

Picture develop(const Film& film, const std::vector<std::string>& aovs, const glm::dvec3& origin,
                const std::vector<std::string>& groups) {
  Picture picture{film.width, film.height, {}};
  picture.place = film.place;
  std::vector<glm::vec3> means;
  means.reserve(std::size_t{film.width} * film.height);
  for (std::size_t i = 0; i < std::size_t{film.width} * film.height; ++i) means.emplace_back(mean_radiance(film, i));
  add_channels(picture, "", "RGB", [&](std::size_t i, int c) { return means[i][c]; });
  add_channels(picture, "", "A", [&](std::size_t i, int) { return 1.0 - transparency(film, i); });
  for (const std::string& name : aovs) add_aov(picture, film, name, origin);
  const std::vector<std::string> layers = group_layers(groups);
  for (std::uint32_t g = 0; g < std::min<std::size_t>(film.group_count, groups.size()); ++g)
    add_channels(picture, layers[g] + ".", "RGB", [&](std::size_t i, int c) { return mean_group(film, i, g)[c]; });
  if (film.group_count > 0 && !groups.empty()) picture.texts.push_back(group_names_text(groups));
  return picture;
}

} // namespace wavepath
