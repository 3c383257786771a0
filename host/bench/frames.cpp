#include "host/bench/frames.h"

#include <algorithm>
#include <chrono>

namespace wavepath {

FrameTime render_frame(PathTracer& tracer, std::uint32_t spp) {
  tracer.reset();
  FrameTime time;
  const auto start = std::chrono::steady_clock::now();
  for (std::uint32_t sample = 0; sample < spp; ++sample)
    for (const FilmBand& band : tracer.bands())
      for (std::uint32_t done = 0; done < band.pixel_count;) {
        const std::uint32_t count = std::min(tracer.slots(), band.pixel_count - done);
        tracer.render_wave(band, band.first_pixel + done, count, sample, 1);
        done += count;
      }
  time.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  time.stages = tracer.stages();
  time.rays = ray_counts(tracer.counters());
  return time;
}

std::uint32_t choose_frame_spp(PathTracer& tracer) {
  constexpr double kLongEnough = 0.33; // seconds
  std::uint32_t spp = 1;
  while (spp < 64 && render_frame(tracer, spp).seconds < kLongEnough) spp *= 2;
  return spp;
}

} // namespace wavepath
