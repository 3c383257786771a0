#include "host/render/loop/segments.h"

#include <array>

#include "host/render/workspace/levels.h"
#include "kernels/base/net_layout.h"
#include "kernels/base/tile_order.h"

namespace wavepath {

std::vector<Segment> even_segments(const std::vector<FilmBand>& bands) {
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < bands.size(); ++i)
    if (bands[i].pixel_count > 0) segments.push_back({i, bands[i].first_pixel, bands[i].pixel_count, 0});
  return segments;
}

std::vector<Segment> net_segments(const FilmTarget& film) {
  std::vector<Segment> segments;
  const auto pixels = static_cast<std::uint32_t>(film.pixels());
  for (std::size_t i = 0; i < film.bands().size(); ++i) {
    const FilmBand& band = film.bands()[i];
    if (band.pixel_count == 0) continue;
    segments.push_back({i, band.first_pixel, band.pixel_count, 0});
    const std::uint32_t first_second = pixels + band.first_second;
    if (first_second == band.first_pixel + band.pixel_count) // in a picture of one band: one segment holds all
      segments.back().pixel_count += band.second_count;
    else if (band.second_count > 0)
      segments.push_back({i, first_second, band.second_count, 0});
  }
  return segments;
}

std::vector<Segment> level_segments(const FilmTarget& film, const std::vector<std::int8_t>& levels,
                                    std::vector<std::uint32_t>& places) {
  const FilmShape& shape = film.shape();
  const auto pixels = static_cast<std::uint32_t>(shape.pixels());
  const auto second_net_level = [&](std::uint32_t block) {
    const glm::uvec2 measured = gpu::measured_pixel(block, shape.width, shape.height, shape.seed, shape.measures());
    return levels[gpu::tile_order_of(measured, shape.width, shape.height) / kRunPixels];
  };
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < film.bands().size(); ++i) {
    const FilmBand& band = film.bands()[i];
    std::array<std::vector<std::uint32_t>, kHighestLevel - kLowestLevel + 1> firsts, seconds;
    const std::uint32_t end = band.first_pixel + band.pixel_count;
    for (std::uint32_t pixel = band.first_pixel; pixel < end; ++pixel)
      firsts[levels[pixel / kRunPixels] - kLowestLevel].push_back(pixel);
    for (std::uint32_t block = band.first_second; block < band.first_second + band.second_count; ++block)
      seconds[second_net_level(block) - kLowestLevel].push_back(pixels + block);
    const auto add = [&](const std::vector<std::uint32_t>& net, int level) {
      const auto first = static_cast<std::uint32_t>(places.size()), count = static_cast<std::uint32_t>(net.size());
      if (count == 0) return;
      places.insert(places.end(), net.begin(), net.end());
      const bool goes_on = !segments.empty() && segments.back().level == level && band.pixel_count == pixels;
      if (goes_on) // in a picture of one band: one segment holds both nets, as in net_segments()
        segments.back().pixel_count += count;
      else
        segments.push_back({i, first, count, level});
    };
    for (int level = kHighestLevel; level >= kLowestLevel; --level) { // noisy ones first, in case a pass is cut short
      add(firsts[level - kLowestLevel], level);
      add(seconds[level - kLowestLevel], level);
    }
  }
  return segments;
}

} // namespace wavepath
