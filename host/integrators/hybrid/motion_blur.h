// Motion blur of finished frames: what moves is spread along its way while the shutter is open (McGuire, Hennessy,
// Bukowski and Osman 2012).
#pragma once

#include <cstdint>
#include <memory>

#include "host/gpu/commands.h"
#include "host/integrators/hybrid/filter_bands.h"
#include "host/render/settings/render_plan.h"
#include "host/render/workspace/resources.h"
#include "kernels/hybrid/filter_types.h"

namespace wavepath {

inline constexpr const char* kMotionBlurStage = "motion blur"; // name of its time among the stages of a render

// Frames are blurred: the integrator knows --shutter, and something moves while it is open.
bool blurs_motion(const RenderPlan& settings);

// Throws UsageError for settings that draw surfaces, which would show them where they are as the shutter opens.
void check_motion_settings(const RenderPlan& settings);

class MotionBlur {
public:
  // `gbuffer`: gpu::GbufferPixel. `velocities`: vec2, see gpu::kBindVelocities. `color`: vec4, linear. All are
  // row-major and must outlive this object.
  MotionBlur(Device& device, std::uint32_t width, std::uint32_t height, const Buffer& gbuffer, const Buffer& velocities,
             const Buffer& color);
  MotionBlur(MotionBlur&&) = delete;

  // Finds the longest velocity of every tile; then each band of bands() blurs `color` into a part of result(). A band
  // is short enough for a submission of its own. Barriers before and after are not needed. Both leave their own
  // bindings bound.
  void record_tiles(Commands& commands);
  void record_blur(Commands& commands, std::uint32_t band);
  std::uint32_t bands() const { return bands_.count(); }

  // The blurred colour: vec4, row-major.
  const Buffer& result() const { return buffers_[kResult]; }
  std::uint64_t bytes() const { return buffers_.bytes(); } // of device memory
  // The velocities that it needs included.
  static std::uint64_t bytes_per_pixel() { return sizeof(gpu::vec4) + 2 * sizeof(gpu::vec2); }

private:
  enum OwnBuffer { kFrame, kResult, kTileVelocities };
  std::uint32_t width_, height_;
  FilterBands tile_bands_, bands_;
  BufferSet buffers_;
  std::unique_ptr<BindingSet> set_;
  std::unique_ptr<Kernel> tiles_, blur_;
};

} // namespace wavepath
