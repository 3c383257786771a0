// Depth of field of finished frames: each pixel is spread over the disc that a thin lens makes of its point (Potmesil
// and Chakravarty 1981).
#pragma once

#include <cstdint>
#include <memory>

#include "host/gpu/commands.h"
#include "host/integrators/hybrid/filter_bands.h"
#include "host/render/workspace/resources.h"
#include "kernels/base/frame_types.h"
#include "kernels/hybrid/filter_types.h"

namespace wavepath {

// The lens of a frame, whose `lens_radius` is above 0.
gpu::DefocusLens defocus_lens(const gpu::Frame& frame);

class Defocus {
public:
  // `gbuffer`: gpu::GbufferPixel. `color`: vec4, linear. Both are row-major and must outlive this object.
  Defocus(Device& device, std::uint32_t width, std::uint32_t height, const Buffer& gbuffer, const Buffer& color);
  Defocus(Defocus&&) = delete;

  // Spreads `color` into result(). Barriers before and after are not needed. Leaves its own bindings bound.
  void record(Commands& commands, const gpu::DefocusLens& lens);

  // The colour seen through the lens: vec4, row-major.
  const Buffer& result() const { return buffers_[kResult]; }
  std::uint64_t bytes() const { return buffers_.bytes(); } // of device memory
  static std::uint64_t bytes_per_pixel() { return 2 * sizeof(gpu::vec4); }

private:
  enum OwnBuffer { kFrame, kLens, kResult, kSpots, kTileSpots };
  std::uint32_t width_, height_;
  FilterBands spot_bands_, bands_;
  BufferSet buffers_;
  std::unique_ptr<BindingSet> set_;
  std::unique_ptr<Kernel> spots_, spread_;
};

} // namespace wavepath
