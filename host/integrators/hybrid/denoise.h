// The filter of the hybrid's noisy signals over space and time (SVGF: Schied et al. 2017): direct light and ambient
// occlusion.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "host/gpu/commands.h"
#include "host/integrators/hybrid/filter_bands.h"
#include "host/render/workspace/resources.h"
#include "kernels/hybrid/filter_types.h"

namespace wavepath {

class Denoiser {
public:
  // `gbuffer`: gpu::GbufferPixel, row-major, of the frame that record() will find. `signals`: vec4, likewise; the
  // direct light in xyz, the unoccluded fraction in w. `wanted`: kHybridLights, kHybridAmbient or both; the other
  // passes through. Both buffers outlive the denoiser.
  Denoiser(Device& device, std::uint32_t width, std::uint32_t height, const Buffer& gbuffer, const Buffer& signals,
           std::uint32_t wanted);
  Denoiser(Denoiser&&) = delete;

  // Filters `signals` in place and remembers the frame for the next. `now` is how its G-buffer was seen; the geometry
  // stands still. What wrote the inputs needs no barrier, nor does what reads the result. Ends with its own bindings
  // bound.
  void record(Commands& commands, const gpu::CameraView& now);
  // A cut, or a change of what is to be seen: the next frame has no history.
  void forget();

  static std::uint64_t bytes_per_pixel(); // of device memory, as is the next
  std::uint64_t bytes() const { return buffers_.bytes(); }
  std::uint32_t dispatches() const; // that record() records at most

private:
  // From kShapes on in pairs, of this frame and of the one before in turns; the guides take turns within a frame.
  enum OwnBuffer {
    kReprojection,
    kSlopes,
    kFirstOutput,
    kFiltered,
    kShapes,
    kMoments = 6,
    kHistory = 8,
    kGuide = 10,
    kExcess = 12,
    kSpreading
  };
  enum Stage { kTemporal, kVariance, kAtrous, kSplit, kSpread, kReturn };
  // What each dispatch reads and writes: temporal and variance, after motion or without; the iterations of the a-trous
  // filter; rare bright samples, split from the light, spread and added back.
  enum FlowName {
    kMoving,
    kStanding,
    kFirst,
    kSecond,
    kBack,
    kForth,
    kSplitFlow,
    kSpreadFirst,
    kSpreadForth,
    kSpreadBack,
    kReturnFlow,
    kFlowCount
  };
  // Five iterations, as in the paper: 125 pixels across.
  static constexpr std::array<FlowName, 5> kIterations = {kFirst, kSecond, kBack, kForth, kBack};
  struct Flow {
    const Buffer *history_before, *color_in, *color_out, *guide_in, *guide_out;
  };
  std::vector<Binding> bindings(std::uint32_t parity, const Flow& flow) const;

  std::uint32_t width_, height_;
  bool splits_; // there is light whose rare bright samples are split
  FilterBands bands_;
  const Buffer& gbuffer_;
  BufferSet buffers_;
  std::array<std::array<std::unique_ptr<BindingSet>, kFlowCount>, 2> sets_; // by turn
  std::vector<Kernel> kernels_;                                             // by Stage
  gpu::CameraView before_{};
  bool remembers_ = false; // there is a frame before
  std::uint32_t parity_ = 0;
  std::uint32_t still_frames_ = 0; // since the camera moved
};

} // namespace wavepath
