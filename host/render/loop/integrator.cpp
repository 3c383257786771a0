#include "host/render/loop/integrator.h"

#include "host/render/workspace/film_target.h"
#include "kernels/base/wave.h"

namespace wavepath {

gpu::Wave Integrator::wave(const FilmBand& band, std::uint32_t first_place, std::uint32_t pixel_count,
                           std::uint32_t first_sample, std::uint32_t count) const {
  return gpu::even_wave(first_place, pixel_count, first_sample, count, first_place - band.entry_of(first_place));
}

} // namespace wavepath
