#include "host/render/loop/segments.h"

#include <array>

#include "host/render/workspace/levels.h"

namespace wavepath {

std::vector<Segment> even_segments(const std::vector<FilmBand>& bands) {
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < bands.size(); ++i)
    if (bands[i].pixel_count > 0) segments.push_back({i, bands[i].first_pixel, bands[i].pixel_count, 0});
  return segments;
}

std::vector<Segment> all_segments(const FilmTarget& film) {
  std::vector<Segment> segments;
  const auto pixels = static_cast<std::uint32_t>(film.pixels());
  for (std::size_t i = 0; i < film.bands().size(); ++i) {
    const FilmBand& band = film.bands()[i];
    if (band.pixel_count == 0) continue;
    segments.push_back({i, band.first_pixel, band.pixel_count, 0});
    const std::uint32_t first_probe = pixels + band.first_probe;
    if (first_probe == band.first_pixel + band.pixel_count) // in a picture of one band: one segment holds all
      segments.back().pixel_count += band.probe_count;
    else if (band.probe_count > 0)
      segments.push_back({i, first_probe, band.probe_count, 0});
  }
  return segments;
}

std::vector<Segment> level_segments(const FilmTarget& film, const std::vector<std::int8_t>& levels,
                                    std::vector<std::uint32_t>& entries) {
  const FilmShape& shape = film.shape();
  const auto pixels = static_cast<std::uint32_t>(shape.pixels());
  const auto level_of = [&](std::uint32_t entry) { return levels[in_picture(shape, entry) / kRunPixels]; };
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < film.bands().size(); ++i) {
    const FilmBand& band = film.bands()[i];
    std::array<std::vector<std::uint32_t>, kHighestLevel - kLowestLevel + 1> firsts, seconds;
    const std::uint32_t end = band.first_pixel + band.pixel_count;
    for (std::uint32_t pixel = band.first_pixel; pixel < end; ++pixel)
      firsts[level_of(pixel) - kLowestLevel].push_back(pixel);
    for (std::uint32_t block = band.first_probe; block < band.first_probe + band.probe_count; ++block)
      seconds[level_of(pixels + block) - kLowestLevel].push_back(pixels + block);
    const auto add = [&](const std::vector<std::uint32_t>& list, int level) {
      const auto first = static_cast<std::uint32_t>(entries.size()), count = static_cast<std::uint32_t>(list.size());
      if (count == 0) return;
      entries.insert(entries.end(), list.begin(), list.end());
      const bool goes_on = !segments.empty() && segments.back().level == level && band.pixel_count == pixels;
      if (goes_on) // in a picture of one band: one segment holds pixels and probes, as in all_segments()
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
