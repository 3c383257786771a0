#include "host/render/loop/integrator.h"

#include "host/render/workspace/film_target.h"
#include "kernels/base/wave.h"

namespace wavepath {

gpu::Wave Integrator::wave(const FilmBand& band, std::uint32_t first_entry, std::uint32_t pixel_count,
                           std::uint32_t first_sample, std::uint32_t count) const {
  return gpu::even_wave(first_entry, pixel_count, first_sample, count, first_entry - band.offset_of(first_entry));
}

} // namespace wavepath
