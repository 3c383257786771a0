#include "host/integrators/hybrid/filter_bands.h"

#include <algorithm>

namespace wavepath {
namespace {

// An a-trous iteration, the slowest filter, reads 50 texels a pixel: below half a microsecond on a core of a CPU
// device, so that a strip of tiles stays below 70 ms even on one; a GPU does a million pixels in a few milliseconds.
constexpr std::uint32_t kTilesOfCpu = 2048, kTilesOfGpu = 16384;

bool same_view(const gpu::CameraView& a, const gpu::CameraView& b) {
  return a.position == b.position && a.right == b.right && a.up == b.up && a.forward == b.forward &&
         a.orthographic == b.orthographic;
}

std::uint32_t tiles_along(std::uint32_t pixels) { return (pixels + gpu::kFilterTile - 1) / gpu::kFilterTile; }

} // namespace

FilterBands::FilterBands(const Device& device, std::uint32_t width, std::uint32_t height, std::uint32_t cost)
    : tiles_(tiles_along(width) * tiles_along(height)),
      tiles_per_band_(
          std::min((device.info().type == "cpu" ? kTilesOfCpu : kTilesOfGpu) / cost, device.info().max_groups)) {}

void FilterBands::run_band(Commands& commands, const Kernel& kernel, std::uint32_t band, std::uint32_t step) const {
  const gpu::FilterBand constants{band * tiles_per_band_, step};
  commands.dispatch(kernel, std::min(tiles_per_band_, tiles_ - constants.first_tile), &constants);
  commands.barrier();
}

void FilterBands::run(Commands& commands, const Kernel& kernel, std::uint32_t step) const {
  for (std::uint32_t band = 0; band < count(); ++band) run_band(commands, kernel, band, step);
}

gpu::Reprojection reproject(const gpu::CameraView& now, const gpu::CameraView& before, bool remembers,
                            std::uint32_t width, std::uint32_t height) {
  return {now, before, width, height, remembers ? 1u : 0u, remembers && same_view(now, before) ? 1u : 0u};
}

} // namespace wavepath
