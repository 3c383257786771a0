// Applies a filter to a picture strip by strip, so that every dispatch is short enough for any device.
#pragma once

#include <cstdint>

#include "host/gpu/commands.h"
#include "host/render/workspace/resources.h"
#include "kernels/hybrid/filter_types.h"

namespace wavepath {

class FilterBands {
public:
  // `cost`: how often a pixel takes the time of one of the other filters.
  FilterBands(const Device& device, std::uint32_t width, std::uint32_t height, std::uint32_t cost = 1);

  std::uint32_t count() const { return (tiles_ + tiles_per_band_ - 1) / tiles_per_band_; }
  // Runs a kernel, whose bindings must be bound, on one band of count(), or on all. Ends with a barrier.
  void run_band(Commands& commands, const Kernel& kernel, std::uint32_t band, std::uint32_t step = 0) const;
  void run(Commands& commands, const Kernel& kernel, std::uint32_t step = 0) const;

private:
  std::uint32_t tiles_, tiles_per_band_;
};

// Bytes of a buffer with a vec4 for each pixel.
inline std::uint64_t vec4_a_pixel(const BufferDimensions& dimensions) { return dimensions.pixels * sizeof(gpu::vec4); }

// Constants that filters over time need of two frames. `remembers`: false = there is no frame before, and `before` is
// ignored.
gpu::Reprojection reproject(const gpu::CameraView& now, const gpu::CameraView& before, bool remembers,
                            std::uint32_t width, std::uint32_t height);

} // namespace wavepath
