#include "host/render/loop/segments.h"

#include <algorithm>

#include "host/render/loop/adaptive.h"

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

std::vector<Segment> level_segments(const std::vector<FilmBand>& bands, const std::vector<std::int8_t>& levels,
                                    std::vector<std::uint32_t>& runs) {
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < bands.size(); ++i)
    for (int level = kLowestLevel; level <= kHighestLevel; ++level) {
      const FilmBand& band = bands[i];
      Segment segment{i, static_cast<std::uint32_t>(runs.size()) * gpu::kRunPixels, 0, level};
      const std::uint32_t end = band.first_pixel + band.pixel_count;
      for (std::uint32_t first = band.first_pixel; first < end; first += gpu::kRunPixels) {
        if (levels[first / gpu::kRunPixels] != level) continue;
        runs.push_back(first / gpu::kRunPixels);
        segment.pixel_count += std::min(gpu::kRunPixels, end - first); // only the picture's last run is shorter
      }
      if (segment.pixel_count > 0) segments.push_back(segment);
    }
  return segments;
}

} // namespace wavepath
