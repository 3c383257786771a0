#include "host/render/loop/integrator.h"

#include "host/render/device/film_target.h"

namespace wavepath {

gpu::Wave Integrator::wave(const FilmBand& band, std::uint32_t first_place, std::uint32_t pixel_count,
                           std::uint32_t first_sample, std::uint32_t count) const {
  gpu::Wave wave{first_place, pixel_count, first_sample, count, 0, first_place - band.entry_of(first_place), {}};
  wave.level_places[gpu::kHighestLevel] = pixel_count; // level 0
  return wave;
}

} // namespace wavepath
