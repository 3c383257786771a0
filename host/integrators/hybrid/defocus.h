// Depth of field of finished frames: each pixel is spread over the disc that a thin lens makes of its point (Potmesil
// and Chakravarty 1981).
#pragma once

#include <cstdint>
#include <memory>

#include "host/gpu/commands.h"
#include "host/integrators/hybrid/filter_bands.h"
#include "host/render/settings/render_plan.h"
#include "host/render/workspace/resources.h"
#include "kernels/base/frame_types.h"
#include "kernels/hybrid/filter_types.h"

namespace wavepath {

// Frames are spread: the integrator knows --aperture, and it is open.
bool has_lens(const RenderPlan& settings);
// The lens of a frame, whose `lens_radius` is above 0.
gpu::DefocusLens defocus_lens(const gpu::Frame& frame);

class Defocus {
public:
  // `gbuffer`: gpu::GbufferPixel. `color`: vec4, linear. Both are row-major and must outlive this object.
  Defocus(Device& device, std::uint32_t width, std::uint32_t height, const Buffer& gbuffer, const Buffer& color);
  Defocus(Defocus&&) = delete;

  // Finds the spots of all pixels; then each band of bands() spreads `color` into a part of result(). A band is short
  // enough for a submission of its own. Barriers before and after are not needed. Both leave their own bindings bound.
  void record_spots(Commands& commands, const gpu::DefocusLens& lens);
  void record_spread(Commands& commands, std::uint32_t band);
  std::uint32_t bands() const { return bands_.count(); }

  // The colour seen through the lens: vec4, row-major.
  const Buffer& result() const { return buffers_[kResult]; }
  std::uint64_t bytes() const { return buffers_.bytes(); } // of device memory
  static std::uint64_t bytes_per_pixel() { return 2 * sizeof(gpu::vec4) + sizeof(float); }

private:
  enum OwnBuffer { kFrame, kLens, kResult, kSpots, kTileSpots };
  std::uint32_t width_, height_;
  FilterBands spot_bands_, bands_;
  BufferSet buffers_;
  std::unique_ptr<BindingSet> set_;
  std::unique_ptr<Kernel> spots_, spread_;
};

} // namespace wavepath
