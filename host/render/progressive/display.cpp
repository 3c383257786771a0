#include "host/render/progressive/display.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/packing.hpp>

#include "host/gpu/commands.h"
#include "kernels/display/display.spv.h"
#include "kernels/film/cover_types.h"

namespace wavepath {
namespace {

// Screen pixels of one dispatch: some 10 ms on two cores.
constexpr std::uint32_t kDispatchPixels = 1u << 18;
static_assert(kDispatchPixels % gpu::kWorkgroupSize == 0);

std::vector<Binding> bindings_of(const Buffer& film, const Buffer& aovs, const Buffer& splats, const Buffer& groups,
                                 const Buffer& cover, const Buffer& screen) {
  return {{gpu::kBindFilmTexels, BindingKind::texels_rgba32ui, &film},
          {gpu::kBindFilmAovs, BindingKind::texels_rgba32f, &aovs},
          {gpu::kBindFilmAovWords, BindingKind::texels_rgba32ui, &aovs},
          {gpu::kBindSplats, BindingKind::storage, &splats},
          {gpu::kBindFilmGroups, BindingKind::storage, &groups},
          {gpu::kBindFilmCover, BindingKind::storage, &cover},
          {gpu::kBindScreen, BindingKind::storage, &screen}};
}

bool needs_aovs(Shown shown) { return (shown >= Shown::albedo && shown <= Shown::emission) || shown >= Shown::ao; }

// Default of the brightest value shown: for errors half the pixel's value, for distances the scene's diameter.
double automatic_range(Shown shown, const Progressive& progressive) {
  constexpr double kError = 0.5;
  if (shown == Shown::samples) return std::max(progressive.status().spp, 1u);
  if (shown == Shown::error) return kError;
  return std::max(2.0 * progressive.scene().radius, 1e-30);
}

} // namespace

bool can_show(const IntegratorKind& integrator, Shown shown) {
  return shown != Shown::ao || std::ranges::count(integrator.aovs, kShownNames[static_cast<std::size_t>(shown)]) > 0;
}

std::vector<std::string> aovs_for(Shown shown) {
  if (shown == Shown::shadow_error) return {"direct"};
  if (shown >= Shown::triangles) return {"ids"};
  return needs_aovs(shown) ? std::vector<std::string>{std::string(kShownNames[static_cast<std::size_t>(shown)])}
                           : std::vector<std::string>{};
}

Display::Display(Device& device) : device_(device), pixels_(device, 0) {
  const Buffer dummy(device, 0);
  const BindingSet bindings(device, bindings_of(dummy, dummy, dummy, dummy, dummy, dummy), sizeof(gpu::DisplayJob));
  kernel_.emplace(device, "display", wavepath_display_spv, bindings, std::span<const std::uint32_t>());
}

void Display::draw(const Progressive& progressive, const DisplayOptions& options, std::uint32_t first_column) {
  const RenderPlan& settings = progressive.settings();
  const FilmTarget& film = progressive.film_target();
  const FilmShape& shape = film.shape();
  const std::uint32_t width = options.coarse ? shape.width : settings.width,
                      height = options.coarse ? shape.height : settings.height;
  if (width != width_ || height != height_) resize(width, height);
  const bool lacks = options.shown == Shown::shadow_error || (needs_aovs(options.shown) && !shape.aovs) ||
                     !can_show(*settings.integrator, options.shown);
  const Shown shown = lacks ? Shown::color : options.shown;
  gpu::DisplayJob job{};
  job.width = width_;
  job.height = height_;
  job.film_width = shape.width;
  job.film_height = shape.height;
  job.shown = static_cast<std::uint32_t>(shown);
  job.tonemap = static_cast<std::uint32_t>(options.tonemap);
  job.bgra = options.bgra ? 1 : 0;
  job.first_column = first_column;
  job.splats = shape.splats ? 1 : 0;
  job.covers = shape.cover ? 1 : 0;
  job.probes = shape.probes();
  job.seed = shape.seed;
  job.gain = static_cast<float>(std::exp2(options.exposure));
  job.range = static_cast<float>(options.range > 0.0 ? options.range : automatic_range(shown, progressive));
  if (options.mixes() && options.group_gains.size() == shape.groups) {
    job.groups = shape.groups;
    for (std::uint32_t g = 0; g < shape.groups; ++g)
      job.gains[g / 2] |= static_cast<std::uint32_t>(glm::packHalf1x16(options.group_gains[g])) << 16 * (g % 2);
  }
  for (const FilmBand& band : film.bands()) {
    if (band.pixel_count == 0) continue;
    job.first_film_pixel = band.first_pixel;
    job.film_pixel_count = band.pixel_count;
    job.first_probe = band.first_probe;
    draw_band(band, job);
  }
}

void Display::show(const Picture& picture, bool bgra) {
  if (picture.width != width_ || picture.height != height_ || picture.channels.size() < 3) return;
  std::vector<std::uint32_t> words(std::size_t{width_} * height_);
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] = 0xff000000u;
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = to_srgb(std::clamp(picture.channels[c].values[i], 0.0f, 1.0f));
      words[i] |= static_cast<std::uint32_t>(value * 255.0f + 0.5f) << 8 * (bgra ? 2 - c : c);
    }
  }
  pixels_.write(words.data(), words.size() * sizeof(std::uint32_t));
}

void Display::draw_band(const FilmBand& band, gpu::DisplayJob job) {
  const Buffer& groups = job.groups > 0 ? band.groups : pixels_; // whichever: without groups nobody reads it
  const Buffer& cover = job.covers > 0 ? band.cover : pixels_;
  const BindingSet bindings(device_, bindings_of(band.film, band.aovs, band.splats, groups, cover, pixels_),
                            sizeof(gpu::DisplayJob));
  Commands commands(device_);
  commands.bind(bindings);
  const std::uint32_t pixels = width_ * height_;
  for (std::uint32_t first = 0; first < pixels; first += kDispatchPixels) {
    job.first = first;
    const std::uint32_t count = std::min(kDispatchPixels, pixels - first);
    commands.dispatch(*kernel_, (count + gpu::kWorkgroupSize - 1) / gpu::kWorkgroupSize, &job);
  }
  commands.submit_and_wait();
}

void Display::resize(std::uint32_t width, std::uint32_t height) {
  const std::uint64_t bytes = std::uint64_t{width} * height * sizeof(std::uint32_t);
  pixels_ = Buffer();
  pixels_ = Buffer(device_, bytes);
  pixels_.fill_zero();
  width_ = width;
  height_ = height;
}

} // namespace wavepath
